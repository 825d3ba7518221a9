"""What is done of a long study, line by line in a file, so that an interrupted one goes on where it stopped."""

import hashlib
import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from slopekit._version import __version__
from slopekit.errors import DesignError, Fault

_EVERY_S = 1.0


@dataclass(slots=True)
class Journal:
    """Records of finished tasks by their number.

    Attributes
    ----------
    path : the file; another run (other inputs, seed, version) has another name, so that none takes what is not its own
    streamed : whether records are written as they come, a second at a time; else only when `save` is called
    """

    path: Path
    key: str
    streamed: bool = True
    held: dict[int, Any] = field(default_factory=dict)
    unwritten: list[int] = field(default_factory=list)
    last: float = field(default_factory=time.monotonic)

    @classmethod
    def of(cls, folder: Path, study: str, run: Any, streamed: bool = True) -> "Journal":
        """The journal of a run.

        Parameters
        ----------
        study : its name; run : everything that its records depend on, as JSON values
        """
        text = json.dumps([__version__, study, run], sort_keys=True, default=str)
        key = hashlib.sha256(text.encode()).hexdigest()
        return cls(folder / f"{study}-{key[:12]}.journal", key, streamed)

    def records(self, count: int) -> Iterator[tuple[int, Any]]:
        """What an earlier run of the same name has done; a last line cut short is passed over."""
        if self.path.is_file():
            for line in self.path.read_text(encoding="utf-8").splitlines():
                try:
                    entry = json.loads(line)
                    if entry["key"] != self.key:
                        continue
                    found = {int(index): record for index, record in entry["records"]}
                except (ValueError, KeyError, TypeError):
                    continue
                self.held |= {index: record for index, record in found.items() if 0 <= index < count}
        yield from sorted(self.held.items())

    def keep(self, indices: Sequence[int], records: Sequence[Any]) -> None:
        """Take records in, as they come."""
        self.held |= dict(zip(indices, records, strict=True))
        self.unwritten += indices
        if self.streamed and time.monotonic() - self.last > _EVERY_S:
            self.save()

    def save(self) -> None:
        """Write what is not yet written.

        Raises
        ------
        DesignError
            E129 where the file cannot be written.
        """
        if not self.unwritten:
            return
        line = json.dumps({"key": self.key, "records": [[index, self.held[index]] for index in self.unwritten]})
        try:
            with self.path.open("a", encoding="utf-8") as file:
                file.write(f"\n{line}\n")  # a line that an interruption cut short ends here
        except OSError as error:
            reason = error.strerror or str(error)
            raise DesignError([Fault("E129", f"{self.path} cannot be written: {reason}", str(self.path))]) from None
        self.unwritten, self.last = [], time.monotonic()

    def remove(self) -> None:
        """The run is complete: its results are written elsewhere."""
        self.path.unlink(missing_ok=True)
