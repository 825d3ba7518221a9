"""The kinds of design: one file a kind, loaded when a design of it is asked for."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from slopekit.core.errors import Notice, SlopekitError
from slopekit.design import registry
from slopekit.design.common import Design
from slopekit.evidence import WithoutBasal
from slopekit.notices import (
    means_taken,
    not_as_given,
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
    """Make a kind from outside known: its files are read, analysed, printed, checked and varied as any other's."""
    registry.KINDS[kind.name] = kind


def kind_named(name: str) -> "Kind[Any]":
    """What a kind says of itself. Raises KeyError for a name that is none."""
    kind: Kind[Any] = registry.kind_named(name)
    return kind


def known_kind(name: object) -> "Kind[Any] | None":
    """What a kind says of itself; None for a name that is none, as documents from elsewhere may have."""
    return kind_named(str(name)) if str(name) in registry.KINDS else None


def kind_of(design: Design) -> "Kind[Any]":
    """What the kind of a design says of itself."""
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
    result = with_all_said(kind.analyse(design))
    if elastic:
        from slopekit.kinds.elastic import with_elastic

        result = with_elastic(kind, result)
    return result


def with_all_said(result: Result) -> Result:
    """Return what a kind found with what is said of all kinds: W302 of its size, the factors on residual strength."""
    notices = _of_size(result.design, result.geometry.total_height_m)
    result = replace(result, warnings=(*result.warnings, *notices)) if notices else result
    residual = _at_residual(result.design)
    if residual is None:
        return result
    compared = replace(result, comparisons=replace(result.comparisons, residual=residual))
    return replace(compared, warnings=(*compared.warnings, *_residual_notices(compared, residual)))


def _at_residual(design: Design) -> "Factors | None":
    """Both factors on residual strength, after slip; None where no joint has one."""
    if not any(strength.residual for strength in design.joint_strengths):
        return None
    return kind_of(design).factors(replace(design.at_residual(), rules=()))


def _residual_notices(result: Result, residual: "Factors") -> Iterator[Notice]:
    """Yield W417 of a result beside its factors on residual strength."""
    peak = result.fos.limit
    if residual.limit is not None and peak is not None and residual.limit > peak * (1.0 + _SAME):
        yield Notice("W417", f"the residual factor {residual.limit:.4g} lies above the peak's {peak:.4g}: other "
                     "joints open or carry then; is the residual strength that of these joints?")  # fmt: skip
    if result.met_by_peak_only:
        number = f"is {residual.limit:.4g}" if residual.limit is not None else f"does not exist ({residual.status})"
        yield Notice("W417", f"acceptance is met by the peak strength only: the residual factor {number}; once "
                     "the joints have slipped, the rule is broken")  # fmt: skip


def _of_size(design: Design, height_m: float | None) -> tuple[Notice, ...]:
    """Return W302 of a height, and of pressures on blocks of that height, that are likelier slips than meant."""
    return () if height_m is None else (*size_notices(height_m), *_pressure_notices(design, height_m))


def _pressure_notices(design: Design, height_m: float) -> Iterator[Notice]:
    """Yield W302 of the mean water pressures that a design gives: of its interfaces, or of pairs of blocks."""
    entries: Sequence[Any] = getattr(design, "pressures_kpa", ()) or design.water.pressures_kpa
    pressures = [entry[-1] if isinstance(entry, tuple) else entry for entry in entries]
    return pressure_notices(pressures, height_m, design.water_unit_weight_kn_m3)


def slips_of_size(design: Design) -> tuple[Notice, ...]:
    """What `analyse` says of the size of a design, without its analysis: W302; nothing where no block forms."""
    return _of_size(design, _height_m(design))


def _height_m(design: Design) -> float | None:
    """Return the height of the blocks; None where none form, which the run says."""
    try:
        return float(cut(design).height_m)
    except SlopekitError:
        return None


def likely_slips(design: Design, varied: Sequence[str] = ()) -> list[Notice]:
    """Return W302 of numbers of a design that are likelier typed in another unit than meant.

    Parameters
    ----------
    varied : the paths that a study gives other values: what the design has there does not count
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
    """What a study of a design at its means says of the inputs: what was taken (W379, W320), and `likely_slips`."""
    return (*not_as_given(design, varied), *means_taken(design, varied), *likely_slips(design, varied))


def factors_of(design: Design, pre_ie: bool = True) -> "Factors":
    """Both factors of safety of a design, and nothing else: what studies ask thousands of times.

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
        kind.cut(design)  # which refuses a bolt that does not hold the block: the closed form would count its force
    return Factors(
        closed.status, None, closed.status, closed.factor or None, None, None, False, also=kind.without_basal(design)
    )  # fmt: skip


def peak_only(design: Design, subject: str) -> tuple[Notice, ...]:
    """W417: numbers are those of the peak strength, and what is left of the factor on the residual strength.

    Parameters
    ----------
    subject : what is of the peak strength, in words
    """
    residual = _at_residual(design)
    if residual is None:
        return ()
    factor = f"has {residual.limit:.4g}" if residual.limit is not None else f"has no factor ({residual.status})"
    return (Notice("W417", f"{subject} of the peak strength: on residual strength, once its joints have slipped, the "
                   f"design {factor}"),)  # fmt: skip


def also_falls_short(whole_wedge: WithoutBasal | None, target: float, place: str) -> tuple[Notice, ...]:
    """W507: a design meets a target, what acceptance of it is held against besides does not."""
    if whole_wedge is None or not whole_wedge.falls_short(target):
        return ()
    return (
        Notice(
            "W507", f"{place} {whole_wedge.WHAT} falls short of {target:g}: {whole_wedge.in_words()}{whole_wedge.ALONE}"
        ),
    )


def dilates(design: Design) -> bool:
    """Whether any joint of the design dilates as it slips."""
    return any(strength.dilation_deg for strength in design.joint_strengths)


def cut(design: Design) -> Any:
    """The blocks of a design, cut and loaded: `one_block.Cut` or `many_blocks_scene.AssemblyScene`."""
    return kind_of(design).cut(design)


def words_named(kind: str, inputs: Mapping[str, Any] | None = None) -> Words:
    """What a kind calls things; one that is not known, as documents from elsewhere may have, has its name alone."""
    found_kind = known_kind(kind)
    return Words(kind, "block", "", "", "", {}) if found_kind is None else found_kind.words.of(inputs or {})


def status_text(kind: str, status: str) -> str:
    """A status as a sentence, in the words of the kind of design."""
    return words_named(kind).status(status)
