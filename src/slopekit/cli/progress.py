"""Progress on stderr, not with --json or --quiet: on a terminal bars and the stage of a run, else a line at times."""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO

import typer

from slopekit.core.onlooker import onlooker

Advance = Callable[[int], None]
_SILENT = ("--json", "--quiet")
_FIRST_S, _EVERY_S = 1.0, 0.2  # what is shorter shows nothing; how often the time is written anew
_LINE_S, _RARELY_S = 5.0, 60.0  # no terminal: the first line, and twice the time to each, to
_STILL_S = 2.0  # a bar that has not moved for so long says how long it has taken, and at what it is
_WIDE, _BESIDE = 24, 28  # columns of a bar, and of brackets, part, time to come (with days) and gaps beside it
_GUESSED = ("evaluations", "probabilities")  # what begins so has a total that is guessed: no time to come is told by it
_LINES: list["_Line"] = []  # that have the terminal; the last is the one that writes


class _ProgressBar:
    """A bar that also moves between two steps: who draws it holds the lock."""

    def __init__(self, bar: Any, others: int) -> None:
        self.bar, self.others, self.lock, self.moved = bar, others, threading.Lock(), time.monotonic()

    def advance(self, by: int) -> None:
        """Move on."""
        with self.lock:
            self.bar.current_item, self.moved = None, time.monotonic()
            self.bar.update(by)

    def tell(self, text: str, columns: int) -> None:
        """Write behind a bar that stands still what is done, as far as the terminal goes."""
        text = text[: max(columns - self.others, 0)]
        with self.lock:
            if time.monotonic() - self.moved >= _STILL_S and self.bar.current_item != text:
                self.bar.current_item = text
                self.bar.render_progress()


_BARS: list[_ProgressBar] = []  # the last has the line of the terminal


class _Count:
    """What a bar would show, in words."""

    def __init__(self, label: str, total: int) -> None:
        self.label, self.total, self.done = label, total, 0

    def advance(self, by: int) -> None:
        """Move on."""
        self.done += by

    def __str__(self) -> str:
        of = "" if self.label.startswith(_GUESSED) else f" of {self.total}"
        return f"{self.label}: {self.done}{of}"


_COUNTS: list[_Count] = []


@contextmanager
def progress(label: str, total: int) -> Iterator[Advance]:
    """A bar that is moved on by so many of `total`; where stderr is no terminal the lines there say how many."""
    if _is_silent() or total < 2:
        yield lambda _: None
        return
    if not sys.stderr.isatty():
        _COUNTS.append(_Count(label, total))
        try:
            yield _COUNTS[-1].advance
        finally:
            _COUNTS.pop()
        return
    with typer.progressbar(
        length=total,
        label=label,
        file=sys.stderr,
        width=_WIDE,
        show_eta=not label.startswith(_GUESSED),
        item_show_func=lambda text: text,
    ) as bar:
        _BARS.append(_ProgressBar(bar, len(label) + _WIDE + _BESIDE))
        try:
            yield _BARS[-1].advance
        finally:
            with _BARS[-1].lock:
                bar.current_item = None
                _BARS.pop()


@contextmanager
def watched(stage: str = "") -> Iterator[None]:
    """A line with the time and the stage of what runs within, from its second second on; it is wiped at the end.

    While a bar is shown the line is silent; a bar that stands still says the same. Where stderr is no terminal, whole
    lines say it, from five seconds on and ever more rarely.
    """
    if _is_silent():
        yield
        return
    line = (_Line if sys.stderr.isatty() else _Lines)(sys.stderr, stage)
    with onlooker(line.hear):
        thread = threading.Thread(target=line.tick, daemon=True)
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
    """Wipe the line for what is printed within."""
    if not _LINES:
        yield
        return
    with _LINES[-1].lock:
        _LINES[-1].wipe()
        yield


def _is_silent() -> bool:
    return sys.stderr is None or any(word in sys.argv[1:] for word in _SILENT)


class _Line:
    """The line: what was heard last, written by a thread of its own while the numbers are made."""

    def __init__(self, to: TextIO, stage: str = "") -> None:
        self.to, self.began, self.over, self.lock = to, time.monotonic(), threading.Event(), threading.Lock()
        self.head, self.stage, self.written = stage, "", 0
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
        while True:
            with self.lock:
                if bars := _BARS[-1:]:
                    self.written = 0  # the bar has the line
                    bars[0].tell(self.text().strip(), self._columns())
                else:
                    text = self.text()[: self._columns() - 1]
                    self._write("\r" + text.ljust(self.written))
                    self.written = len(text)
            if self.over.wait(_EVERY_S):
                with self.lock:
                    self.wipe()
                return

    def wipe(self) -> None:
        """Leave an empty line."""
        if self.written:
            self._write("\r" + " " * self.written + "\r")
            self.written = 0

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


class _Lines(_Line):
    """The same for a file or a pipe, in which every line stays."""

    def text(self) -> str:
        """With what a bar would show."""
        counts = [str(count) for count in _COUNTS[-1:]]
        return "   ".join([super().text().strip(), *counts])

    def tick(self) -> None:
        """Write a line, and the next after twice the time, until it is over."""
        pause = _LINE_S
        while not self.over.wait(pause):
            with self.lock:
                self._write(f"{self.text()}\n")
            pause = min(2.0 * pause, _RARELY_S)
