"""The sheet of earthquakes: yield coefficient by both methods, displacements record by record."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import Any

from slopekit.core.orientation import number
from slopekit.core.sheet import Column, Section, Sheet, Table, counted, factor_text
from slopekit.studies.quake.run import Quake, Shaken
from slopekit.studies.quake.six import Shaking, springs_in_words
from slopekit.studies.quake.yielding import Yield, shown_k
from slopekit.studies.words import METHODS, status_words, study_sheet

_MAX_ROWS = 40
_NAME_WIDTH = 26
_WORK_ROUNDING = 1e-9  # of the work put in: what is below is rounding


def sheet_of(quake: Quake) -> Sheet:
    """The sheet of earthquakes."""
    records = Table(_RECORDS, quake.shaken)
    if len(quake.shaken) > _MAX_ROWS:
        remark = f"… {len(quake.shaken) - _MAX_ROWS} more records are left out here: see the JSON or the CSV"
        records = replace(records, ends=(_MAX_ROWS // 2, _MAX_ROWS // 2), rest=remark)
    tables = {"quake.csv": records} | ({"six.csv": _six_table(quake)} if quake.six else {})
    times = range(len(quake.motion["t_s"])) if quake.motion else ()
    motion: list[Column[Any]] = [
        Column(name, quake.motion.get(name, ()), name, unit, exact=".9g")
        for name, unit in _MOTION.items()
    ]
    tables |= {"motion.csv": Table(motion, times)} if quake.motion else {}
    toward = (
        "the way of the slope" if quake.toward_deg is None else f"{number(quake.toward_deg):0>3}"
    )
    scaled = "" if quake.scale_pga is None else f", each scaled to {number(quake.scale_pga)} g"
    leading = (
        f"{_displacement_text(quake.leading)} in six degrees of freedom; "
        f"one way, rigid: {_displacement_text(quake.one_way)}"
    )
    return study_sheet(
        quake.design,
        "quake",
        (
            Section(
                "RECORDS",
                [f"{counted(len(quake.shaken), 'record')}{scaled}; toward {toward}, and reversed"],
            ),
            Section("NOW", [_static_factors(quake)]),
            Section(
                "YIELD",
                [
                    *(_yield_text(quake, method_yield) for method_yield in quake.yields),
                    *_agreement(quake),
                ],
                hang=14,
            ),
            Section("SIX", [leading, _six_table(quake), *_six_notes(quake)] if quake.six else []),
            Section(
                "SLIDES",
                [*(["one way, rigid, for comparison with SIX:"] if quake.six else []), records],
            ),
            Section("OVERALL", _overall(quake.leading)),
            Section("MODEL", [_model_text(quake)]),
            Section("TIME", [f"{quake.seconds:.2f} s"]),
            Section("NOTE", [str(notice) for notice in quake.warnings]),
        ),
        tables,
    )


def line_of(quake: Quake) -> str:
    """The yield coefficient, the displacements, the check on one line."""
    k, factor = quake.coefficient, quake.factor
    phrases = [f"k_y {shown_k(k)}", f"factor {factor:.3f}" if factor is not None else "no factor"]
    mark = " (W353)" if quake.yields[0].jumps else ""
    if quake.in_six is not None:
        phrases += [
            f"six degrees of freedom: {_displacement_text(quake.leading)}",
            f"one way: {_displacement_text(quake.one_way)}{mark}",
        ]
    else:
        phrases.append(f"{_displacement_text(quake.leading)}{mark}")
    phrases.append({True: "agree", False: "disagree", None: "not compared"}[quake.agree])
    return "  ".join([*phrases, *dict.fromkeys(notice.code for notice in quake.warnings)])


def _displacement_text(displacement: Mapping[str, Any]) -> str:
    """Median and largest displacement in words."""
    if displacement["median_m"] is None:
        return "no displacement, a step did not settle (W464)"
    return f"median {_centimetres(displacement['median_m'])} cm, most {_centimetres(displacement['largest_m'])} cm"


def _centimetres(metres: float) -> str:
    """In cm, none in more digits than a column has.

    >>> _centimetres(0.2788), _centimetres(4e-5), _centimetres(0.0), _centimetres(99.996), _centimetres(255.96)
    ('27.88', '< 0.01', '0', '10000', '25600')
    """
    text = f"{metres * 100.0:.4g}"
    if 1e4 <= float(text) < 1e6:  # 2.56e+04 would touch the column before it
        text = f"{float(text):.0f}"
    return "< 0.01" if 0.0 < metres < 1e-4 else text


def _static_factors(quake: Quake) -> str:
    factors = [
        f"{factor_text(method_yield.before).strip()} {METHODS[method_yield.method]}"
        for method_yield in quake.yields
    ]
    return f"without an earthquake FoS {'   '.join(factors)}"


def _yield_text(quake: Quake, method_yield: Yield) -> str:
    name = f"{METHODS[method_yield.method]:<13} "
    if method_yield.coefficient is None:
        return f"{name}none: {method_yield.why_not}"
    status = status_words(quake.design, method_yield.status)
    factor = (
        f"factor {method_yield.factor:.6f}"
        if method_yield.factor is not None
        else f"no factor: {method_yield.why_not}"
    )
    block = f" of {method_yield.factor_of}" if method_yield.factor_of else ""
    return f"{name}k_y {method_yield.coefficient:.6f} g   {factor}{block}   {status}"


def _agreement(quake: Quake) -> list[str]:
    if quake.agree is None:
        return []
    pre_ie, closed_form = (method_yield.coefficient or 0.0 for method_yield in quake.yields)
    differs = quake.agree and abs(pre_ie - closed_form) > quake.design.analysis.agree_within * max(
        pre_ie, closed_form
    )
    remark = (
        ": on the same assumptions (one traction a joint, forces alone); PRE-IE's is used"
        if differs
        else ""
    )
    return [f"the methods {'AGREE' if quake.agree else 'DISAGREE'} on k_y{remark}"]


def _shortened_name(name: str, width: int = _NAME_WIDTH) -> str:
    """A name that leaves a blank before the next column: its beginning and its end.

    >>> _shortened_name("rectangular:0.5g,0.3s", 16), _shortened_name("triangular:0.5g,0.3s", 16)
    ('rectang…5g,0.3s', 'triangu…5g,0.3s')
    """
    half = (width - 2) // 2
    return name if len(name) < width else f"{name[:half]}…{name[-half:]}"


#: Displacements in cm for a person, in m in files.
_RECORDS: Sequence[Column[Shaken]] = (
    Column("record", "record.name", "record", show=_shortened_name, width=-_NAME_WIDTH),
    Column("PGA g", "record.pga_g", "pga_g", "g", ".3g", 8),
    Column("PGV m/s", "record.pgv_m_s", "pgv_m_s", "m/s", ".3g", 9),
    Column("Arias m/s", "record.arias_m_s", "arias_m_s", "m/s", ".3g", 11),
    Column("as recorded cm", "as_recorded_m", "as_recorded_m", "m", _centimetres, 16),
    Column("reversed cm", "reversed_m", "reversed_m", "m", _centimetres, 13),
    Column("", "mean_m", "mean_m", "m"),
    Column("", "newmark_m", "newmark_m", "m"),
    Column("", "newmark_reversed_m", "newmark_reversed_m", "m"),
    Column("", "after_m", "after_m", "m"),
    Column("", "record.duration_s", "duration_s", "s"),
)
_MOTION = {"t_s": "s", "a_g": "g", "v_m_s": "m/s", "d_m": "m"}


def _overall(lead: Mapping[str, Any]) -> list[str]:
    """The spread over the records, where they are enough."""
    if lead["p16_m"] is None:
        return []
    low, high = _centimetres(lead["p16_m"]), _centimetres(lead["p84_m"])
    return [f"16th percentile {low} cm, {_displacement_text(lead)}, 84th percentile {high} cm"]


def _six_table(quake: Quake) -> Table[Any]:
    """In six degrees of freedom, beside what sliding one way has."""
    newmark = {
        shaking.record.name: (shaking.as_recorded_m, shaking.reversed_m) for shaking in quake.shaken
    }

    columns: list[Column[Any]] = [
        Column("record", "record", "record", show=partial(_shortened_name, width=16), width=-16),
        Column("way", "way", "way", width=-11),
        Column("slid cm", "slid_m", "slid_m", "m", _centimetres, 8),
        Column(
            "one way cm",
            lambda shaking: newmark[shaking.record][shaking.way == "reversed"],
            "one_way_m",
            "m",
            _centimetres,
            11,
        ),
        Column("rotation °", "rotation_deg", "rotation_deg", "°", ".3f", 11),
        Column("slips %", "slipped", "slipped", show=_percent, width=8),
        Column("open %", "opened", "opened", show=_percent, width=7),
        Column("debonded %", "debonded", "debonded", show=_percent, width=11),
        Column("ended", "ended", "ended", width=-1, about="  {}"),
    ]
    return Table(columns, quake.six)


def _percent(share: float) -> str:
    return f"{share * 100.0:.3g}"


def _six_notes(quake: Quake) -> list[str]:
    """The work of the one that slid most, and how it was found."""
    most: Shaking = max(quake.six, key=attrgetter("slid_m"))
    work = most.work_kj
    imbalance = abs(work.unbalanced) / max(abs(work.put_in), 1e-300)
    assert quake.in_six is not None
    pairs, percent = quake.in_six.pairs, quake.in_six.percent
    refinement = f"the last refinement moved what slides by {percent} % at most"
    return [
        f"work in {most.record} ({most.way}), MJ: put in {work.put_in / 1e3:.5g} = friction {work.friction / 1e3:.5g}"
        f" + stored {work.stored / 1e3:.3g} + kinetic {work.kinetic / 1e3:.3f} + damped {work.damped / 1e3:.4g},"
        f" to {max(imbalance, _WORK_ROUNDING):.0e}",
        f"{springs_in_words(quake.design)}; the geometry stays as it is",
        f"{pairs} node pairs; {refinement if percent else 'finer ones gave no answer'}",
    ]


def _model_text(quake: Quake) -> str:
    factor = "1" if quake.factor is None else f"{quake.factor:.6f}"
    pre_ie = quake.yields[0]
    block = f"{pre_ie.factor_of}, which of all goes farthest," if pre_ie.factor_of else "the block"
    return (
        f"one way, rigid, exact between samples; {block} gains on the ground by {factor} x (a - k_y g); "
        "left out: vertical shaking, sliding back, strength lost by slip, geometry that changes"
    )
