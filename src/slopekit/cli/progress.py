"""Progress on stderr, on a terminal, not with --json or --quiet: one line that is rewritten."""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

from slopekit.core.progress import listening

Advance = Callable[[int], None]
_SILENT = ("--json", "--quiet")
_FIRST_S, _EVERY_S = 1.0, 0.2  # what is shorter shows nothing; how often the time is written anew
_GUESSED = (
    "evaluations",
    "probabilities",
)  # what begins so has a total that is guessed: it is not said
_LINES: list["_Line"] = []  # the last is the one that writes
_COUNTS: list[tuple[str, int, list[int]]] = []  # label, total and steps of what is counted now


@contextmanager
def progress(label: str, total: int) -> Iterator[Advance]:
    """Show in the progress line how many of `total` are done."""
    _COUNTS.append((label, total, []))
    try:
        yield _COUNTS[-1][2].append
    finally:
        _COUNTS.pop()


@contextmanager
def watched(stage: str = "") -> Iterator[None]:
    """Show a line with time, count and stage of what runs within, after the first second.

    It is wiped at the end. Where stderr is no terminal, nothing is said.
    """
    if (
        sys.stderr is None
        or not sys.stderr.isatty()
        or any(word in sys.argv[1:] for word in _SILENT)
    ):
        yield
        return
    line = _Line(sys.stderr, stage)
    with listening(line.hear):
        thread = threading.Thread(target=line.run, daemon=True)
        thread.start()
        _LINES.append(line)
        try:
            yield
        finally:
            _LINES.pop()
            line.over.set()
            thread.join()


@contextmanager
def aside() -> Iterator[None]:
    """Clear the progress line while something else is printed."""
    if not _LINES:
        yield
        return
    with _LINES[-1].lock:
        _LINES[-1].write("")
        yield


class _Line:
    """The progress line: the last stage, written by a thread of its own."""

    def __init__(self, to: TextIO, stage: str = "") -> None:
        self.to, self.began, self.over, self.lock = (
            to,
            time.monotonic(),
            threading.Event(),
            threading.Lock(),
        )
        self.head, self.stage, self.written = stage, "", 0
        self.value: float | None = None

    def hear(self, stage: str, value: float | None, head: bool) -> None:
        """Note a stage; nothing is written here."""
        if head:
            self.head, stage = stage, ""
        self.stage, self.value = stage, value

    def text(self) -> str:
        """The text of the line: seconds, count, stage and its value."""
        columns = [f"{time.monotonic() - self.began:5.0f} s"]
        for label, total, steps in _COUNTS[-1:]:
            columns.append(
                f"{label}: {sum(steps)}" + ("" if label.startswith(_GUESSED) else f" of {total}")
            )
        value = "" if self.value is None else f" {self.value:.4g}"
        columns.append(": ".join(stage for stage in (self.head, self.stage) if stage) + value)
        return "  ".join(columns).rstrip()

    def run(self) -> None:
        """Write the line anew until it is over, then wipe it."""
        pause = _FIRST_S
        while not self.over.wait(pause):
            with self.lock:
                self.write(self.text())
            pause = _EVERY_S
        with self.lock:
            self.write("")

    def write(self, text: str) -> None:
        """Replace the text of the line, cut to the width of the terminal; an empty text clears it."""
        try:
            if text or self.written:
                text = text[: _columns(self.to) - 1]
                self.to.write("\r" + text.ljust(self.written) + ("" if text else "\r"))
                self.written = len(text)
            self.to.flush()
        except OSError:  # the terminal is gone: the numbers are not
            self.over.set()


def _columns(to: TextIO) -> int:
    try:
        return max(os.get_terminal_size(to.fileno()).columns, 20)
    except (OSError, ValueError):  # none of a size, or no file at all
        return 80
