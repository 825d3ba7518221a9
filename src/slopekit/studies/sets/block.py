"""Joint sets as they are pasted into designs."""

import math
import re

from slopekit.core.orientation import number
from slopekit.core.sheet import counted
from slopekit.studies.sets.run import FoundSet, JointSets
from slopekit.studies.sets.sizes import metres

_MOST_SCATTER_DEG = 45.0  # that a bench takes
_MOST_K = 1e6
_ANGLES = ("dip", "dip_direction")


def bench_block(joint_sets: JointSets) -> str:
    """`sets:` of a design of kind bench; what the survey does not have is left out, and said."""
    lines = []
    for one in joint_sets.sets:
        parts, lacks = [f"plane: {_plane(one)}"], []
        if one.spacing is None:
            lacks.append("add a spacing: the survey has none")
        else:
            parts.append(f"spacing: {metres(one.spacing.mean_m)} m")
        scatter = one.axes.scatter_deg
        if scatter >= 0.05:
            parts.append(f"scatter: {number(round(min(scatter, _MOST_SCATTER_DEG), 1))}")
            lacks += ["scatter cut off at 45°"] if scatter > _MOST_SCATTER_DEG else []
        if one.spacing is not None and one.spacing.sd_m > 0.0:
            varies = one.spacing.sd_m / one.spacing.mean_m
            parts.append(f"spacing_scatter: {min(1.0, varies):.0%}".replace("%", " %"))
        k = [f"K {number(float(f'{one.axes.k:.3g}'))}"] if math.isfinite(one.axes.k) else []
        said = "; ".join([counted(len(one.members), "joint"), *k, *lacks])
        lines.append(f"  {_key(one.name)}: {{{', '.join(parts)}}}  # {said}")
    return "\n".join(["sets:", *lines, ""]) if lines else ""


def scatter_block(joint_sets: JointSets) -> str:
    """`joints:` whose planes scatter as the sets do, of which a wedge takes two and a plane one."""
    lines = []
    for one in joint_sets.sets:
        if not 0.0 < one.axes.k <= _MOST_K:
            lines.append(f"  {_key(one.name)}: {{plane: {_plane(one)}}}")
            continue
        k = number(float(f"{one.axes.k:.3g}"))
        if one.axes.is_elongated and not math.isnan(one.angles["dip_direction_sd_deg"]):
            normals = ((one.angles[f"{angle}_mean_deg"], one.angles[f"{angle}_sd_deg"]) for angle in _ANGLES)
            dip, way = (f"{{dist: normal, mean: {mean:.1f}, sd: {sd:.1f}}}" for mean, sd in normals)
            lines.append(f"  {_key(one.name)}: {{plane: {{dip: {dip}, dip_direction: {way}}}}}  # Fisher's K {k}")
        else:
            lines.append(f"  {_key(one.name)}: {{plane: {{dist: fisher, mean: {_plane(one)}, k: {k}}}}}")
    return "\n".join(["joints:", *lines, ""]) if lines else ""


def _plane(one: FoundSet) -> str:
    dip, direction = round(one.plane.dip_deg, 1), round(one.plane.dip_direction_deg, 1) % 360.0
    whole, _, tenth = f"{direction:.1f}".partition(".")
    return f"{number(dip)}/{whole.zfill(3)}" + (f".{tenth}" if tenth != "0" else "")


def _key(name: str) -> str:
    """A name as a key of YAML."""
    if re.fullmatch(r"[A-Za-z_][\w .-]*\w|[A-Za-z_]", name) and name.lower() not in ("yes", "no", "on", "off", "true"):
        return name
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'
