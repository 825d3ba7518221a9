"""The kinds of design: one file a kind, loaded when a design of it is asked for."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from slopekit.design import registry
from slopekit.design.common import Design
from slopekit.notices import size_notices
from slopekit.result import Result, Words

if TYPE_CHECKING:
    from slopekit.kinds.protocol import Factors, Kind


def register(kind: "Kind[Any]") -> None:
    """Make a kind from outside known: its files are read, analysed, printed, checked and varied as any other's."""
    registry.KINDS[kind.name] = kind


def kind_named(name: str) -> "Kind[Any]":
    """What a kind says of itself. Raises KeyError for a name that is none."""
    kind: Kind[Any] = registry.kind_named(name)
    return kind


def known_kind(name: object) -> "Kind[Any] | None":
    """What a kind says of itself; None for a name that is none, as documents from elsewhere may have."""
    return kind_named(str(name)) if name in registry.KINDS else None


def kind_of(design: Design) -> "Kind[Any]":
    """What the kind of a design says of itself."""
    return kind_named(design.kind)


def analyse(design: Design, elastic: bool = False, bracket: bool = False) -> Result:
    """Analyse a design of any kind.

    Parameters
    ----------
    elastic : elastic blocks beside the rigid ones; bracket : and where they no longer come to rest

    Raises
    ------
    GeometryError
        Where no block can be formed.
    """
    kind = kind_of(design)
    if elastic or bracket:
        from slopekit.elastic.meshing import required

        required()
    result = kind.analyse(design)
    if said := tuple(size_notices(result.geometry.total_height_m)):
        result = replace(result, warnings=(*result.warnings, *said))
    if any(strength.residual for strength in kind.strengths(design)):
        from slopekit.kinds.residual import with_residual

        result = with_residual(kind, result)
    if elastic or bracket:
        from slopekit.kinds.elastic import with_elastic

        result = with_elastic(kind, result, bracket)
    return result


def factors_of(design: Design, pre_ie: bool = True) -> "Factors":
    """Both factors of safety of a design, and nothing else: what studies ask thousands of times.

    Parameters
    ----------
    pre_ie : False asks the closed form alone, where there is one

    Raises
    ------
    GeometryError
        Where no block can be formed.

    >>> from slopekit.kinds.wedge.design import wedge_design
    >>> found = factors_of(wedge_design({"dips": ["45/115", "45/245"]}))
    >>> found.status, round(found.limit, 4), round(found.closed_form, 4), found.agree
    ('slides_on_both', 1.5574, 1.5574, True)
    """
    kind = kind_of(design)
    if kind.closed_form is None or pre_ie:
        return kind.factors(design)
    from slopekit.kinds.protocol import Factors

    closed = kind.closed_form(design)
    return Factors(closed.status, None, closed.status, closed.factor or None, None, None, False, True)


def dilates(design: Design) -> bool:
    """Whether any joint of the design dilates as it slips."""
    return any(strength.dilation_deg for strength in kind_of(design).strengths(design))


def cut(design: Design) -> Any:
    """The blocks of a design, cut and loaded: `one_block.Cut` or `many_blocks_scene.AssemblyScene`."""
    return kind_of(design).cut(design)


def words_named(kind: str, inputs: Mapping[str, Any] | None = None) -> Words:
    """What a kind calls things; one that is not known, as documents from elsewhere may have, has its name alone."""
    known = known_kind(kind)
    if known is None:
        return Words(kind, "block", "", "", "", {})
    return next((said for key, said in known.variants.items() if (inputs or {}).get(key) is not None), known.words)


def status_text(kind: str, status: str) -> str:
    """A status as a sentence, in the words of the kind of design."""
    return words_named(kind).status(status)
