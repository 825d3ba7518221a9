"""The kinds of design: one file a kind, loaded when a design of it is asked for."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from slopekit.core.errors import Notice, SlopekitError
from slopekit.design import registry
from slopekit.design.common import Design
from slopekit.evidence import WithoutBasal
from slopekit.notices import (
    defaulted_inputs,
    mean_value_notices,
    pressure_notices,
    size_notices,
    strength_notices,
    weight_notices,
)
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.kinds.protocol import Factors, Kind

_SAME = 1e-9  # factors of residual and of peak strength


def register(kind: "Kind[Any]") -> None:
    """Register a further kind: its files are then read, analysed, printed, checked and varied as any other's."""
    registry.KINDS[kind.name] = kind


def kind_named(name: str) -> "Kind[Any]":
    """Return the kind with a name. Raises KeyError for an unknown name."""
    kind: Kind[Any] = registry.kind_named(name)
    return kind


def known_kind(name: object) -> "Kind[Any] | None":
    """Return the kind with a name, None for an unknown name, which documents of other programs may have."""
    return kind_named(str(name)) if str(name) in registry.KINDS else None


def kind_of(design: Design) -> "Kind[Any]":
    """Return the kind of a design."""
    return kind_named(design.kind)


def analyse(design: Design, elastic: bool = False) -> Result:
    """Analyse a design of any kind.

    Parameters
    ----------
    elastic : elastic blocks beside the rigid ones

    Raises
    ------
    GeometryError
        Where no block can be formed.
    """
    kind = kind_of(design)
    if elastic:
        from slopekit.elastic.meshing import required

        required()
    result = add_common_notices(kind.analyse(design))
    if elastic:
        from slopekit.kinds.elastic import with_elastic

        result = with_elastic(kind, result)
    return result


def add_common_notices(result: Result) -> Result:
    """Return a result with the notices that all kinds share (W302 for its size) and the residual factors."""
    notices = _of_size(result.design, result.geometry.total_height_m)
    result = replace(result, warnings=(*result.warnings, *notices)) if notices else result
    residual = _at_residual(result.design)
    if residual is None:
        return result
    compared = replace(result, comparisons=replace(result.comparisons, residual=residual))
    return replace(compared, warnings=(*compared.warnings, *_residual_notices(compared, residual)))


def _at_residual(design: Design) -> "Factors | None":
    """Return both factors of safety on residual strength, after slip; None where no joint has a residual strength."""
    if not any(strength.residual for strength in design.joint_strengths):
        return None
    return kind_of(design).factors(replace(design.at_residual(), rules=()))


def _residual_notices(result: Result, residual: "Factors") -> Iterator[Notice]:
    """Yield W417 where the residual factor lies above the peak factor, or breaks a rule that the peak factor meets."""
    peak = result.fos.limit
    if residual.limit is not None and peak is not None and residual.limit > peak * (1.0 + _SAME):
        yield Notice(
            "W417",
            f"the residual factor {residual.limit:.4g} lies above the peak's {peak:.4g}: other "
            "joints open or carry then; is the residual strength that of these joints?",
        )
    if result.met_by_peak_only:
        number = (
            f"is {residual.limit:.4g}"
            if residual.limit is not None
            else f"does not exist ({residual.status})"
        )
        yield Notice(
            "W417",
            f"acceptance is met by the peak strength only: the residual factor {number}; once "
            "the joints have slipped, the rule is broken",
        )


def _of_size(design: Design, height_m: float | None) -> tuple[Notice, ...]:
    """Return W302 for an implausible height, and for implausible water pressures on blocks of that height."""
    return (
        () if height_m is None else (*size_notices(height_m), *_pressure_notices(design, height_m))
    )


def _pressure_notices(design: Design, height_m: float) -> Iterator[Notice]:
    """Yield W302 for implausible mean water pressures of a design, on its interfaces or between pairs of blocks."""
    entries: Sequence[Any] = getattr(design, "pressures_kpa", ()) or design.water.pressures_kpa
    pressures = [entry[-1] if isinstance(entry, tuple) else entry for entry in entries]
    return pressure_notices(pressures, height_m, design.water_unit_weight_kn_m3)


def implausible_sizes(design: Design) -> tuple[Notice, ...]:
    """Return W302 for an implausible size of a design without analysing it; empty where no block forms."""
    return _of_size(design, _height_m(design))


def _height_m(design: Design) -> float | None:
    """Return the height of the blocks, m; None where none form."""
    try:
        return float(cut(design).height_m)
    except SlopekitError:
        return None


def implausible_inputs(design: Design, varied: Sequence[str] = ()) -> list[Notice]:
    """Return W302 for implausible inputs of a design, probably typed in another unit.

    Parameters
    ----------
    varied : paths that a study varies: their values in the design are not judged
    """
    height_m = _height_m(design)
    by_path: dict[str, Iterable[Notice]] = {
        "rock": weight_notices(design),
        "strength": strength_notices(design.joint_strengths),
        "slope.height": () if height_m is None else size_notices(height_m),
        "water": () if height_m is None else _pressure_notices(design, height_m),
    }
    return [
        notice
        for path, slips in by_path.items()
        if not any(name.startswith(path) for name in varied)
        for notice in slips
    ]


def notices_of_inputs(design: Design, varied: Sequence[str] = ()) -> tuple[Notice, ...]:
    """Return the notices of a study about the inputs: example values (W379), means (W320), `implausible_inputs`."""
    return (
        *defaulted_inputs(design, varied),
        *mean_value_notices(design, varied),
        *implausible_inputs(design, varied),
    )


def factors_of(design: Design, pre_ie: bool = True) -> "Factors":
    """Return both factors of safety of a design and nothing else, for studies that analyse thousands of designs.

    Parameters
    ----------
    pre_ie : False asks the closed form alone, where there is one

    Raises
    ------
    GeometryError
        Where no block can be formed, or a bolt does not hold it.

    >>> from slopekit.kinds.wedge.design import wedge_design
    >>> found = factors_of(wedge_design({"dips": ["45/115", "45/245"]}))
    >>> found.status, round(found.limit, 4), round(found.closed_form, 4), found.agree
    ('slides_on_both', 1.5574, 1.5574, True)
    """
    kind = kind_of(design)
    if pre_ie or not design.HAS_CLOSED_FORM:
        return kind.factors(design)
    from slopekit.kinds.protocol import Factors
    from slopekit.kinds.single_block.held_bolts import has_heads

    closed = kind.closed_form(design, None)
    if has_heads(design.bolts):
        kind.cut(
            design
        )  # raises for a bolt that does not hold the block: the closed form would count its force
    return Factors(
        closed.status,
        None,
        closed.status,
        closed.factor or None,
        None,
        None,
        False,
        also=kind.without_basal(design),
    )


def peak_strength_notice(design: Design, subject: str) -> tuple[Notice, ...]:
    """Return W417, which says that numbers belong to the peak strength, with the factor on residual strength.

    Parameters
    ----------
    subject : the numbers that belong to the peak strength, in words
    """
    residual = _at_residual(design)
    if residual is None:
        return ()
    factor = (
        f"has {residual.limit:.4g}"
        if residual.limit is not None
        else f"has no factor ({residual.status})"
    )
    return (
        Notice(
            "W417",
            f"{subject} of the peak strength: on residual strength, once its joints have slipped, the "
            f"design {factor}",
        ),
    )


def whole_wedge_notice(
    whole_wedge: WithoutBasal | None, target: float, place: str
) -> tuple[Notice, ...]:
    """Return W507 where a design meets a target factor of safety, but the whole wedge below it does not."""
    if whole_wedge is None or not whole_wedge.falls_short(target):
        return ()
    return (
        Notice(
            "W507",
            f"{place} {whole_wedge.WHAT} falls short of {target:g}: {whole_wedge.in_words()}{whole_wedge.ALONE}",
        ),
    )


def dilates(design: Design) -> bool:
    """Return whether any joint of the design dilates as it slips."""
    return any(strength.dilation_deg for strength in design.joint_strengths)


def cut(design: Design) -> Any:
    """Return the blocks of a design, cut and loaded: `one_block_limit.Cut` or `many_blocks_scene.AssemblyScene`."""
    return kind_of(design).cut(design)


def words_named(kind: str, inputs: Mapping[str, Any] | None = None) -> Words:
    """Return the vocabulary of a kind for a design with these inputs; that of an unknown kind is its name alone."""
    found_kind = known_kind(kind)
    return (
        Words(kind, "block", "", "", "", {})
        if found_kind is None
        else found_kind.words.for_inputs(inputs or {})
    )


def status_text(kind: str, status: str) -> str:
    """Return a status as a sentence, in the vocabulary of the kind of design."""
    return words_named(kind).status(status)
