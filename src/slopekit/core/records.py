"""`dataclass` without slots: for them every class would be made twice, at a fifth of a cold start."""

import dataclasses
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls=None, /, *, slots=False, **options):
        """A class's record, as `dataclasses.dataclass` makes it; `slots` is taken and means nothing."""
        make = dataclasses.dataclass(**options)
        return make if cls is None else make(cls)


def names_of(record: type[Any]) -> tuple[str, ...]:
    """The names of the fields of a record."""
    return tuple(field.name for field in dataclasses.fields(record))
