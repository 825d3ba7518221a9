"""What of a result a design of kind blocks cannot say, in words."""

from collections.abc import Mapping, Sequence
from typing import Any

from slopekit.exchange.source import ExportSource, Pair
from slopekit.kinds.protocol import CarriedJoint

#: What acceptance can name in a design of kind blocks; the last only where its criterion is asked for.
_RULES = ("fos", "fos.limit", "fos.static_bound")
_ALL_PAIRS = "fos.all_pairs_failed"
_SHOWN = 3


def acceptance(inputs: Mapping[str, Any]) -> tuple[list[str], list[str]]:
    """The acceptance rules that kind blocks can judge, and in words those it cannot."""
    known = (*_RULES, _ALL_PAIRS) if inputs.get("criterion") == "all-pairs" else _RULES
    kept: list[str] = []
    lost: list[str] = []
    for one in inputs.get("rules", ()):
        text = f"{one['name']} {one['relation']} {one['value']!r}"
        (kept if one["name"] in known else lost).append(text)
    if not lost:
        return kept, []
    word = "acceptance" if len(lost) == 1 else f"{len(lost)} rules of acceptance"
    return kept, [f"{word} ({', '.join(lost)}): kind blocks has no such factor"]


def lost_of_laws(inputs: Mapping[str, Any]) -> list[str]:
    """Curved strength, of which the cohesion and the friction angle of one line are written."""
    given = [inputs.get("strength"), *(strength for _, strength in inputs.get("strengths", ()))]
    laws = [one["law"] for one in given if isinstance(one, Mapping) and "law" in one]
    named = dict.fromkeys(law["law"] for law in (*laws, *(law for law in inputs.get("laws", ()) if law)))
    return [f"curved strength ({', '.join(named)}): c and φ of its line up to 100 kPa are written"] if named else []


def lost_of_strength_and_water(source: ExportSource) -> list[str]:
    """Residual strength, and a water table over the contacts of many blocks."""
    inputs = source.document["inputs"]
    given = [inputs.get("strength"), *(strength for _, strength in inputs.get("strengths", ()))]
    has_residual = any(isinstance(one, Mapping) and "residual" in one for one in given) or "residuals" in inputs
    lost = ["residual strength: the peak alone is written"] if has_residual else []
    has_table = "table_points_m" in inputs or "table_plane" in inputs
    if has_table and source.has_many:
        lost.append("the water table: the blocks are dry, write water: {mode: table, ...} again")
    return lost


def lost_of_criterion(source: ExportSource) -> list[str]:
    """The all-pairs factor of one block is sought in another way than that of many."""
    if source.document["inputs"].get("criterion") != "all-pairs" or source.has_many:
        return []
    factor = (source.document.get("fos") or {}).get("all_pairs_failed")
    here = "here none was found" if factor is None else f"here it is {factor:.6g}"
    return [f"the search for all pairs failed: kind blocks has its own, compare that factor ({here})"]


def lost_of_mixed(source: ExportSource, mixed: Sequence[str], pressures: Mapping[Pair, float]) -> list[str]:
    """Interfaces that had several strengths or pressures and have one here."""
    if not mixed:
        return []
    if source.carried.mixed:
        shown = [f"{'/'.join(pair)} {value:g} kPa" for pair, value in pressures.items() if "/".join(pair) in mixed]
        return [source.carried.mixed + (f" ({_some(shown)})" if shown else "")]
    return [f"{len(mixed)} interfaces with several strengths or pressures have that of the largest part "
            f"({_some(mixed)})"]  # fmt: skip


def lost_of_loads(away: Sequence[str]) -> list[str]:
    """Loads by their names whose block was not chosen."""
    if not away:
        return []
    verb = "acts on a block" if len(away) == 1 else "act on blocks"
    return [f"{', '.join(away)}, which {verb} not chosen"]


def pressures_of(
    source: ExportSource, joints: Mapping[str, CarriedJoint], of_pair: Mapping[Pair, str], files: Mapping[str, str]
) -> dict[Pair, float]:
    """Mean water pressures (kPa) of pairs; those of single blocks act as forces."""
    if source.carried.pressures is not None:
        given = source.carried.pressures(source.document["inputs"])
        return {(a, b): value for a, b, value in given if a in files and b in files}
    return {pair: joints[joint].pressure for pair, joint in of_pair.items() if joints[joint].pressure}


def _some(texts: Sequence[str]) -> str:
    return ", ".join(texts[:_SHOWN]) + (", …" if len(texts) > _SHOWN else "")
