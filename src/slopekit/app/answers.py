"""The answers that the app's page shows of a design: numbers, status, check, sensitivities, net, scene, faults.

>>> from slopekit.app.session import Session, opened_template
>>> answer, result = analysed_answer(Session(opened_template("wedge")).moment)
>>> answer["lead"], answer["status_words"], answer["agree"], answer["net"]["line"]["trend"]
('1.557', 'slides on both planes', True, 180.0)
>>> answer["governs"][1]["text"], answer["governs"][1]["label"], answer["governs"][1]["paths"]
('φ +1° +0.06', 'friction angle of weak', ['strength.weak.phi'])
"""

import time
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache
from typing import Any

from slopekit.app.controls import text_at, tree, values_of
from slopekit.app.session import Moment
from slopekit.core.codec import json_of
from slopekit.core.errors import Fault, Notice, SlopekitError
from slopekit.core.orientation import Plane
from slopekit.core.sheet import factor_text
from slopekit.design.common import Design
from slopekit.design.fields import words_of
from slopekit.design.reading.nodes import Node
from slopekit.kinds import analyse, kind_of
from slopekit.kinds.sheets.result import moments
from slopekit.kinds.sheets.shared import judged_on, verdict, why_no_sensitivity
from slopekit.result import RULE_QUANTITIES, Result
from slopekit.strength.registry import LAWS
from slopekit.strength.waviness import Wavy
from slopekit.studies.keys import Key
from slopekit.views.charts.orientation_charts import orientations_of
from slopekit.views.solid.stage import Stage
from slopekit.views.solid.viewer_data import data_of

Answer = dict[str, Any]
_FACTORS = (
    "limit",
    "lowest",
    "closed_form",
    "static_bound",
)  # of a result, in the order of the sheet
#: What changes of SENSITIVITY are made to, by how their names begin: the ends of the paths.
_PATHS_OF_CHANGES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("full water", ("water.fill",)),
    ("load", ("footing.load", "footing.load.mean")),
    ("dip +", ("weak_plane.dip", "weak_plane.dip.mean")),
)


def analysed_answer(
    moment: Moment, final: bool = True, with_scene: bool = True
) -> tuple[Answer, Result | None]:
    """Analyse a design; return the answer for the page, and the result where there is one.

    Bad input and blocks that cannot form are faults in the answer.

    Parameters
    ----------
    final : whether the slider was let go
    with_scene : what is drawn too
    """
    began = time.perf_counter()
    if moment.faults:
        return answer_of_faults(moment, moment.faults, final, began), None
    try:
        result = analyse(moment.design)
    except SlopekitError as error:
        return answer_of_faults(moment, error.faults, final, began), None
    took = time.perf_counter() - began
    answer = answer_of_result(moment, result, final)
    if with_scene:
        answer["scene"] = scene_of(result)
    answer["ms"] = {"analysis": took * 1e3, "all": (time.perf_counter() - began) * 1e3}
    return answer, result


def answer_of_result(moment: Moment, result: Result, final: bool = True) -> Answer:
    """Return the answer of a result, without its scene."""
    keys, fos = values_of(moment.design), result.fos
    lead, lead_of = fos.limit, "PRE-IE"
    if result.leading is not None:
        name, lead = result.leading
        lead_of = RULE_QUANTITIES.get(name, name.replace("_", " "))
    slope = [
        section
        for section in kind_of(moment.design).slope(moment.design, result)
        if section.content
    ]
    return {
        **_empty(moment, final),
        "lead": None if lead is None else factor_text(lead).strip(),
        "lead_of": lead_of,
        "status": result.status,
        "status_words": result.status_text,
        "fos": {name: getattr(fos, name) for name in _FACTORS},
        "agree": result.agree,
        "difference": result.difference,
        "agree_words": verdict(result, moment.design.analysis.agree_within),
        "moments_govern": result.moments_govern,
        "moments": moments(result),
        "accepted": result.accepted,
        "line": result.line,
        "governs": list(_sensitivities(moment.design, result, keys)),
        "why_no_governs": why_no_sensitivity(result),
        "acceptance": [
            {"rule": str(rule), "on": judged_on(result, rule), "met": result.meets(rule)}
            for rule in moment.design.rules
        ],
        "notices": [*_design_notices(moment), *(notice_of(notice) for notice in result.warnings)],
        "words": [
            entry for section in slope[:1] for entry in section.content if isinstance(entry, str)
        ],
        "net": net_of(moment, result),
        "stale": False,
    }


def answer_before_analysis(moment: Moment, final: bool, last: Answer | None) -> Answer:
    """Return the answer of a design that is not analysed yet: the last numbers, marked as stale, and its own net."""
    if moment.faults:
        return answer_of_faults(moment, moment.faults, final)
    stale = {
        "stale": True,
        "rev": moment.rev,
        "final": final,
        "net": net_of(moment, None),
        "faults": [],
    }
    return (
        _empty(moment, final) | {"notices": _design_notices(moment)} if last is None else dict(last)
    ) | stale


def scene_of(result: Result) -> dict[str, Any]:
    """Return the scene of a result as the viewer draws it."""
    document = {
        "kind": result.kind,
        "inputs": result.design.inputs(),
        "geometry": {"thickness_m": getattr(result.geometry, "thickness_m", None)},
        "assembly": json_of(result.findings),
        "mechanisms": json_of(result.mechanisms),
    }
    return data_of(Stage(document, result.scene))


def _empty(moment: Moment, final: bool) -> Answer:
    return {
        "rev": moment.rev,
        "final": final,
        "lead": None,
        "lead_of": "",
        "status": "",
        "status_words": "",
        "fos": dict.fromkeys(_FACTORS),
        "agree": None,
        "agree_words": "",
        "difference": None,
        "moments_govern": False,
        "moments": [],
        "accepted": None,
        "line": "",
        "governs": [],
        "why_no_governs": "",
        "acceptance": [],
        "notices": [],
        "faults": [],
        "words": [],
        "net": None,
        "scene": None,
        "ms": {"analysis": 0.0, "all": 0.0},
        "stale": False,
    }


def answer_of_faults(
    moment: Moment, faults: tuple[Fault, ...], final: bool, began: float | None = None
) -> Answer:
    """Return the answer of a design with faults: these and its net, no numbers."""
    took = 0.0 if began is None else (time.perf_counter() - began) * 1e3
    return _empty(moment, final) | {
        "faults": [fault_of(fault, moment.document.root) for fault in faults],
        "status_words": faults[0].message if faults else "",
        "net": net_of(moment, None),
        "ms": {"analysis": took, "all": took},
    }


def notice_of(notice: Notice) -> dict[str, Any]:
    """A notice as the page has it."""
    return {"code": notice.code, "text": notice.message, "path": None}


def fault_of(fault: Fault, root: Node | None = None) -> dict[str, Any]:
    """A fault as the page has it, with the path of what it is said of where that is known."""
    path, place = None, fault.where
    if place.startswith("--set "):
        path, place = place.removeprefix("--set ").partition("=")[0].strip() or None, ""
    elif root is not None and place:
        path = next(
            (
                node.path
                for node in _nodes_bottom_up(root)
                if place in (str(node.place), str(node.key_place))
            ),
            None,
        )
        if path is None and root.find(place):
            path, place = place, ""
    return {
        "code": fault.code,
        "message": fault.message,
        "where": place,
        "advice": fault.advice,
        "path": path,
    }


def _nodes_bottom_up(node: Node) -> Iterator[Node]:
    """Iterate over all nodes, children before their parents: the first at a place of the file is the most precise."""
    for subtree in (*node.elements, *(child for _, child in node.items())):
        yield from _nodes_bottom_up(subtree)
    yield node


def _design_notices(moment: Moment) -> list[dict[str, Any]]:
    """Return the notices on the design itself: load cases, which the app does not analyse."""
    if not moment.cases:
        return []
    text = (
        f"the load cases {', '.join(moment.cases)} stand aside here: slopekit run goes through them"
    )
    return [notice_of(Notice("W427", text))]


def _sensitivities(
    design: Design, result: Result, keys: Mapping[str, Key]
) -> Iterator[dict[str, Any]]:
    """Iterate over the changes that move the closed form's factor most, each with its controls."""
    if why_no_sensitivity(result):
        return
    base = result.fos.closed_form
    for change_name, factor, status in result.comparisons.governs:
        name = design.in_own_names(change_name)
        paths = _sliders(design, name, keys)
        strengths = list(
            dict.fromkeys(path.split(".")[1] for path in paths if path.startswith("strength."))
        )
        change = name
        if len(strengths) > 1:  # one change of several sliders: of which, is said
            change = f"{name.partition(' of ')[0]} of {' and '.join(strengths)}"
        text = f"{change}: {status.replace('_', ' ')}"
        if factor is not None:
            text = (
                f"{change}: {factor:.2f}"
                if base is None or name == "full water"
                else f"{change} {factor - base:+.2f}"
            )
        label = " and ".join(words_of(type(design), path) for path in paths) or name
        yield {"paths": paths, "label": label, "text": text}


def _sliders(design: Design, name: str, keys: Mapping[str, Key]) -> list[str]:
    """The sliders that a change of SENSITIVITY moves: one, or those of every strength that it is made to."""
    if name.startswith("dip of "):
        joint = name.removeprefix("dip of ").rpartition(" ")[0]
        roots = (f"joints.{joint}.plane", f"{joint}.plane")
        ends = (".dip", ".mean.dip", ".dip.mean")
        return [root + end for root in roots for end in ends if root + end in keys][:1]
    sign, _, rest = name.partition(" +")
    if signed := _keys_by_sign().get(sign):
        strengths = _strengths_of_joints(design, rest.partition(" of ")[2])
        places = [f"strength.{strength}.{key}" for strength in strengths for key in signed]
        return [
            path
            for path in [place + end for place in places for end in ("", ".mean")]
            if path in keys
        ]
    wanted_ends = next((ends for begin, ends in _PATHS_OF_CHANGES if name.startswith(begin)), ())
    return [path for path in keys if path.endswith(wanted_ends) and keys[path].role == "quantity"][
        :1
    ]


@cache
def _keys_by_sign() -> Mapping[str, tuple[str, ...]]:
    """The keys of strengths by the signs of SENSITIVITY: `φ_r` is `phi_r`, of any law."""
    records = (*LAWS.values(), Wavy)
    metadata = [field.metadata for record in records for field in fields(record)]
    signs: dict[str, tuple[str, ...]] = {}
    for entry in metadata:
        if "sign" in entry and entry["key"] not in signs.get(entry["sign"], ()):
            signs[entry["sign"]] = (*signs.get(entry["sign"], ()), entry["key"])
    return signs


def _strengths_of_joints(design: Design, joints: str) -> list[str]:
    """The strengths of the joints of a change, `J1 and basal`, all where it names none; as the file calls them."""
    root = tree(design).root
    joint_nodes, strengths = root.get("joints"), root.get("strength")
    holders = {joint: f"joints.{joint}" for joint, _ in joint_nodes.items()}
    holders |= {
        section: section for section in ("basal", "weak_plane", "slip") if root.get(section)
    }
    chosen = [holders[joint] for joint in joints.split(" and ") if joint in holders] or list(
        holders.values()
    )
    names = [text for holder in chosen if (text := text_at(tree(design), f"{holder}.strength"))]
    return list(dict.fromkeys(names)) or [strength for strength, _ in strengths.items()]


# -- the net ----------------------------------------------------------------------------------------------------------


def net_of(moment: Moment, result: Result | None) -> dict[str, Any]:
    """The planes of a design for the stereonet, each with the path that its angles are set by."""
    design, root = moment.design, moment.document.root
    orientations = orientations_of({"kind": design.kind, "inputs": design.inputs()})
    face, upper, crack = (orientations.slope.get(name) for name in ("face", "upper", "crack"))
    planes = {design.in_own_names(name): plane for name, plane in orientations.joints.items()}
    planes |= {} if crack is None else {"crack": crack}
    group = "joints" if root.get("joints") else "sets"
    return {
        "face": _plane(face),
        "upper": _plane(upper),
        "planes": [
            {
                "name": name,
                **(_plane(plane) or {}),
                "path": _prefix(
                    root, f"{name if name in ('basal', 'crack') else f'{group}.{name}'}.plane"
                ),
            }
            for name, plane in planes.items()
        ],
        "line": _line(result),
        "friction": _friction(design),
    }


def _plane(plane: Plane | None) -> dict[str, float] | None:
    return (
        None if plane is None else {"dip": plane.dip_deg, "dip_direction": plane.dip_direction_deg}
    )


def _prefix(root: Node, path: str) -> str | None:
    """The path whose `.dip` and `.dip_direction` can be set: of a distribution that of its mean."""
    node = root.find(path)
    if not node:
        return None
    if node.get("dist"):
        return f"{path}.mean" if node.get("mean") else None
    scatters = any(
        node.get(angle).is_mapping for angle in ("dip", "dip_direction")
    )  # each for itself
    return None if scatters else path


def _line(result: Result | None) -> dict[str, float] | None:
    trend = getattr(result.geometry, "line_trend_deg", None) if result is not None else None
    plunge = getattr(result.geometry, "line_plunge_deg", None) if result is not None else None
    return (
        None
        if trend is None or plunge is None
        else {"trend": float(trend), "plunge": float(plunge)}
    )


def _friction(design: Design) -> float | None:
    """The least friction angle of its strengths; None where one is curved."""
    angles = [getattr(strength, "friction_angle_deg", None) for strength in design.joint_strengths]
    constant_angles = [float(angle) for angle in angles if isinstance(angle, int | float)]
    return min(constant_angles) if constant_angles and len(constant_angles) == len(angles) else None
