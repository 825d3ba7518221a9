"""Progress on stderr, only where that is a terminal, and not with --json or --quiet: bars, and the stage of one run."""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

import typer

from slopekit.core.onlooker import onlooker

Advance = Callable[[int], None]
_SILENT = ("--json", "--quiet")
_FIRST_S, _EVERY_S = 1.0, 0.2  # what is shorter shows nothing; how often the time is written anew
_BAR = threading.Event()  # a bar has the line of the terminal


@contextmanager
def progress(label: str, total: int) -> Iterator[Advance]:
    """A bar that is moved on by so many of `total`; nothing is shown where stderr is no terminal."""
    if not _shown() or total < 2:
        yield lambda _: None
        return
    _BAR.set()
    try:
        with typer.progressbar(length=total, label=label, file=sys.stderr) as bar:
            yield bar.update
    finally:
        _BAR.clear()


@contextmanager
def watched() -> Iterator[None]:
    """A line with the time and the stage of what runs within, from its second second on; it is wiped at the end.

    While a bar is shown it is silent.
    """
    if not _shown():
        yield
        return
    line = _Line(sys.stderr)
    with onlooker(line.hear):
        thread = threading.Thread(target=line.tick, daemon=True)
        thread.start()
        try:
            yield
        finally:
            line.over.set()
            thread.join()


def _shown() -> bool:
    return sys.stderr.isatty() and not any(word in sys.argv[1:] for word in _SILENT)


class _Line:
    """The line: what was heard last, written by a thread of its own while the numbers are made."""

    def __init__(self, to: TextIO) -> None:
        self.to, self.began, self.over = to, time.monotonic(), threading.Event()
        self.head = self.stage = ""
        self.value: float | None = None

    def hear(self, stage: str, value: float | None, head: bool) -> None:
        """Note a stage; nothing is written here."""
        if head:
            self.head, stage = stage, ""
        self.stage, self.value = stage, value

    def text(self) -> str:
        """Seconds, stage of the whole, and what it is at."""
        value = "" if self.value is None else f" {self.value:.4g}"
        stages = ": ".join(stage for stage in (self.head, self.stage) if stage)
        return f"{time.monotonic() - self.began:5.0f} s  {stages}{value}"

    def tick(self) -> None:
        """Write until it is over, then wipe."""
        if self.over.wait(_FIRST_S):
            return
        length = 0
        while True:
            if not _BAR.is_set():
                text = self.text()[: self._columns() - 1]
                self._write("\r" + text.ljust(length))
                length = len(text)
            if self.over.wait(_EVERY_S):
                self._write("\r" + " " * length + "\r")
                return

    def _columns(self) -> int:
        try:
            return max(os.get_terminal_size(self.to.fileno()).columns, 20)
        except (OSError, ValueError):  # none of a size, or no file at all
            return 80

    def _write(self, text: str) -> None:
        try:
            self.to.write(text)
            self.to.flush()
        except OSError:  # the terminal is gone: the numbers are not
            self.over.set()
