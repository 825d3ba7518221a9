"""Second-order cones by the row: what an interior-point method needs of them, for (g, 1 + t) arrays.

A row (x0, x1) lies in its cone where x0 >= |x1|. Nesterov and Todd's scaling W is the symmetric matrix that takes the
dual z and the primal q to the same point, W z = W⁻¹ q (Andersen, Dahl & Vandenberghe 2013, cvxopt's notes).
"""

import numpy as np

from slopekit.core.arrays import Floats
from slopekit.core.records import dataclass
from slopekit.preie.kernels import compiled
from slopekit.preie.tolerances import TINY


def along_rows(a: Floats, b: Floats) -> Floats:
    """The products of the rows of two arrays, (g,)."""
    products: Floats = a[:, 0] * b[:, 0]
    for k in range(1, a.shape[1]):  # two or three: four times as fast as einsum
        products += a[:, k] * b[:, k]
    return products


def longest_step(point: Floats, step: Floats) -> float:
    """The largest α with every row of `point + α step` in its cone; infinite where there is no end."""
    if len(point) == 0:
        return np.inf
    kernels = compiled()
    if kernels is not None:
        return float(kernels.longest_step(np.ascontiguousarray(point), np.ascontiguousarray(step), point.shape[1]))
    a = step[:, 0] ** 2 - along_rows(step[:, 1:], step[:, 1:])
    b = point[:, 0] * step[:, 0] - along_rows(point[:, 1:], step[:, 1:])
    c = determinant(point)
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    real = b * b >= a * c
    half = -(b + np.where(b >= 0.0, root, -root))
    ends = np.full(len(point), np.inf)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for end in (half / a, c / half):
            ends = np.where(real & (end > 0.0), np.minimum(ends, end), ends)
        falls = np.where(step[:, 0] < 0.0, -point[:, 0] / step[:, 0], np.inf)
    return float(min(np.nanmin(ends), falls.min()))


def longest_step_to_zero(point: Floats, step: Floats) -> float:
    """The largest α with `point + α step` nowhere negative."""
    falls = step < 0.0
    return float((-point[falls] / step[falls]).min()) if falls.any() else np.inf


def determinant(point: Floats) -> Floats:
    """x0² - |x1|² of each row, kept above zero."""
    size: Floats = np.maximum(point[:, 0] ** 2 - along_rows(point[:, 1:], point[:, 1:]), TINY)
    return size


def product(a: Floats, b: Floats) -> Floats:
    """The Jordan product a ∘ b."""
    out = a[:, :1] * b + b[:, :1] * a
    out[:, 0] = along_rows(a, b)
    return out


def quotient(a: Floats, b: Floats) -> Floats:
    """The x with a ∘ x = b."""
    first = (a[:, 0] * b[:, 0] - along_rows(a[:, 1:], b[:, 1:])) / determinant(a)
    rest = (b[:, 1:] - first[:, None] * a[:, 1:]) / a[:, :1]
    return np.concatenate([first[:, None], rest], axis=1)


@dataclass(frozen=True, slots=True)
class Scaling:
    """W = η [w0, w1ᵀ; w1, I + w1 w1ᵀ / (1 + w0)] by the row."""

    direction: Floats
    size: Floats

    def times(self, x: Floats) -> Floats:
        """W x."""
        return self._apply(x, 1.0) * self.size[:, None]

    def over(self, x: Floats) -> Floats:
        """W⁻¹ x."""
        return self._apply(x, -1.0) / self.size[:, None]

    def _apply(self, x: Floats, sign: float) -> Floats:
        first, rest = self.direction[:, 0], self.direction[:, 1:]
        along = along_rows(rest, x[:, 1:])
        out = np.empty_like(x)
        out[:, 0] = first * x[:, 0] + sign * along
        out[:, 1:] = x[:, 1:] + rest * (sign * x[:, 0] + along / (1.0 + first))[:, None]
        return out


def scaling(primal: Floats, dual: Floats) -> Scaling:
    """Nesterov and Todd's scaling between rows in the inside of their cones."""
    of_primal, of_dual = determinant(primal), determinant(dual)
    q, z = primal / np.sqrt(of_primal)[:, None], dual / np.sqrt(of_dual)[:, None]
    flipped = z.copy()
    flipped[:, 1:] *= -1.0
    gamma = np.sqrt(np.maximum((1.0 + along_rows(q, z)) / 2.0, TINY))
    direction = (q + flipped) / (2.0 * gamma)[:, None]
    size = (of_primal / of_dual) ** 0.25
    return Scaling(direction, size)
