"""A block on thousands of separate springs: the cracked base by another way, for `preie.one_block.cracked`.

Shares nothing with it: no clipping, no path by arc length, no running state. Contacts are midpoints of small triangles;
a spring that opens carries nothing, its cohesion comes on over a sliver of pressure (`RAMP` of the mean). Strength goes
down step by step; after each step the block creeps (dashpots, implicit steps) until it rests or runs. F lies between
the last strength at which it came to rest and the first at which it did not.
"""

from dataclasses import dataclass

import numpy as np

SHEAR = 0.4  # k_t / k_n
RAMP = 2e-3  # of the mean pressure: where cohesion comes on
_RESTS = 1e-8


@dataclass
class Springs:
    points: np.ndarray  # (n, 3) m about the centroid
    area: np.ndarray
    normal: np.ndarray  # (n, 3) into the block
    cohesion: np.ndarray
    tan_friction: np.ndarray


def springs_on(polygons, cohesion, tan_friction, centroid, count: int) -> Springs:
    """About `count` springs on each polygon (corners anticlockwise seen from outside the block)."""
    parts = []
    for polygon, c, mu in zip(polygons, cohesion, tan_friction, strict=True):
        corners = np.asarray(polygon) - centroid
        triangles = [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
        n = max(2, round((count / len(triangles)) ** 0.5))
        for p, q, r in triangles:
            i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
            up, down = i + j < n, i + j < n - 1
            a = np.concatenate([(i[up] + 1 / 3) / n, (i[down] + 2 / 3) / n])
            b = np.concatenate([(j[up] + 1 / 3) / n, (j[down] + 2 / 3) / n])
            vector = np.cross(q - p, r - p)
            whole = np.linalg.norm(vector)
            points = p + a[:, None] * (q - p) + b[:, None] * (r - p)
            ones = np.ones(len(points))
            parts.append(
                (
                    points,
                    ones * whole / 2 / n**2,
                    ones[:, None] * (-vector / whole),
                    ones * c,
                    ones * mu,
                )
            )
    return Springs(*(np.concatenate(column) for column in zip(*parts, strict=True)))


class Block:
    """Forces on the block, u = 3 displacements and 3 rotations times `size`; k_n is 1 kN/m³ over mean pressure 1 m."""

    def __init__(self, springs: Springs, force, moment) -> None:
        self.s = springs
        self.size = float(np.sqrt((springs.points**2).sum(axis=1).mean()))
        self.load = np.concatenate([force, np.asarray(moment) / self.size]) / np.linalg.norm(force)
        self.stress = (
            float(np.linalg.norm(force)) / springs.area.sum()
        )  # so that forces are in parts of the load
        self.share = springs.area / springs.area.sum()
        arm = springs.points / self.size
        eye = np.broadcast_to(np.eye(3), (len(arm), 3, 3))
        turn = np.zeros((len(arm), 3, 3))  # ω x arm
        turn[:, 0, 1], turn[:, 0, 2], turn[:, 1, 0] = arm[:, 2], -arm[:, 1], -arm[:, 2]
        turn[:, 1, 2], turn[:, 2, 0], turn[:, 2, 1] = arm[:, 0], arm[:, 1], -arm[:, 0]
        self.move = np.concatenate([eye, turn], axis=2)  # (n, 3, 6)
        self.open = np.einsum("nx,nxu->nu", springs.normal, self.move)
        first = np.cross(springs.normal, np.eye(3)[np.abs(springs.normal).argmin(axis=1)])
        first /= np.linalg.norm(first, axis=1)[:, None]  # two directions along the joint
        self.slide = [
            np.einsum("nx,nxu->nu", way, self.move)
            for way in (first, np.cross(springs.normal, first))
        ]
        self.rows = np.concatenate(
            [self.open, *self.slide]
        )  # opening and slips of every spring, (3 n, 6)
        self.bonded = self._stiffness(self.share, SHEAR * self.share)

    def _stiffness(self, normal, shear):
        """Of springs that are so stiff each, (n,) and (n,)."""
        return (self.rows.T * np.concatenate([normal, shear, shear])) @ self.rows

    def forces(self, u, strength):
        """Unbalanced forces at a strength (1 / F), and what gives their slope."""
        opening, one, other = (self.rows @ u).reshape(3, -1)
        pressure = -opening
        pressed = pressure > 0
        size = np.maximum(np.sqrt(one * one + other * other), 1e-300)
        one, other = one / size, other / size
        over = np.maximum(pressure, 0.0)
        on = np.minimum(over / RAMP, 1.0)
        c = self.s.cohesion / self.stress
        cap = strength * (c * on + self.s.tan_friction * over)
        slides = (SHEAR * size > cap) | ~pressed
        shear = self.share * np.where(slides, cap, SHEAR * size)
        out = (
            self.load - np.concatenate([-self.share * over, shear * one, shear * other]) @ self.rows
        )

        def slope():
            cap_slope = (
                strength * (c * ((on > 0) & (on < 1)) / RAMP + self.s.tan_friction) * pressed
            )
            ways = one[:, None] * self.slide[0] + other[:, None] * self.slide[1]
            per = np.where(slides, shear / size, self.share * SHEAR)
            of_sliding = ways.T * np.where(slides, per, 0.0)
            of_strength = (ways.T * (self.share * slides * cap_slope)) @ self.open
            return of_sliding @ ways + of_strength - self._stiffness(self.share * pressed, per)

        return out, slope

    def rest(self, u, strength, most_steps=60):
        """Where the block comes to rest, None where it does not."""
        drag, far = 0.3, 40 * max(np.linalg.norm(u), 1.0)
        for _ in range(most_steps):
            new = self._creep(u, strength, drag)
            if new is None:
                drag *= 3.0
                if drag > 100.0:
                    return None
                continue
            u = new
            out, _ = self.forces(u, strength)
            if np.abs(out).max() < _RESTS:
                return u
            if np.linalg.norm(u) > far:
                return None
            drag *= 0.3
        return None

    def _creep(self, begin, strength, drag):
        u = begin
        out, slope = self.forces(u, strength)
        for _ in range(25):
            size = np.abs(out).max()
            if size < _RESTS / 10:
                return u
            step = -np.linalg.lstsq(slope() - drag * self.bonded, out, rcond=None)[0]
            length = 1.0
            while True:
                after, slope_after = self.forces(u + length * step, strength)
                after = after - drag * self.bonded @ (u + length * step - begin)
                if np.abs(after).max() < size * (1 - 0.1 * length):
                    break
                length /= 2
                if length < 0.01:
                    return None
            u, out, slope = u + length * step, after, slope_after
        return None

    def factor(self, guess, within=1e-3):
        """(low, high) of F, None where the block does not rest even at a large strength."""
        start = np.linalg.solve(self.bonded, self.load)
        strength, u = 4.0 / guess, None
        while u is None and strength < 4000.0 / guess:
            u = self.rest(start, strength)
            strength *= 1.0 if u is not None else 3.0
        if u is None:
            return None
        stride = 0.8
        while True:
            new = self.rest(u, strength * stride)
            if new is not None:
                u, strength = new, strength * stride
                if strength < 1e-3 / guess:
                    return None
            elif 1 - stride < within:
                return 1 / strength, 1 / (strength * stride)
            else:
                stride = 1 - (1 - stride) / 3
