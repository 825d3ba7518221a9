"""The joint sets of a survey: those of its column `set`, or found; orientation, scatter, spacing and traces of each.

>>> import slopekit as sk
>>> found = sk.sets("examples/joints.csv")
>>> [(one.name, len(one.members), str(one.rounded)) for one in found.sets]
[('S1', 22, '55/227'), ('S2', 20, '59/124'), ('S3', 16, '79/001')]
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from slopekit.core.arrays import Floats, Ints
from slopekit.core.codec import digest, json_of
from slopekit.core.errors import Faults, Notice
from slopekit.core.orientation import Line, Plane, number, tenths
from slopekit.core.sheet import counted
from slopekit.design.fields import declare
from slopekit.design.joint_lists import JointList, joint_list
from slopekit.design.words import line_of_words
from slopekit.studies.axes import Axes, axes_of, terzaghi_weights
from slopekit.studies.kinematic.criteria import planes_of_poles
from slopekit.studies.protocol import (
    DESK,
    Option,
    StudyOutcome,
    Workplace,
    documented,
    numbers_given,
    timed,
    whole_number,
)
from slopekit.studies.sets.clustering import MAX_SETS, Clusters, clusters_of, least_bic
from slopekit.studies.sets.sizes import Lengths, metres, spacings_of, traces_of, whole_traces
from slopekit.studies.surveys import (
    MOST_JOINTS,
    AJointList,
    Columns,
    Convention,
    SkipBad,
    joint_list_notices,
    survey_head,
)

_BIAS_ANGLE = {"bias_angle": declare("bias angle", "angle", 1.0, 90.0, default=15.0, code="E307")}
CONFIDENCE = 0.95  # of the limits and cones of means
_SEED = 1
_MIN_JOINTS_FOR_K = 10  # joints of a set below which its K says little
_BIC_DIFFERENCE = (
    6.0  # below it two numbers of sets are hard to tell apart (Kass & Raftery 1995: strong)
)
_MAX_SCATTER_DEG = 45.0  # that a bench takes
_MAX_K = 1e6
_ANGLES = ("dip", "dip_direction")
SHARES = (0.68, 0.95)  # of joints within the cones of variability


@dataclass(frozen=True)
class FoundSet:
    """A joint set.

    Attributes
    ----------
    members : its joints, by their number in the list
    axes : mean, scatter and shape of its poles
    plane : the mean
    angles : mean and standard deviation of dip and of dip direction by themselves, turned over at the vertical, not
        folded back; nan of one joint, the last also of a flat set, whose dip directions go all round
    spacing, trace : where the list has such columns
    ended, whole_mean_m : of the traces, as `whole_traces` has them
    """

    name: str
    members: Ints
    axes: Axes
    plane: Plane
    angles: Mapping[str, float]
    spacing: Lengths | None
    trace: Lengths | None
    ended: int | None
    whole_mean_m: float | None

    @property
    def rounded(self) -> Plane:
        """The mean to a degree."""
        return Plane(
            float(round(self.plane.dip_deg)), float(round(self.plane.dip_direction_deg)) % 360.0
        )

    def to_dict(self) -> dict[str, Any]:
        """The set as JSON values."""
        axes, trace = self.axes, None
        if self.trace is not None:
            trace = {"measured": self.trace, "ended": self.ended, "whole_mean_m": self.whole_mean_m}
        record: dict[str, Any] = json_of(
            {
                "set": self.name,
                "joints": len(self.members),
                "counts_as": axes.joints,
                "plane": str(tenths(self.plane)),
                "dip_deg": self.plane.dip_deg,
                "dip_direction_deg": self.plane.dip_direction_deg,
                "eigenvalues": axes.eigenvalues,
                "resultant": axes.resultant,
                "k": axes.k,
                "k_low": axes.k_low,
                "k_high": axes.k_high,
                "confidence": axes.confidence,
                "cone_of_mean_deg": axes.cone_deg,
                "variability_deg": {f"{share:.0%}": axes.cone_of(share) for share in SHARES},
                "scatter_deg": axes.scatter_deg,
                "elongated": axes.is_elongated,
                "angles": self.angles,
                "spacing": self.spacing,
                "trace": trace,
            }
        )
        return record


@dataclass(frozen=True, repr=False)
class JointSets(StudyOutcome):
    """A survey divided into sets.

    Attributes
    ----------
    sets : as the list names them, or S1, S2, ... the largest first
    of : (n,) index of each joint's set, -1 of none
    tried : where they were found: what each number of sets comes to; () where the list names them
    weights : (n,) against the bias of the scanline, 1 without one; capped : joints whose weight is cut off
    angle_deg : (n,) of each joint to the mean of its set
    """

    name: ClassVar[str] = "sets"
    charts: ClassVar[tuple[str, ...]] = ("stereonet",)
    joints: JointList
    sets: tuple[FoundSet, ...]
    of: Ints
    tried: tuple[Clusters, ...]
    asked: int | None
    scanline: Line | None
    bias_angle_deg: float
    weights: Floats
    capped: int
    angle_deg: Floats
    defaults: tuple[str, ...]
    warnings: tuple[Notice, ...]

    @property
    def are_given(self) -> bool:
        """Whether the list names the sets."""
        return not self.tried

    @property
    def without_set(self) -> tuple[str, ...]:
        """The joints of no set, in the order of the list."""
        return tuple(
            joint.name for joint, k in zip(self.joints.joints, self.of, strict=True) if k < 0
        )

    @property
    def block(self) -> str:
        """The sets for a design of kind bench, as YAML."""
        return _bench_block(self.sets)

    @property
    def scatter_block(self) -> str:
        """The sets as joints that scatter, for `slopekit prob`, as YAML."""
        return _scatter_block(self.sets)

    def files(self) -> dict[str, str]:
        """The block to paste, as a file."""
        return {"sets.yaml": self.block + self.scatter_block} if self.sets else {}

    def input_hash(self) -> str:
        """SHA-256 of the joints and of what was asked for."""
        line = (
            None if self.scanline is None else (self.scanline.trend_deg, self.scanline.plunge_deg)
        )
        sizes = [
            (joint.spacing_m, joint.position_m, joint.trace_m, joint.ends)
            for joint in self.joints.joints
        ]
        options = (self.asked, line, self.bias_angle_deg, self.are_given)
        return digest([options, self.joints.rows(), sizes, self.joints.quantities.tolist()])

    def to_dict(self) -> dict[str, Any]:
        """The result as JSON values."""
        line = self.scanline
        return {
            **survey_head("sets", self.joints, self.input_hash()),
            "inputs": {
                "sets": self.asked,
                "sets_from": "survey" if self.are_given else "clustering",
                "scanline": None
                if line is None
                else {"trend_deg": line.trend_deg, "plunge_deg": line.plunge_deg},
                "bias_angle_deg": self.bias_angle_deg,
                "confidence": CONFIDENCE,
            },
            "defaults": list(self.defaults),
            "joints": len(self.joints),
            "sets": json_of(self.sets),
            "without_set": list(self.without_set),
            "tried": [
                {"sets": len(clusters), "bic": json_of(clusters.bic)} for clusters in self.tried
            ],
            "orientations": [
                {
                    "joint": name,
                    "set": "" if k < 0 else self.sets[k].name,
                    "dip_deg": dip,
                    "dip_direction_deg": direction,
                    "weight": weight,
                }
                for (name, _, dip, direction), k, weight in zip(
                    self.joints.rows(),
                    self.of.tolist(),
                    (self.weights * self.joints.quantities).tolist(),
                    strict=True,
                )
            ],
            "block": self.block,
            "scatter_block": self.scatter_block,
            "timing_s": {"total": self.seconds},
            **self.words(),
        }


@timed
@documented
def sets(
    joints: AJointList,
    *,
    n: Annotated[
        int | None,
        Option("How many sets to find [as many as the joints say].", whole_number, "--sets", "N"),
    ] = None,
    ignore_sets: Annotated[bool, Option("Find sets anew, whatever the column set says.")] = False,
    scanline: Annotated[
        Any,
        Option(
            "The line that was measured along: joints are weighted by it.", metavar="TREND/PLUNGE"
        ),
    ] = None,
    bias_angle: Annotated[
        Any, Option("Joints nearer to the scanline weigh no more than at this angle [15].")
    ] = None,
    convention: Convention = None,
    columns: Columns = None,
    skip_bad: SkipBad = False,
    desk: Workplace = DESK,
) -> JointSets:
    """Joint sets of a survey: found, or those of its column set; mean, Fisher K, cones, spacing, a block to paste.

    Raises
    ------
    DesignError
        With every fault: of the list (E193 its spacings and traces), E137 the number of sets, E104 the scanline, E307
        the bias angle.

    Notes
    -----
    In Python `joints` are the path of a CSV file, a frame, planes ("45/115", (45, 115)), an (n, 2) array of dip and
    dip direction, or {name: plane}.

    The mean of a set is the first eigenvector of Σ w n nᵀ over its unit poles n (3,); Fisher's K = (N - 1) / (N - R)
    with R the length of their sum. Along a scanline a joint has the weight w = 1 / sin of the angle between them.

    References
    ----------
    Hammah & Curran (1998), Int. J. Rock Mech. Min. Sci. 35, 889-905; Fisher (1953) and Terzaghi (1965) from memory.

    Examples
    --------
    >>> import slopekit as sk
    >>> found = sk.sets(["40/175", "42/178", "38/170", "41/181", "75/010", "78/012", "74/008", "76/005"], n=2)
    >>> [str(one.rounded) for one in found.sets], found.without_set
    (['76/009', '40/176'], ())
    """
    faults, defaults = Faults(), list[str]()
    listed: JointList | None = faults.of(
        lambda: joint_list(
            joints, convention, skip_bad, 1, desk.named("convention"), True, MOST_JOINTS, columns
        )
    )
    option = desk.named("scanline")
    line = (
        None
        if scanline is None
        else faults.of(
            lambda: line_of_words(scanline, "the scanline", "E104", f"{option} {scanline}")
        )
    )
    (angle,) = numbers_given(_BIAS_ANGLE, {"bias_angle": bias_angle}, desk.named, faults).values()
    if bias_angle is None and scanline is not None:
        defaults.append("bias_angle")
    if listed is not None:
        _check_number(faults, listed, n, desk)
    faults.refuse()
    assert listed is not None and angle is not None  # noqa: PT018  # no fault: nothing is missing
    poles = -listed.normals()
    weights = (
        np.ones(len(listed)) if line is None else terzaghi_weights(poles, line.vector(), angle)
    )
    capped = (
        0
        if line is None
        else int((np.abs(poles @ line.vector()) < math.sin(math.radians(angle))).sum())
    )
    joint_weights = weights * listed.quantities
    joint_weights *= listed.quantities.sum() / joint_weights.sum()

    tried: tuple[Clusters, ...] = ()
    if ignore_sets or not listed.sets():
        tried = tuple(clusters_of(poles, joint_weights, n, np.random.default_rng(_SEED)))
    names, labels = _set_labels(listed, tried)
    joint_sets = tuple(
        _joint_set(name, np.flatnonzero(labels == k), listed, poles, weights, line)
        for k, name in enumerate(names)
    )
    angles = np.full(len(listed), math.nan)
    for k, joint_set in enumerate(joint_sets):
        angles[labels == k] = np.degrees(
            np.arccos(np.clip(np.abs(poles[labels == k] @ joint_set.axes.mean), 0.0, 1.0))
        )
    outcome = JointSets(
        listed,
        joint_sets,
        labels,
        tried,
        n,
        line,
        angle,
        weights,
        capped,
        angles,
        tuple(defaults),
        (),
    )
    return replace(outcome, warnings=(*joint_list_notices(listed), *_notices(outcome)))


def _set_labels(listed: JointList, tried: Sequence[Clusters]) -> tuple[Sequence[str], Ints]:
    """The names of the sets, and which of them each joint is of (-1: none): found, or those given."""
    if not tried:
        names = listed.sets()
        index = {name: k for k, name in enumerate(names)}
        return names, np.array([index.get(joint.set_name, -1) for joint in listed.joints])
    return _numbered_sets(tried[least_bic(list(tried))])


# -- reading ----------------------------------------------------------------------------------------------------------


def _check_number(faults: Faults, joints: JointList, n: int | None, desk: Workplace) -> None:
    if n is None:
        return
    option, most = desk.named("n"), min(MAX_SETS, len(joints))
    if isinstance(n, bool) or not isinstance(n, int | np.integer) or not 1 <= n <= most:
        faults.add(
            "E137",
            f"{counted(len(joints), 'joint')} cannot be divided into {n} sets, 1 to {most} are possible",
            f"{option} {n}",
            "Leave it out: the joints say how many.",
        )


# -- sets -------------------------------------------------------------------------------------------------------------


def _numbered_sets(clusters: Clusters) -> tuple[tuple[str, ...], Ints]:
    """S1, S2, ... of the sets that have joints left, and the sets of the joints by these."""
    occupied = [k for k in range(len(clusters)) if (clusters.labels == k).any()]
    new_numbers = np.full(len(clusters) + 1, -1)
    new_numbers[occupied] = np.arange(len(occupied))
    return tuple(f"S{k}" for k in range(1, len(occupied) + 1)), new_numbers[clusters.labels]


def _joint_set(
    name: str, members: Ints, joints: JointList, poles: Floats, weights: Floats, line: Line | None
) -> FoundSet:
    axes = axes_of(poles[members], weights[members], joints.quantities[members], CONFIDENCE)
    plane = _plane_of_pole(axes.mean)
    set_joints = [joints.joints[k] for k in members]
    return FoundSet(
        name,
        members,
        axes,
        plane,
        _angle_statistics(
            poles[members], weights[members] * joints.quantities[members], axes, plane
        ),
        spacings_of(set_joints, axes.mean, None if line is None else line.vector(), CONFIDENCE),
        traces_of(set_joints, CONFIDENCE),
        *whole_traces(set_joints),
    )


def _angle_statistics(poles: Floats, weights: Floats, axes: Axes, plane: Plane) -> dict[str, float]:
    """Dips and dip directions about the mean, each pole on the side of the mean."""
    up = np.where((poles @ axes.mean)[:, None] < 0.0, poles, -poles)
    dips = np.degrees(np.arctan2(np.hypot(up[:, 0], up[:, 1]), up[:, 2]))
    dip_directions = np.degrees(np.arctan2(up[:, 0], up[:, 1]))
    deviations = (dip_directions - plane.dip_direction_deg + 180.0) % 360.0 - 180.0
    fractions = weights / weights.sum()
    dip, mean_deviation = float(fractions @ dips), float(fractions @ deviations)
    is_flat, is_single = not plane.dip_deg > 2.0 * axes.scatter_deg, axes.joints <= 1.0
    bessel = math.nan if is_single else axes.joints / (axes.joints - 1.0)
    mean_shift = 0.0 if is_flat or is_single else mean_deviation
    return {
        "dip_mean_deg": dip,
        "dip_sd_deg": math.sqrt(bessel * float(fractions @ (dips - dip) ** 2)),
        "dip_direction_mean_deg": (plane.dip_direction_deg + mean_shift) % 360.0,
        "dip_direction_sd_deg": math.nan
        if is_flat
        else math.sqrt(bessel * float(fractions @ (deviations - mean_deviation) ** 2)),
    }


def _plane_of_pole(pole: Floats) -> Plane:
    planes = planes_of_poles(pole[None])
    return Plane(float(planes.dips_deg[0]), float(planes.dip_directions_deg[0]))


# -- what a reader must know ------------------------------------------------------------------------------------------


def _notices(joint_sets: JointSets) -> Iterator[Notice]:
    """Yield those of W401, W402 and W404 that apply."""
    joints, sets, n_sets = joint_sets.joints, joint_sets.sets, joint_sets.asked
    if joint_sets.are_given and n_sets is not None:
        message = (
            f"the sets are those of the column set of {joints.name}: --sets {n_sets} is not used"
        )
        yield Notice("W404", f"{message}; --ignore-sets finds them anew")
    if not joint_sets.are_given and n_sets is None:
        bic = {len(clusters): clusters.bic for clusters in joint_sets.tried}
        likeliest = min(bic, key=bic.__getitem__)
        rivals = [
            count
            for count in bic
            if count != likeliest and bic[count] - bic[likeliest] < _BIC_DIFFERENCE
        ]
        if likeliest == 0:
            message = f"no sets among the {counted(len(joints), 'joint')} of {joints.name}"
            likelier = (
                "no number of sets is likelier than uniform directions; --sets N divides them"
            )
            yield Notice("W404", f"{message}: {likelier}")
        elif rivals:
            message = f"{counted(likeliest, 'set')} or {' or '.join(map(str, rivals))}: the joints hardly tell which"
            yield Notice(
                "W404",
                f"{message} (BIC within 6); look at the stereonet, --sets N takes another number",
            )
    few = ", ".join(
        f"{joint_set.name} ({len(joint_set.members)})"
        for joint_set in sets
        if len(joint_set.members) < _MIN_JOINTS_FOR_K
    )
    if few:
        yield Notice("W401", f"few joints: {few}; K and its cones are those of these few")
    if joint_sets.capped:
        most = 1.0 / math.sin(math.radians(joint_sets.bias_angle_deg))
        weighs = "weighs" if joint_sets.capped == 1 else "weigh"
        yield Notice(
            "W402",
            f"{counted(joint_sets.capped, 'joint')} within {number(joint_sets.bias_angle_deg)}° of the scanline "
            f"{weighs} {most:.2f}, no more: a line says little of joints along it",
        )
    odd = ", ".join(joint_set.name for joint_set in sets if joint_set.axes.is_elongated)
    if odd:
        message = f"the poles of {odd} scatter more one way than the other: Fisher's K is a mean of the two"
        yield Notice("W401", f"{message}, dip and dip direction by themselves say more")
    if joint_sets.scanline is None and any(joint.position_m is not None for joint in joints.joints):
        yield Notice(
            "W402",
            f"positions of {joints.name} give no spacing without the scanline: --scanline TREND/PLUNGE",
        )
    if joint_sets.scanline is not None and joints.has_quantities:
        message = f"quantities of {joints.name} count besides the weights of the scanline: leave one of them out"
        yield Notice("W402", f"{message} if the quantities are such weights already")


# -- sets as they are pasted into designs -----------------------------------------------------------------------------


def _bench_block(sets: Sequence[FoundSet]) -> str:
    """`sets:` of a design of kind bench; what the survey does not have is left out, and said."""
    lines = []
    for joint_set in sets:
        entries, lacks = [f"plane: {tenths(joint_set.plane)}"], []
        if joint_set.spacing is None:
            lacks.append("add a spacing: the survey has none")
        else:
            entries.append(f"spacing: {metres(joint_set.spacing.mean_m)} m")
        scatter = joint_set.axes.scatter_deg
        if scatter >= 0.05:
            entries.append(f"scatter: {number(round(min(scatter, _MAX_SCATTER_DEG), 1))}")
            lacks += ["scatter cut off at 45°"] if scatter > _MAX_SCATTER_DEG else []
        if joint_set.spacing is not None and joint_set.spacing.sd_m > 0.0:
            variation = joint_set.spacing.sd_m / joint_set.spacing.mean_m
            entries.append(f"spacing_scatter: {min(1.0, variation):.0%}".replace("%", " %"))
        k = (
            [f"K {number(float(f'{joint_set.axes.k:.3g}'))}"]
            if math.isfinite(joint_set.axes.k)
            else []
        )
        remark = "; ".join([counted(len(joint_set.members), "joint"), *k, *lacks])
        lines.append(f"  {_yaml_key(joint_set.name)}: {{{', '.join(entries)}}}  # {remark}")
    return "\n".join(["sets:", *lines, ""]) if lines else ""


def _scatter_block(sets: Sequence[FoundSet]) -> str:
    """`joints:` whose planes scatter as the sets do, of which a wedge takes two and a plane one."""
    lines = []
    for joint_set in sets:
        if not 0.0 < joint_set.axes.k <= _MAX_K:
            lines.append(f"  {_yaml_key(joint_set.name)}: {{plane: {tenths(joint_set.plane)}}}")
            continue
        k = number(float(f"{joint_set.axes.k:.3g}"))
        if joint_set.axes.is_elongated and not math.isnan(joint_set.angles["dip_direction_sd_deg"]):
            normals = (
                (joint_set.angles[f"{angle}_mean_deg"], joint_set.angles[f"{angle}_sd_deg"])
                for angle in _ANGLES
            )
            dip, direction = (
                f"{{dist: normal, mean: {mean:.1f}, sd: {sd:.1f}}}" for mean, sd in normals
            )
            lines.append(
                f"  {_yaml_key(joint_set.name)}: {{plane: {{dip: {dip}, dip_direction: {direction}}}}}"
                f"  # Fisher's K {k}"
            )
        else:
            lines.append(
                f"  {_yaml_key(joint_set.name)}: {{plane: {{dist: fisher, mean: {tenths(joint_set.plane)}, k: {k}}}}}"
            )
    return "\n".join(["joints:", *lines, ""]) if lines else ""


def _yaml_key(name: str) -> str:
    """A name as a key of YAML."""
    if re.fullmatch(r"[A-Za-z_][\w .-]*\w|[A-Za-z_]", name) and name.lower() not in (
        "yes",
        "no",
        "on",
        "off",
        "true",
    ):
        return name
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'
