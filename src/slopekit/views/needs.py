"""What each picture needs of a document: by it a document that was changed is told from a fault of our own."""

from collections.abc import Mapping
from typing import Any

_NUMBER = (float, None)
_TEXT = (str, None)
_POINT = {
    "status": _TEXT, "limit": _NUMBER, "closed_status": _TEXT, "closed_form": _NUMBER, "moments_govern": (bool, None),
    "agree": (bool, None), "code": _TEXT, "message": _TEXT,
}  # fmt: skip
_SWEEP = {
    "methods": str,
    "keys": [{"key": str, "unit": str, "values": [float], "now": _NUMBER}],
    "points": [_POINT],
    "levels": [{"fos": float, "what": str}],
    "critical": [{"method": str, "at": _NUMBER, "fos": float}],
    "changes": [{"between": [float], "statuses": [str]}],
}
_SHARE = {"probability": _NUMBER, "low": _NUMBER, "high": _NUMBER, "of": float, "confidence": float, "limits_by": str}
_FOS = {"limit": _NUMBER, "closed_form": _NUMBER, "static_bound": _NUMBER, "all_pairs_failed": _NUMBER}
_NEEDS: Mapping[str, Mapping[str, Any]] = {
    "curve": _SWEEP,
    "contour": _SWEEP,
    "tornado": {
        "methods": str, "rule": str, "base": _POINT,
        "bars": [{
            "key": str, "unit": str, "low": float, "high": float, "at_low": _POINT, "at_high": _POINT,
            "shown": ([str], None), "swing": {"pre_ie": _NUMBER, "closed_form": _NUMBER},
        }],
    },
    "histogram": {
        "target": float, "n": float, "by": str, "outcomes": dict,
        "histogram": ({
            "edges": [float], "counts": [float], "below": float, "above": float,
            "pre_ie_at_random": ([float], None), "pre_ie_samples": _NUMBER, "pre_ie_without_factor": _NUMBER,
            "failing_without_factor": _NUMBER,
        }, None),
        "fos": ({"min": float, "max": float, "samples": float}, None),
        "probability_of_failure": {"all_samples": _SHARE, "samples_that_form_a_block": _SHARE},
    },
    "speed-error": {
        "ladder": [{"method": str, "error": _NUMBER, "fos": _NUMBER, "effort": _NUMBER, "node_pairs": _NUMBER}],
        "timing_s": {"ladder": [{"seconds": float}]},
        "reference": {"value": _NUMBER, "what": str}, "agree_within": _NUMBER, "fos": _FOS, "status": str,
    },
    "normals": {
        "normals": [{"normals": str, "edge_m": _NUMBER, "fos": _NUMBER, "fos_cohesion_kept": _NUMBER}], "fos": _FOS,
    },
    "reduction": {
        "series": ([{
            "factor": float, "stands": bool, "failed_pairs": float, "displacement_m": ([float], None),
        }], None),
        "all_pairs": ({"history": ([{"factor": float, "failed_pairs": float}], None)}, None),
        "fos": _FOS, "model": {"node_pairs": float},
    },
    "stereonet": {
        "inputs": {
            "joints": (Mapping, list, None), "joint": _TEXT, "friction_angle_deg": ([float], float, None),
            "strength": ({"friction_angle_deg": float}, str, None), "strengths": ([[(str, dict)]], None),
            "sets": ([{"name": str, "plane": str, "strength": _TEXT}], None), "face": _TEXT, "upper": _TEXT,
            "crack": (dict, None), "friction_deg": ({"least": float, "most": float}, float, None),
        },
        "worst": ([{"joints": [str], "planes": [str]}], None), "fos": (dict, float, None),
    },
}  # fmt: skip
_KINEMATIC: Mapping[str, Any] = {
    "orientations": [{"dip_deg": float, "dip_direction_deg": float, "friction_deg": float, "set": _TEXT}],
    "inputs": {"face": str, "lateral_deg": float, "lateral_toppling_deg": float},
    "survey": {"name": _TEXT}, "input_sha256": str,
}  # fmt: skip
_SCENE: Mapping[str, Any] = {
    "inputs": dict, "fos": _FOS, "geometry": (dict, None), "assembly": (dict, None), "mechanism": (Mapping, list, None),
}  # fmt: skip


def need_of(what: str, kinematic: bool = False) -> Mapping[str, Any]:
    """The form of a document that can give a picture; of scenes what stands beside the scene."""
    return _KINEMATIC if what == "stereonet" and kinematic else _NEEDS.get(what, _SCENE)
