"""The studies as Python calls: `sk.check`, `sk.prob`, `sk.sweep`, ...; each loads its code only when it is called."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from slopekit.design.common import Design
    from slopekit.studies.check import Check
    from slopekit.studies.combos import Combos
    from slopekit.studies.kinematic import Kinematic
    from slopekit.studies.probability import Probability
    from slopekit.studies.ranges import Within
    from slopekit.studies.solutions import Solution
    from slopekit.studies.solve_probability import ProbabilitySolution
    from slopekit.studies.support_records import Support
    from slopekit.studies.sweep import Methods, Sweep
    from slopekit.studies.tornado import Tornado


def check(design: "Design") -> "Check":
    """Check a loaded design: closed form against PRE-IE over a ladder of effort, and what the number rests on.

    Raises GeometryError where no block can be formed.
    """
    from slopekit.studies.check import check as check_design

    return check_design(design)


def prob(
    design: "Design",
    n: int | None = None,
    *,
    seed: int = 1,
    method: str = "monte-carlo",
    by: Any = None,
    target: float = 1.0,
    confirm: int = 200,
    near: float | None = None,
    confidence: float = 0.95,
    accept: float | None = None,
    jobs: Any = 1,
    scheduler: str | None = None,
    executor: Any = None,
) -> "Probability":
    """The probability that the factor of safety of a design, with numbers that scatter, lies below a target.

    Parameters
    ----------
    n : samples: 20,000 by the closed form, 1,000 where PRE-IE has to be asked
    seed : the same seed gives the same numbers; method : monte-carlo, latin-hypercube or sobol
    by : closed-form or pre-ie; left out, the closed form where the kind has one that knows all of the design
    confirm : samples at random that PRE-IE looks at; near : besides all within this part of the target
    confidence : of the limits; accept : largest probability accepted
    jobs : processes; scheduler : of a Dask cluster; executor : any of `concurrent.futures`

    Raises
    ------
    DesignError
        E302 nothing scatters, E307 and E308 for what is not understood.
    """
    from slopekit.studies.probability import probability
    from slopekit.studies.running import checked_crew

    return probability(
        design, n, seed=seed, method=method, by=by, target=target, confirm_count=confirm, near=near,
        confidence=confidence, accept=accept, crew=checked_crew(jobs, scheduler, executor),
    )  # fmt: skip


def sweep(
    design: "Design",
    keys: "Mapping[str, Any]",
    *,
    methods: "Methods" = "both",
    fos: float | None = None,
    jobs: Any = 1,
    scheduler: str | None = None,
) -> "Sweep":
    """A loaded design at many values of one of its numbers, or of two.

    Parameters
    ----------
    keys : dotted paths and their values: numbers, texts with units, or "60:80:5" (from, to, how many)
    methods : "both", "closed-form" (quick) or "pre-ie"
    fos : a factor of safety: where it is passed is said, as for 1 and the acceptance rules
    jobs, scheduler : who does the work

    Raises
    ------
    DesignError
        With every fault of the keys. Points that form no block are points: they keep their code and reason.

    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> swept = sk.sweep(sk.load(wedge), {"water.fill": [0, 1]})
    >>> [round(point.factors.limit, 4) for point in swept.points]
    [1.5574, 1.039]
    """
    from slopekit.studies.running import checked_crew
    from slopekit.studies.sweep import sweep as sweep_design

    return sweep_design(design, keys, methods=methods, fos=fos, crew=checked_crew(jobs, scheduler))


def tornado(
    design: "Design",
    ranges: "Mapping[str, Within] | None" = None,
    *,
    methods: "Methods" = "both",
    jobs: Any = 1,
    scheduler: str | None = None,
) -> "Tornado":
    """What each number of a loaded design does to its factor of safety, one at a time, the one that does most first.

    Parameters
    ----------
    ranges : (low, high) or "lo:hi" of some keys; the others take theirs by a rule (`slopekit.studies.tornado.RULE`)

    Raises
    ------
    DesignError
        With every fault of the keys.
    """
    from slopekit.studies.running import checked_crew
    from slopekit.studies.tornado import tornado as tornado_of

    return tornado_of(design, ranges, methods=methods, crew=checked_crew(jobs, scheduler))


def solve(
    design: "Design",
    key: str,
    *,
    fos: float | None = None,
    pf: float | None = None,
    within: "Within | None" = None,
    n: int | None = None,
    seed: int = 1,
    jobs: Any = 1,
    scheduler: str | None = None,
) -> "Solution | ProbabilitySolution":
    """The value of one number of a loaded design that gives a factor of safety, or a probability of failure.

    Parameters
    ----------
    key : dotted path
    fos : the target; left out, the design's acceptance rule. With `pf`: what fails lies below it [1]
    pf : a probability of failure as the target; n, seed : of its samples
    within : (low, high) or "lo:hi", between which to look

    Raises
    ------
    DesignError
        With every fault of the input. Where no value gives the target, `answer` is None and `reason` says why.

    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> round(sk.solve(sk.load(wedge), "water.fill", fos=1.2).answer.value, 4)
    0.6894
    """
    from slopekit.studies.running import checked_crew

    crew = checked_crew(jobs, scheduler)
    if pf is not None:
        from slopekit.studies.solve_probability import solve_for_probability

        return solve_for_probability(design, key, pf, fos=fos, n=n, seed=seed, within=within, crew=crew)
    from slopekit.studies.solve import solve as solve_design

    return solve_design(design, key, fos=fos, within=within, crew=crew)


def support(
    design: "Design",
    fos: Any = 1.5,
    *,
    acts: Any = None,
    toward: Any = None,
    plunge: Any = None,
    bolt_capacity: Any = 200.0,
    spacing: Any = None,
    bond: Any = 3.0,
    length: Any = None,
) -> "Support":
    """Bolts, or a pressure on the face, that give a wedge or a plane a factor of safety; bolts that it has count.

    Parameters
    ----------
    fos : the target
    acts : "active" or "passive"; both when left out
    toward : "000/-05", trend/plunge of the bolts' force on the block, into the rock; the best direction comes as well
    plunge : "-5,15", plunges that can be drilled (positive downward), for the best direction within them
    bolt_capacity : kN; spacing : m, of the heads on the face; bond : m, anchorage behind the joint; length : m, of all

    Raises
    ------
    DesignError
        E320 for other kinds, E321 for what is not understood. GeometryError where no block can be formed.

    >>> import slopekit as sk
    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> bolts = sk.support(sk.load(wedge), 1.7, acts="active").cases[0]
    >>> round(bolts.force), round(bolts.closed_form.fos, 6), round(bolts.pre_ie.fos, 6)
    (168045, 1.7, 1.7)
    """
    from slopekit.studies.support import support as look_for

    return look_for(
        design, fos, acts=acts, toward=toward, plunge=plunge, bolt_capacity=bolt_capacity, spacing=spacing, bond=bond,
        length=length,
    )  # fmt: skip


def combos(
    joints: Any,
    *,
    face: Any = None,
    upper: Any = None,
    height: Any = None,
    c: Any = None,
    phi: Any = None,
    density: Any = None,
    unit_weight: Any = None,
    water: Any = None,
    seismic: Any = None,
    gravity: Any = None,
    water_unit_weight: Any = None,
    agree_within: Any = None,
    fos: Any = None,
    top: Any = None,
    persistence: Any = None,
    bench_width: Any = None,
    max_volume: Any = None,
    min_volume: Any = None,
    convention: str | None = None,
    skip_bad: bool = False,
    jobs: Any = 1,
    scheduler: str | None = None,
) -> "Combos":
    """Every pair of a joint survey as a wedge in a slope: removable or not and why, ranked; PRE-IE on the worst.

    Parameters
    ----------
    joints : path of a CSV file, planes ("45/115", (45, 115)), an (n, 2) array or {name: plane}
    face, upper : dip / dip direction; upper [level]
    height : of the slope, vertical, from the toe of a wedge up the dip of the face to the crest [15 m]
    c, phi : of joints whose own columns are empty
    density, unit_weight, water, seismic, gravity, water_unit_weight, agree_within : as for `wedge`
    fos : target; top : how many of the worst PRE-IE looks at [10]
    persistence, bench_width, max_volume : wedges are scaled down to these; min_volume : smaller ones are left out
    convention : what a strike column means; skip_bad : leave bad rows out, listed
    jobs, scheduler : who does PRE-IE's part

    Raises
    ------
    DesignError
        With every fault of the input. GeometryError where the slope has no crest.
    """
    from slopekit.studies.combos import combos as look_at
    from slopekit.studies.running import checked_crew

    slope = {
        "face": face, "upper": upper, "height": height, "c": c, "phi": phi, "density": density,
        "unit_weight": unit_weight, "water": water, "seismic": seismic, "gravity": gravity,
        "water_unit_weight": water_unit_weight, "agree_within": agree_within,
    }  # fmt: skip
    limits = {
        "persistence": persistence, "bench_width": bench_width, "max_volume": max_volume, "min_volume": min_volume,
    }  # fmt: skip
    return look_at(
        joints, slope, convention=convention, skip_bad=skip_bad, fos=fos, top=top, limits=limits,
        crew=checked_crew(jobs, scheduler),
    )  # fmt: skip


def kinematic(
    joints: Any,
    *,
    face: Any = None,
    phi: Any = None,
    lateral: Any = None,
    lateral_toppling: Any = None,
    faces: Any = None,
    convention: str | None = None,
    skip_bad: bool = False,
) -> "Kinematic":
    """Test a joint survey against a slope: planar and wedge sliding, flexural and direct toppling.

    Parameters
    ----------
    joints : path of a CSV file, planes ("45/115", (45, 115)), an (n, 2) array or {name: plane}
    face : dip / dip direction
    phi : friction angle of joints without their own [30]; lateral, lateral_toppling : limits in degrees [20, 30]
    faces : dips of the face to go through, "45:90:5" or a list
    convention : what a strike column means; skip_bad : leave bad rows out, listed

    Raises
    ------
    DesignError
        With every fault of the input.

    >>> import slopekit as sk
    >>> sk.kinematic(["40/175", "75/010"], face="65/180", phi=30).joint_names("planar")
    ('J1',)
    """
    from slopekit.studies.kinematic import kinematic as test

    return test(joints, face, phi, lateral, lateral_toppling, faces, convention, skip_bad)
