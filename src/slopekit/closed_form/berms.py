"""Berm design over arrays: catch width, inter-ramp angle, face angle after a crest loss, spill width.

Sources: the modified Ritchie criterion, 0.2 H + 4.5 m, as given by Warren et al. (2025, SSIM 2025, Australian Centre
for Geomechanics, doi 10.36487/ACG_repo/2535_04), after Ritchie (1963, Highway Research Record 17, 13-28) and Ryan &
Pryor (2000) (m); spill as a cone or a prism at the angle of repose against the face, from the volume, its swell, the
face and the angle of repose (Gibson, de Bruyn & Walker 2006, Int. Symp. on Stability of Rock Slopes, SAIMM; their
formula is not taken), here integrated exactly. (m): remembered, not looked up.
"""

import math
from typing import Final

import numpy as np

from slopekit.core.array_types import ArrayLike, Floats

_RADIAN: Final = math.pi / 180.0
#: Of the modified Ritchie criterion: a part of the bench height, and m.
RITCHIE: Final = (0.2, 4.5)


def catch_width(height_m: ArrayLike) -> Floats:
    """Return the berm width that catches rockfall, m (…,), from the height of the bench (…,).

    Formula: 0.2 H + 4.5 m (modified Ritchie criterion, metric).

    >>> catch_width([5.0, 10.0, 15.0]).tolist()
    [5.5, 6.5, 7.5]
    """
    return RITCHIE[0] * np.asarray(height_m, dtype=np.float64) + RITCHIE[1]


def inter_ramp_angle(height_m: ArrayLike, face_dip_deg: ArrayLike, berm_m: ArrayLike) -> Floats:
    """Return the inter-ramp angle of a stack of benches, from toe to toe, degrees.

    Formula: tan α = H / (H cot ψ_f + B). With the face after a loss and the berm that it left it is the same angle.

    >>> inter_ramp_angle(15.0, 70.0, 7.5).round(2).tolist()
    49.17
    """
    height = np.asarray(height_m, dtype=np.float64)
    face, berm = (np.asarray(value, dtype=np.float64) for value in (face_dip_deg, berm_m))
    run = height / np.tan(face * _RADIAN) + berm
    return np.arctan2(height, run) / _RADIAN


def effective_face_angle(
    height_m: ArrayLike, face_dip_deg: ArrayLike, setback_m: ArrayLike
) -> Floats:
    """Return the angle of a face from its toe to the crest after a crest loss, degrees.

    Formula: tan α = H / (H cot ψ_f + s).

    >>> effective_face_angle(15.0, 70.0, [0.0, 3.0]).round(2).tolist()
    [70.0, 60.58]
    """
    return inter_ramp_angle(height_m, face_dip_deg, setback_m)


def cone_spill_width(
    volume_m3: ArrayLike, face_dip_deg: ArrayLike, repose_deg: ArrayLike, swell: ArrayLike = 1.0
) -> Floats:
    """Return the width (m) from the toe of a cone of broken rock against the face; 0 on a face flatter than repose.

    Parameters
    ----------
    volume_m3 : of the rock in place; swell : broken by solid volume

    Formula: at the depth d below its tip the cone is a circle of radius d cot θ, of which the face leaves what lies
    beyond d cot ψ_f: V = y³ (cot²θ acos q - cot ψ_f √(cot²θ - cot²ψ_f)) / 3, q = cot ψ_f / cot θ; width y (cot θ -
    cot ψ_f), y the height of the tip.

    >>> half = 2.0 / 3.0 * 3.141592653589793  # half of a cone of radius 2 and height 1 ... against an upright face
    >>> float(cone_spill_width(half, 90.0, 26.56505117707799).round(9))
    2.0
    """
    flat, back = _cotangents(repose_deg, face_dip_deg)
    with np.errstate(all="ignore"):
        share = np.clip(back / flat, 0.0, 1.0)
        room = flat**2 * np.arccos(share) - back * np.sqrt(np.maximum(0.0, flat**2 - back**2))
        tip = np.cbrt(3.0 * _product(volume_m3, swell) / room)
        width_m: Floats = np.where(back < flat, tip * (flat - back), 0.0)
    return width_m


def prism_spill_width(
    area_m2: ArrayLike, face_dip_deg: ArrayLike, repose_deg: ArrayLike, swell: ArrayLike = 1.0
) -> Floats:
    """Return the width (m) from the toe of a prism of broken rock against the face.

    area_m2 : of the section of the rock in place

    Formula: A = w² / (2 (cot θ - cot ψ_f)).

    >>> float(prism_spill_width(2.0, 90.0, 45.0))
    2.0
    """
    flat, back = _cotangents(repose_deg, face_dip_deg)
    return np.sqrt(2.0 * _product(area_m2, swell) * np.maximum(0.0, flat - back))


def _product(volume: ArrayLike, swell: ArrayLike) -> Floats:
    """Return the volume (or area) of broken rock."""
    return np.asarray(volume, dtype=np.float64) * np.asarray(swell, dtype=np.float64)


def _cotangents(repose_deg: ArrayLike, face_dip_deg: ArrayLike) -> tuple[Floats, Floats]:
    """Return the cotangents of the angle of repose and of the face dip; 0 for an upright face."""
    repose, face = (
        np.asarray(angle, dtype=np.float64) * _RADIAN for angle in (repose_deg, face_dip_deg)
    )
    return np.cos(repose) / np.sin(repose), np.maximum(0.0, np.cos(face) / np.sin(face))
