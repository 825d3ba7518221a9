"""Cases and references of the verification suite, read from the shipped `verification.json`.

A case is a design and what sources say of it. No reference value comes from slopekit itself.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

from slopekit.core.errors import Faults, did_you_mean, fail

#: What a row can hold against its reference, and its unit; {of} is what it is meant for.
QUANTITIES: Mapping[str, str] = {
    "limit": "PRE-IE limit",
    "closed_form": "closed form",
    "static_bound": "upper bound",
    "all_pairs_failed": "all pairs failed",
    "forces_only": "PRE-IE, forces only",
    "fellenius": "Fellenius",
    "janbu": "Janbu",
    "bishop": "Bishop",
    "critical_friction_deg": "critical φ, °",
    "column_force_kn": "P of column {of}, kN",
    "toe_force_kn": "toe force, kN",
    "failed_pairs": "failed pairs at {of}",
    "displacement_x_mm": "x at {of}, mm",
    "displacement_z_mm": "z at {of}, mm",
    "volume_m3": "volume, m³",
    "weight_kn": "weight, kN",
    "status": "status",
}
#: Quantities that are factors of safety.
FACTORS = (
    "limit",
    "closed_form",
    "static_bound",
    "all_pairs_failed",
    "forces_only",
    "fellenius",
    "janbu",
    "bishop",
)
#: Sources that are the project's own lists and code, written apart from slopekit.
OWN_SOURCES = ("cases", "prototype", "lem", "exact", "conic")


@dataclass(frozen=True)
class Reference:
    """One number of a source: what is compared, with what, how closely, and why so closely.

    Attributes
    ----------
    quantity : a key of `QUANTITIES`; of : the column, reduction factor or friction angle (degrees) that it is meant for
    confidence : of the source and of the inputs, whatever slopekit gives: a mark from A to D, and words
    published : as printed, so that its digits count; of the project's own sources only a status
    exact : recomputed or exact value; formula : how, in words or symbols
    tolerance : relative to the exact value, or to the published one where there is no other
    not_judged : why the row is shown but not judged; empty where it is judged
    """

    quantity: str
    source: str
    confidence: str
    published: str | None = None
    exact: float | None = None
    formula: str = ""
    of: float | None = None
    tolerance: float | None = None
    why: str = ""
    not_judged: str = field(default="", metadata={"json": None})

    @property
    def is_own_source(self) -> bool:
        """Whether the value comes from the project's own lists or code."""
        return self.source in OWN_SOURCES

    @property
    def printed(self) -> str | None:
        """The value as somebody else printed it."""
        return None if self.is_own_source else self.published

    @property
    def is_factor(self) -> bool:
        """Whether the quantity is a factor of safety."""
        return self.quantity in FACTORS


@dataclass(frozen=True)
class ReferenceCase:
    """A design and what its sources say of it; `status` is that of the result where a source gives one."""

    id: str
    source: str
    title: str
    confidence: str
    design: Mapping[str, Any]
    references: tuple[Reference, ...]
    status: str | None = None

    @property
    def kind(self) -> str:
        """The kind of design."""
        return str(self.design["kind"])


def half_unit(text: str) -> float:
    """Half a unit of the last digit of a printed number.

    >>> half_unit("1.25"), half_unit("2013")
    (0.005, 0.5)
    """
    return 0.5 * 10.0 ** -len(text.partition(".")[2])


@cache
def document() -> tuple[Mapping[str, str], tuple[ReferenceCase, ...]]:
    """Sources and cases of the shipped file."""
    document = json.loads(
        files("slopekit.studies.suite").joinpath("verification.json").read_text(encoding="utf-8")
    )
    return document["sources"], tuple(_case(entry) for entry in document["cases"])


def _case(entry: Mapping[str, Any]) -> ReferenceCase:
    source_fields = {"source": entry["source"], "confidence": entry["confidence"]}
    return ReferenceCase(
        id=entry["id"],
        title=entry["title"],
        design=entry["design"],
        status=entry.get("status"),
        references=tuple(Reference(**(source_fields | row)) for row in entry["rows"]),
        **source_fields,
    )


def selected_cases(only: str | Iterable[str] | None) -> tuple[ReferenceCase, ...]:
    """The cases that a choice names (ids, sources, kinds), in the order of the suite; all of them for None.

    Raises
    ------
    DesignError
        E197 for a name that is none of these.
    """
    sources, cases = document()
    if only is None:
        return cases
    names = [only] if isinstance(only, str) else list(only)
    known_names = {case.id for case in cases} | set(sources) | {case.kind for case in cases}
    faults = Faults()
    for name in names:
        if name not in known_names:
            advice = did_you_mean(
                name,
                sorted(known_names),
                f"There are the sources {', '.join(sources)}.",
                cutoff=0.4,
            )
            faults.add(
                "E197", f"{name} is no case, source or kind of the suite", f"only = {name}", advice
            )
    faults.refuse()
    if not names:
        fail("E197", "no case is chosen", "only = ()", "Leave it out to run them all.")
    return tuple(
        case
        for case in cases
        if {case.id, case.kind, case.source, *(reference.source for reference in case.references)}
        & set(names)
    )
