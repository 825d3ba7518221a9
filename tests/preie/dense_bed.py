"""A block on thousands of small triangles of elastic bed: whether the limit itself falls as strength rises.

Shares nothing with `preie.one_block`: no clipped polygons, no refined triangles, slopes by differences, steps of one
length. Each triangle carries the pressed share of its own linear gap. Rest without slip, then arc length in
(u / |u|, ln λ); the limit is the largest F on the way. A strip narrower than a triangle, on which blocks creep about an
edge, is beyond it.
"""

import numpy as np

SHEAR = 0.4  # k_t / k_n
_RESTS, _LEAST = 1e-9, 1e-300
_FAR, _RISE, _GONE = 1e4, 1.2, 10.0  # elastic displacements; of λ; elastic displacements


def _triangles(polygon, parts):
    places, (i, j) = [], np.meshgrid(np.arange(parts), np.arange(parts), indexing="ij")
    for k in range(1, len(polygon) - 1):
        sides = (polygon[k] - polygon[0]) / parts, (polygon[k + 1] - polygon[0]) / parts
        for inside, corners in (
            (i + j < parts, ((0, 0), (1, 0), (0, 1))),
            (i + j < parts - 1, ((1, 1), (0, 1), (1, 0))),
        ):
            at = [
                np.outer(i[inside] + a, sides[0]) + np.outer(j[inside] + b, sides[1])
                for a, b in corners
            ]
            places.append(polygon[0] + np.stack(at, axis=1))
    return np.concatenate(places)


class DenseBed:
    """Polygons (corners about the centroid, anticlockwise from outside), strengths, load (6,) in kN and kN m."""

    def __init__(self, polygons, cohesion, tan_friction, load, parts: int = 20) -> None:
        cells = [_triangles(polygon, parts) for polygon in polygons]
        count, corners = [len(cell) for cell in cells], np.concatenate(cells)
        outward = [
            np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0]) for polygon in polygons
        ]
        normal = np.repeat([-way / np.linalg.norm(way) for way in outward], count, axis=0)
        area = (
            np.linalg.norm(
                np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
            )
            / 2.0
        )
        size, weight = np.sqrt((corners**2).sum(axis=2).mean()), np.linalg.norm(load[:3])
        self.load = np.concatenate([load[:3], load[3:] / size]) / weight
        self.cohesion = np.repeat(np.asarray(cohesion) * area.sum() / weight, count)
        self.friction, self.area = np.repeat(tan_friction, count), area / area.sum()
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)])
        first /= np.linalg.norm(first, axis=1)[:, None]
        ways, corners = (normal, first, np.cross(normal, first)), corners / size
        self.gaps = np.stack([self._rows(corners[:, k], normal) for k in range(3)], axis=1)
        self.rows = [self._rows(corners.mean(axis=1), way) for way in ways]
        springs = zip(self.rows, (1.0, SHEAR, SHEAR), strict=True)
        self.bonded = sum((rows.T * (self.area * spring)) @ rows for rows, spring in springs)

    @staticmethod
    def _rows(at, way):
        return np.concatenate([way, np.cross(at, way)], axis=1)

    def forces(self, u, strength):
        low, middle, high = np.sort(-(self.gaps @ u), axis=1).T
        mean, first, second = (low + middle + high) / 3.0, self.rows[1] @ u, self.rows[2] @ u
        corner = (
            high * high / np.maximum((high - low) * (high - middle), _LEAST)
        )  # only one of its corners is pressed
        open_corner = low * low / np.maximum((middle - low) * (high - low), _LEAST)
        kinds = [high <= 0.0, low >= 0.0, middle <= 0.0]
        share = np.select(kinds, [0.0, 1.0, corner], 1.0 - open_corner)
        push = np.select(kinds, [0.0, mean, corner * high / 3.0], mean - open_corner * low / 3.0)
        slip = np.maximum(np.hypot(first, second), _LEAST)
        drag = (
            np.minimum(
                SHEAR * slip * share, strength * (self.cohesion * share + self.friction * push)
            )
            / slip
        )
        pulls = zip((push, -drag * first, -drag * second), self.rows, strict=True)
        return self.load + sum((self.area * pull) @ rows for pull, rows in pulls)

    def slopes(self, u, strength):
        step = 1e-7 * max(np.abs(u).max(), 1e-3)
        ways = step * np.eye(6)
        return np.stack(
            [
                (self.forces(u + way, strength) - self.forces(u - way, strength)) / (2 * step)
                for way in ways
            ],
            1,
        )

    def _settled(self, begin, strength, drag):
        """Newton's method, held back to where it begins; None where it does not settle."""
        u, held = begin, drag * self.bonded
        out = self.forces(u, strength)
        for _ in range(40):
            if np.abs(out).max() < _RESTS:
                return u
            step, length = (
                np.linalg.lstsq(self.slopes(u, strength) - held, -out, rcond=None)[0],
                1.0,
            )
            while True:
                after = self.forces(u + length * step, strength) - held @ (
                    u + length * step - begin
                )
                if np.abs(after).max() < np.abs(out).max() * (1.0 - 0.1 * length):
                    break
                length /= 2.0
                if length < 0.01:
                    return None
            u, out = u + length * step, after
        return None

    def rest(self, strength):
        """Where the block flows to from its bonded displacement, None where it does not rest."""
        u, drag = np.linalg.solve(self.bonded, self.load), 1.0
        while drag < 1e4:
            new = self._settled(u, strength, drag)
            u, drag = (u, 3.0 * drag) if new is None else (new, 0.4 * drag)
            if new is not None and np.abs(self.forces(u, strength)).max() < _RESTS:
                return u
            rest = None if new is None else self._settled(u, strength, 0.0)
            if rest is not None and np.linalg.norm(rest - u) < np.linalg.norm(u):
                return rest
        return None

    def factor(self, guess, stride: float = 0.04):
        """The largest F on the path, None where there is no rest at eight times the strength of a guess."""
        strength = 8.0 / guess
        u, tangent, length = self.rest(strength), None, stride / 4.0
        if u is None:
            return None
        elastic, way = np.linalg.norm(u), [(np.linalg.norm(u), strength)]
        while len(way) < 1500:
            scale = np.linalg.norm(u)
            ahead = np.linalg.svd(
                np.column_stack([self.slopes(u, strength) * scale, self._weaker(u, strength)])
            )[2][-1]
            onward = ahead[-1] < 0.0 if tangent is None else ahead @ tangent > 0.0
            tangent = ahead if onward else -ahead
            x, length = self._step(u / scale, np.log(strength), scale, tangent, length)
            if x is None:
                break
            u, strength, length = x[:6] * scale, np.exp(x[6]), min(stride, 1.5 * length)
            way.append((np.linalg.norm(u), strength))
            at, least = min(way, key=lambda point: point[1])
            turned = strength > _RISE * least and abs(way[-1][0] - at) > _GONE * elastic
            if turned or strength > 20.0 * least or way[-1][0] > _FAR * elastic:
                break
        k = int(np.argmin([point[1] for point in way]))
        if not 0 < k < len(way) - 1:
            return 1.0 / way[k][1]
        (low, middle, high), logs = zip(*way[k - 1 : k + 2], strict=True)
        bend, slope, least = np.polyfit([low - middle, 0.0, high - middle], np.log(logs), 2)
        return (
            float(np.exp(slope * slope / (4.0 * bend) - least)) if bend > 0.0 else 1.0 / way[k][1]
        )

    def _weaker(self, u, strength):
        step = 1e-6 * strength
        return (
            strength
            * (self.forces(u, strength + step) - self.forces(u, strength - step))
            / (2.0 * step)
        )

    def _step(self, at, log, scale, tangent, length):
        while length > 1e-7:
            begin = np.append(at, log) + length * tangent
            x = begin
            for _ in range(8):
                u, strength = x[:6] * scale, np.exp(x[6])
                off = np.append(self.forces(u, strength), tangent @ (x - begin))
                if np.abs(off).max() < 1e-8:
                    break
                beside = np.column_stack(
                    [self.slopes(u, strength) * scale, self._weaker(u, strength)]
                )
                x = x - np.linalg.lstsq(np.vstack([beside, tangent]), off, rcond=None)[0]
            if np.abs(off).max() < 1e-8 and np.linalg.norm(x - begin) < 0.3 * max(length, 3e-4):
                return x, length
            length /= 2.0
        return None, length
