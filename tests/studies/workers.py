"""Tasks for workers: in a module of their own, because workers import them by name."""

import os
import time
from dataclasses import dataclass
from pathlib import Path


def square(number: int) -> int:
    return number * number


def slow_square(number: int) -> int:
    time.sleep(0.02)
    return number * number


def late(number: int) -> int:
    print("ready", flush=True)
    time.sleep(0.5)
    return number


@dataclass(frozen=True)
class DiesOnce:
    """Kills its process at one task, the first time."""

    mark: str
    at: int

    def __call__(self, number: int) -> int:
        if number == self.at and not Path(self.mark).exists():
            Path(self.mark).touch()
            os.kill(os.getpid(), 9)
        return number * number


def dies(number: int) -> int:
    os.kill(os.getpid(), 9)
    return number


@dataclass(frozen=True)
class DiesAlways:
    """Kills its process at one task, every time."""

    at: int

    def __call__(self, number: int) -> int:
        return dies(number) if number == self.at else number * number


def one_over(number: int) -> float:
    return 1 / number


@dataclass
class InterruptedAt:
    """Ctrl-C comes while this task is done."""

    at: int
    asked: int = 0

    def __call__(self, number: int) -> int:
        if number == self.at:
            raise KeyboardInterrupt
        self.asked += 1
        return number * number
