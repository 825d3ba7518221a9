"""The slide of single blocks whose flat joints dilate, every one of them pressed, n at once.

A block that slides for ever moves off each joint by as much as its slip opens it, and does not turn. With the normal n
of a joint, the direction d of its slip and the tangent of its dilation, tan ψ <= λ tan φ,

    (n - tan ψ d) · v = 0,    Σ N n - λ (c A + N tan φ) d + P + λ P_bolts = 0

Slip presses what it opens: tractions are those of a bed without dilation whose normals are n - tan ψ d, with friction
λ tan φ - tan ψ along them. Elastic slip opens nothing, which makes joints softer by 1 + tan ψ λ tan φ k_n / k_t. Where
that bed is pressed at every corner the slide is the limit.
"""

from dataclasses import replace

import numpy as np

from slopekit.preie.one_block.bed_limits import BedLimits, running_limits
from slopekit.preie.one_block.forces_limits import ForcesLimits, ForcesStatus
from slopekit.preie.one_block.polygon_bed import Beds
from slopekit.preie.tolerances import NO_FORCE, ROUNDING, SETTLED

_MOST_ROUNDS = 200  # each round reduces the error by a factor of about tan ψ


def dilating_slides(beds: Beds) -> tuple[Beds, ForcesLimits, BedLimits]:
    """Return beds tilted by dilation, the slides of their blocks, and their limits: `PRESSED` where all joints are.

    λ of a slide is not a number where no slide presses every joint.
    """
    first, count, moves = beds.contact[:-1], np.diff(beds.contact), beds.translations
    inside = np.arange(int(count.max())) < count[:, None]
    contact = np.where(inside, first[:, None] + np.arange(inside.shape[1]), 0)
    axes = beds.rows[contact][:, :, [0, 3, 6], :moves] * inside[:, :, None, None]
    load, bolts, normals, tangents = (
        beds.load[:, None, :moves],
        beds.bolt_rows[:, :, :moves],
        axes[:, :, 0],
        axes[:, :, 1:],
    )
    cohesion = beds.line[contact, 1] * beds.contact_moments[contact, 0, 0] * inside
    friction, limits = (
        values[contact, None] * inside[:, :, None]
        for values in (beds.line[:, 2], beds.tan_dilation)
    )
    tilted, forward, reduction = normals, load, np.zeros((len(load), 1, 1))
    pushes = np.maximum(-load @ np.linalg.pinv(normals), 0.0)[:, 0]
    for _ in range(_MOST_ROUNDS):
        velocity = np.linalg.svd(tilted)[2][:, -1:]
        velocity *= np.where((velocity * forward).sum(axis=2, keepdims=True) < 0.0, -1.0, 1.0)
        forward = velocity  # the load does no work where joints dilate by all of their friction
        slip = (tangents @ velocity[:, None].swapaxes(2, 3))[..., 0]
        slip /= np.maximum(np.sqrt((slip * slip).sum(axis=2)), NO_FORCE)[:, :, None]
        drag = (slip[:, :, None] @ tangents)[:, :, 0]
        pulls = beds.bolt_capacity[:, None] * (velocity @ bolts.swapaxes(1, 2) < 0.0)
        strength = (cohesion + friction[:, :, 0] * pushes)[:, None]
        sides = np.concatenate([normals, pulls @ bolts - strength @ drag], axis=1)
        previous, solution = reduction, -load @ np.linalg.pinv(sides)
        pushes, reduction = solution[:, 0, :-1], solution[:, :, -1:]
        dilation = np.clip(reduction * friction, 0.0, limits)
        tilted = normals - dilation * drag
        change = np.abs(reduction - previous)[:, 0, 0]
        if (change <= ROUNDING * np.abs(reduction)[:, 0, 0]).all():
            break
    opening_error = np.abs(tilted @ velocity.swapaxes(1, 2)).max(axis=(1, 2))
    imbalance = np.abs(solution @ sides + load).max(axis=(1, 2))
    lam = reduction[:, 0, 0]
    good = (
        ((pushes > 0.0) | ~inside).all(axis=1)
        & (lam > 0.0)
        & (np.maximum(imbalance, opening_error) < SETTLED)
    )
    slides = np.zeros((len(lam), beds.load.shape[1] + 1))
    slides[:, :moves], slides[:, -1] = (
        velocity[:, 0],
        np.where(good & (change < SETTLED * lam), lam, np.nan),
    )
    by_forces = ForcesLimits(
        np.full(len(lam), ForcesStatus.SLIDES), slides, pushes, (reduction * pulls)[:, 0]
    )
    opening, *slips = np.split(beds.rows, 3, axis=1)
    tilt, line = dilation[inside], beds.line
    lam = np.repeat(slides[:, -1], count)
    softer = 1.0 + tilt[:, 0] * lam * line[:, 2] / beds.shear_ratio
    line = np.column_stack(
        [line[:, 0] / softer, line[:, 1] * softer, line[:, 2] - tilt[:, 0] / lam]
    )
    opening = opening - tilt[:, :, None] * np.einsum("mj,jmku->mku", slip[inside], np.stack(slips))
    bed = replace(beds, rows=np.concatenate([opening, *slips], axis=1), line=line)
    return bed, by_forces, running_limits(bed, slides)[0]
