"""The sheet of earthquakes: yield coefficient by both methods, displacements record by record, what others find."""

from collections.abc import Sequence
from operator import attrgetter, itemgetter
from typing import Any

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Section, Sheet, Table, counted, factor_text
from slopekit.studies.quake.run import Motion, Quake, Shaken
from slopekit.studies.quake.yielding import Yield, shown_k
from slopekit.studies.words import METHODS, head, status_words

_MOST_ROWS = 40
_NAME = 26


def sheet_of(found: Quake) -> Sheet:
    """The sheet of earthquakes."""
    records = _records(found.shaken)
    toward = "the way of the slope" if found.toward_deg is None else f"{number(found.toward_deg):0>3}"
    scaled = "" if found.scale_pga is None else f", each scaled to {number(found.scale_pga)} g"
    return Sheet(head(found.design, "quake"), (
        Section("RECORDS", [f"{counted(len(found.shaken), 'record')}{scaled}; toward {toward}, and reversed"]),
        Section("NOW", [_now(found)]),
        Section("YIELD", [*(_yield(found, one) for one in found.yields), *_agree(found)], hang=14),
        Section("SLIDES", [records]),
        Section("OVERALL", [_percentiles(found)] if len(found.shaken) > 1 else []),
        Section("COMPARE", [_compared(found)] if found.compared() else []),
        Section("MODEL", [_model(found)]),
        Section("TIME", [f"{found.seconds:.2f} s"]),
        Section("NOTE", [str(notice) for notice in found.warnings]),
    ), {"quake.csv": records} | ({} if found.motion is None else {"motion.csv": _motion(found.motion)}))  # fmt: skip


def line_of(found: Quake) -> str:
    """The yield coefficient, the displacements, the check on one line."""
    k, factor = found.coefficient, found.factor
    parts = [f"k_y {shown_k(k)}", f"factor {factor:.4f}" if factor is not None else "no factor"]
    larger = max(one.larger_m for one in found.shaken)
    parts.append(f"median {_length(found.percentiles()['mean']['median'])}, most {_length(larger)}")
    parts.append({True: "agree", False: "disagree", None: "not compared"}[found.agree])
    return "  ".join([*parts, *dict.fromkeys(notice.code for notice in found.warnings)])


def _length(metres: float) -> str:
    return f"{metres * 100.0:.4g} cm"


def _now(found: Quake) -> str:
    said = [f"{factor_text(one.before).strip()} {METHODS[one.method]}" for one in found.yields]
    return f"without an earthquake FoS {'   '.join(said)}"


def _yield(found: Quake, one: Yield) -> str:
    name = f"{METHODS[one.method]:<13} "
    if one.coefficient is None:
        return f"{name}none: {one.why_not}"
    status = status_words(found.design, one.status)
    factor = f"factor {one.factor:.6f}" if one.factor is not None else f"no factor: {one.why_not}"
    return f"{name}k_y {one.coefficient:.6f} g   {factor}   {status}"


def _agree(found: Quake) -> list[str]:
    return [] if found.agree is None else [f"the methods {'AGREE' if found.agree else 'DISAGREE'} on k_y"]


def _records(shaken: Sequence[Shaken]) -> Table[Shaken]:
    """Displacements in cm for a person, in m in files."""

    def shown(metres: float) -> str:
        return f"{metres * 100.0:.4g}"

    columns: tuple[Column[Shaken], ...] = (
        Column("record", lambda one: one.record.name, "record", width=-_NAME, text=lambda one: _cut(one.record.name)),
        Column("PGA g", lambda one: one.record.pga_g, "pga_g", "g", ".3g", 8),
        Column("PGV m/s", lambda one: one.record.pgv_m_s, "pgv_m_s", "m/s", ".3g", 9),
        Column("Arias m/s", lambda one: one.record.arias_m_s, "arias_m_s", "m/s", ".3g", 11),
        Column("as recorded cm", attrgetter("as_recorded_m"), "as_recorded_m", "m", shown, 16),
        Column("reversed cm", attrgetter("reversed_m"), "reversed_m", "m", shown, 13),
        Column("", attrgetter("mean_m"), "mean_m", "m", shown),
        Column("", attrgetter("newmark_m"), "newmark_m", "m", shown),
        Column("", attrgetter("newmark_reversed_m"), "newmark_reversed_m", "m", shown),
        Column("", attrgetter("after_m"), "after_m", "m", shown),
        Column("", lambda one: one.record.duration_s, "duration_s", "s"),
    )
    if len(shaken) <= _MOST_ROWS:
        return Table(columns, shaken)
    left = len(shaken) - _MOST_ROWS
    return Table(columns, shaken, ends=(_MOST_ROWS // 2, _MOST_ROWS // 2),
                 rest=f"… {left} more records are left out here: see the JSON or the CSV")  # fmt: skip


def _cut(name: str) -> str:
    return name if len(name) < _NAME else f"…{name[-(_NAME - 2) :]}"


def _percentiles(found: Quake) -> Table[Any]:
    called = {
        "as_recorded": "as recorded", "reversed": "reversed", "mean": "mean of both", "larger": "larger of both",
        "newmark": "mean of both, factor 1",
    }  # fmt: skip
    rows = [(called[name], values) for name, values in found.percentiles().items()]

    def column(title: str, key: str) -> Column[Any]:
        return Column(title, lambda row: row[1][key], key + "_m", "m", lambda m: f"{m * 100.0:.4g}", 13)

    return Table(
        (Column("over the records", itemgetter(0), "over", width=-_NAME), column("16 % cm", "p16"),
         column("median cm", "median"), column("84 % cm", "p84")), rows,
    )  # fmt: skip


def _compared(found: Quake) -> Table[Any]:
    own = found.percentiles()["newmark"]["median"]
    ours = {"name": "these records, factor 1", "asks": "", "median_m": own}
    columns: tuple[Column[Any], ...] = (
        Column("median displacement", itemgetter("name"), "name", width=-_NAME),
        Column("cm", itemgetter("median_m"), "median_m", "m", lambda m: f"{m * 100.0:.4g}", 10),
        Column("  from", itemgetter("asks"), "asks", width=-1, about="  {}"),
    )
    return Table(columns, [ours, *found.compared()])


def _model(found: Quake) -> str:
    factor = "1" if found.factor is None else f"{found.factor:.6f}"
    return (
        f"one way, rigid, exact between samples; the block gains on the ground by {factor} x (a - k_y g); "
        "left out: vertical shaking, sliding back, strength lost by slip, geometry that changes"
    )


def _motion(motion: Motion) -> Table[Any]:
    """Every sample of the record that moves it most."""
    rows = list(zip(motion.times_s, motion.acceleration_g, motion.velocity, motion.displacement, strict=True))
    names = (("t_s", "s"), ("a_g", "g"), ("v_m_s", "m/s"), ("d_m", "m"))
    return Table([Column(name, _cell(k), name, unit, exact=".9g") for k, (name, unit) in enumerate(names)], rows)


def _cell(k: int) -> Any:
    return lambda row: float(row[k])
