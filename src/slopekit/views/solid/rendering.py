"""Drawing pictures: pixels by pyvista in parallel projection, words, scale and compass about them by matplotlib.

GLB and glTF are written with trimesh: a scene of named layers about its middle, in metres, y up.
"""

import math
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import DesignError, Fault, writing
from slopekit.core.whole_files import whole_file
from slopekit.exchange.solids import save_gltf
from slopekit.views.solid.layers import Bar, Layer, Picture
from slopekit.views.solid.scene_parts import nice

_WIDTH, _HEIGHT, _DPI = 1130, 800, 100
_SIDE, _TOP, _BOTTOM = 330, 84, 64  # pixels beside, above and beneath the scene
_COMPASS, _REACH = 52.0, 40.0  # pixels from the scene's foot to the middle of the compass; of its arrows
_END_ON = 0.3  # of its length: an axis shorter than that in the picture is named, not drawn
_BEYOND, _BELOW_COMPASS = 11.0, 16.0  # pixels from an arrow's tip, and from the middle, to a name
_ABOVE_COMPASS = 24.0  # of the compass's names, above its arrows
_BAR = 190.0  # high
_LINE, _LETTERS = 16, 165  # pixels from note to note, letters in one line
_SHARP = 2  # pixels of the scene for each of the picture: edges without steps
_EDGE_DEG = 12.0  # edges between flatter faces are not drawn
_Box = tuple[float, float, float, float]  # left, lower, right, upper: pixels from the lower left
_ADVICE = "pip install 'slopekit[plot]'"


def save(picture: Picture, path: Path) -> None:
    """Draw a picture to a PNG, GLB or glTF file.

    Raises
    ------
    DesignError
        E140 where pyvista or matplotlib is not installed, E129 where the file cannot be written.
    """
    suffix = path.suffix.lower()
    with writing(path):
        if suffix in (".glb", ".gltf"):
            _save_gltf(picture, path)
        else:
            _save_png(picture, path)


def require_drawing(path: Path) -> None:
    """Raise E140 where no scene can be drawn, before the work is done."""
    for name in ("pyvista", "matplotlib"):
        if find_spec(name) is None:
            raise DesignError([Fault("E140", f"drawing needs the extra plot ({name})", str(path), _ADVICE)])


def _pyvista() -> Any:
    import pyvista

    pyvista.vtk_verbosity("off")
    return pyvista


class Camera:
    """A parallel projection: `right`, `up`, `eye` (3,) unit; `middle` (3,) m of the frame, `height` m that it shows."""

    def __init__(self, right: Floats, up: Floats, eye: Floats, middle: Floats, height: float) -> None:
        self.right, self.up, self.eye, self.middle, self.height = right, up, eye, middle, height

    @classmethod
    def of(cls, picture: Picture) -> "Camera":
        """The frame that holds every layer."""
        eye = picture.eye
        right = cross(np.array([0.0, 0.0, 1.0]), eye)
        right = right / math.sqrt(float(right @ right))
        up = cross(eye, right)
        points = np.concatenate([part.vertices[part.triangles.ravel()] for part in picture.layers])
        about = points.mean(axis=0)
        x, y, z = np.array([right, up, eye]) @ (points - about).T
        wide, high = float(np.ptp(x)), float(np.ptp(y))
        aspect = (_WIDTH - _SIDE) / (_HEIGHT - _TOP - _BOTTOM)
        middle = about + right * (x.min() + x.max()) / 2.0 + up * (y.min() + y.max()) / 2.0 + eye * z.mean()
        return cls(right, up, eye, middle, 1.06 * max(high, wide / aspect, 1e-12))

    def set(self, plotter: Any) -> None:
        """Point the camera of a plotter."""
        far = 8.0 * self.height
        plotter.camera_position = [tuple(self.middle + far * self.eye), tuple(self.middle), tuple(self.up)]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = self.height / 2.0
        plotter.reset_camera_clipping_range()

    def seen(self, point: Floats) -> tuple[float, float]:
        """Where a point comes to lie: m to the right of the middle of the frame, and above it."""
        return float((point - self.middle) @ self.right), float((point - self.middle) @ self.up)


def _fill(plotter: Any, pyvista: Any, picture: Picture, before: float = 0.0) -> None:
    """The layers as meshes; those in front `before` (m) nearer to the eye: a parallel projection does not show it."""
    plotter.set_background("white")
    for part in picture.layers:
        if len(part.triangles) == 0:
            continue
        faces = np.insert(part.triangles, 0, 3, axis=1).ravel()
        mesh = pyvista.PolyData(part.vertices + before * part.front * picture.eye, faces)
        mesh.cell_data["colour"] = part.colours.astype(np.uint8)
        plotter.add_mesh(
            mesh, scalars="colour", rgb=True, opacity=part.opacity, show_scalar_bar=False, ambient=0.45, diffuse=0.62,
            specular=0.0, lighting=True,
        )  # fmt: skip
        if part.outlined:
            edges = mesh.extract_feature_edges(_EDGE_DEG, manifold_edges=False, non_manifold_edges=False)
            if part.shortest > 0.0 and edges.n_points:
                ends = edges.points[edges.lines.reshape(-1, 3)[:, 1:]]
                long = np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1)) > part.shortest
                edges = edges.extract_cells(np.flatnonzero(long))
            if edges.n_points:
                plotter.add_mesh(edges, color="#3a2a1c", line_width=1.2 * _SHARP, opacity=max(part.opacity, 0.55))


def _moved(picture: Picture) -> Picture:
    """The same about the middle of the scene."""
    from dataclasses import replace

    points = np.concatenate([part.vertices[part.triangles.ravel()] for part in picture.layers])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    layers = tuple(replace(part, vertices=part.vertices - middle) for part in picture.layers)
    return replace(picture, layers=layers, labels=tuple((point - middle, text) for point, text in picture.labels))


# -- PNG --------------------------------------------------------------------------------------------------------------


def _save_png(picture: Picture, path: Path) -> None:
    require_drawing(path)
    pyvista = _pyvista()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    picture = _moved(picture)
    wide, high = _WIDTH - _SIDE, _HEIGHT - _TOP - _BOTTOM
    plotter = pyvista.Plotter(off_screen=True, window_size=[wide * _SHARP, high * _SHARP])
    camera = Camera.of(picture)
    try:
        _fill(plotter, pyvista, picture, camera.height)
        camera.set(plotter)
        pixels = plotter.screenshot(None, return_img=True)
    finally:
        plotter.close()
    # the mean of each square, a quarter of the time that one over two axes takes
    places = [(row, column) for row in range(_SHARP) for column in range(_SHARP)]
    total = sum(pixels[row::_SHARP, column::_SHARP].astype(np.float64) for row, column in places)
    pixels = total / _SHARP**2 / 255.0

    figure = Figure(figsize=(_WIDTH / _DPI, _HEIGHT / _DPI), dpi=_DPI)
    FigureCanvasAgg(figure)
    figure.figimage(pixels, 0, _BOTTOM, origin="upper")
    x, y = 14 / _WIDTH, 1.0 - 16 / _HEIGHT
    figure.text(x, y, _within(figure, picture.title, 14, "bold"), fontsize=14, weight="bold", va="top")
    figure.text(x, 1.0 - 44 / _HEIGHT, picture.subtitle, fontsize=10.5, va="top", wrap=True)
    for k, note in enumerate(_notes(picture)):
        figure.text(x, (_BOTTOM - 24 - _LINE * k) / _HEIGHT, note, fontsize=8.5, va="top", color="#444444")
    write_words(figure, picture, camera, wide, high)
    with writing(path), whole_file(path) as file:
        figure.savefig(file, dpi=_DPI)


def _notes(picture: Picture) -> list[str]:
    """The notes in the two lines that have room beneath the scene; what has none follows in the last."""
    import textwrap

    notes = [note for note in picture.notes if note]
    lines = [line for note in notes for line in textwrap.wrap(note, _LETTERS)]
    return lines if len(lines) <= 2 else textwrap.wrap("; ".join(notes), _LETTERS, max_lines=2, placeholder=" …")


def write_words(figure: Any, picture: Picture, camera: Camera, wide: int, high: int) -> None:
    """Names, scale, legend, colour bar and compass: each where it covers no other."""
    scale = _scale(figure, camera, wide, high)
    _write_labels(figure, picture, camera, wide, high, scale)
    floor = _HEIGHT - _BOTTOM - _COMPASS - _REACH - _ABOVE_COMPASS
    below = _legend(figure, picture, floor - (0.0 if picture.bar is None else _BAR + 44.0))
    if picture.bar is not None:
        _bar(figure, picture.bar, below)
    _compass(figure, camera)


def _within(figure: Any, text: str, size: float, weight: str) -> str:
    """A text, cut where it would leave the picture."""
    most = int(1.75 * (_WIDTH - 30) / size)
    return text if len(text) <= most else text[: most - 1] + "…"


def _legend(figure: Any, picture: Picture, floor: float) -> float:
    """The legend at the right, as much of it as stands above `floor`; how far down it reaches; pixels from the top."""
    from matplotlib.patches import Rectangle

    top = float(_TOP + 10)
    left = _WIDTH - _SIDE + 16
    wrapped = [_lines(figure, text, _SIDE - 48, 9) for text, _, _ in picture.legend]
    feet = np.cumsum([8 + 14.5 * len(lines) for lines in wrapped]) + top
    shown = len(feet) if not len(feet) or feet[-1] <= floor else int((feet <= floor - 22.5).sum())
    for (_, colour, opacity), lines in list(zip(picture.legend, wrapped, strict=True))[:shown]:
        shade = tuple(1.0 - opacity * (1.0 - part / 255.0) for part in colour)
        patch = Rectangle((left / _WIDTH, 1.0 - (top + 13) / _HEIGHT), 16 / _WIDTH, 13 / _HEIGHT, facecolor=shade,
                          edgecolor="#333333", linewidth=0.6, transform=figure.transFigure)  # fmt: skip
        figure.add_artist(patch)
        figure.text((left + 24) / _WIDTH, 1.0 - top / _HEIGHT, "\n".join(lines), fontsize=9, va="top", linespacing=1.2)
        top += 8 + 14.5 * len(lines)
    if shown < len(wrapped):
        text = f"and {len(wrapped) - shown} more that have no room here"
        figure.text((left + 24) / _WIDTH, 1.0 - top / _HEIGHT, text, fontsize=9, va="top", color="#666666")
        top += 22.5
    return top


def _lines(figure: Any, text: str, wide: float, size: float) -> list[str]:
    """A text in lines of at most `wide` pixels, at words where that can be."""
    import textwrap

    most = 42
    while True:
        lines = textwrap.wrap(text, most) or [""]
        if max(map(len, lines)) * 1.4 * size <= wide:  # as wide as the widest letters
            return lines
        drawn = figure.text(0, 0, "\n".join(lines), fontsize=size)
        taken = float(drawn.get_window_extent(figure.canvas.get_renderer()).width)
        drawn.remove()
        if taken <= wide or most <= 8:
            return lines
        most = max(min(most - 2, int(most * wide / taken)), 8)


def _bar(figure: Any, bar: Bar, top: float) -> None:
    high = _BAR
    left = _WIDTH - _SIDE + 16
    axes = figure.add_axes((left / _WIDTH, 1.0 - (top + 30 + high) / _HEIGHT, 20 / _WIDTH, high / _HEIGHT))
    steps = np.linspace(bar.low, bar.high, 128)
    if bar.whole:
        steps = np.arange(bar.low, bar.high + 0.5)
    reach = (bar.low - 0.5, bar.high + 0.5) if bar.whole else (bar.low, bar.high)
    axes.imshow(bar.colours(steps)[:, None, :].astype(np.uint8), origin="lower", aspect="auto", extent=(0, 1, *reach))
    axes.set_xticks([])
    axes.yaxis.tick_right()
    if bar.whole and bar.high - bar.low < 12:
        axes.set_yticks(steps)
    axes.tick_params(labelsize=8.5)
    figure.text(left / _WIDTH, 1.0 - (top + 12) / _HEIGHT, bar.label, fontsize=9, va="top")


def _scale(figure: Any, camera: Camera, wide: int, high: int) -> _Box:
    """A scale bar, and what it takes of the picture: lengths square to the line of sight are true."""
    from matplotlib.lines import Line2D

    per_pixel = camera.height / high
    length = nice(0.22 * wide * per_pixel)
    begin, y = 20.0, _BOTTOM + 8.0
    end = begin + length / per_pixel
    for x in ((begin, end), (begin, begin), (end, end)):
        ys = (y, y) if x[0] != x[1] else (y - 4, y + 4)
        figure.add_artist(Line2D([part / _WIDTH for part in x], [part / _HEIGHT for part in ys], color="black", lw=1.6))
    figure.text((begin + end) / 2 / _WIDTH, (y + 6) / _HEIGHT, f"{length:g} m", fontsize=9, ha="center", va="bottom",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.75})  # fmt: skip
    return begin - 4, y - 6, max(end, begin + 50.0) + 4, y + 26


def _compass(figure: Any, camera: Camera) -> None:
    """North, east and up as they lie in the picture, at the lower right, each name beyond its arrow."""
    from matplotlib.patches import FancyArrowPatch
    from matplotlib.transforms import IdentityTransform

    middle = (_WIDTH - _SIDE / 2, _BOTTOM + _COMPASS)
    axes = [("N", (0.0, 1.0, 0.0), "#b5281e"), ("up", (0.0, 0.0, 1.0), "#444444"), ("E", (1.0, 0.0, 0.0), "#444444")]
    for name, way, colour in axes:
        across, above, toward = (float(np.array(way) @ part) for part in (camera.right, camera.up, camera.eye))
        size = math.hypot(across, above)
        x, y = middle[0], middle[1] - _BELOW_COMPASS
        if size < _END_ON:
            name = f"{name} {'toward you' if toward > 0 else 'into the picture'}"
        else:
            tip = (middle[0] + _REACH * across, middle[1] + _REACH * above)
            figure.add_artist(FancyArrowPatch(
                middle, tip, arrowstyle="-|>", mutation_scale=11, color=colour, lw=1.6, shrinkA=0, shrinkB=0,
                transform=IdentityTransform(),
            ))  # fmt: skip
            x, y = tip[0] + _BEYOND * across / size, tip[1] + _BEYOND * above / size
        figure.text(x / _WIDTH, y / _HEIGHT, name, ha="center", va="center", fontsize=9.5 if len(name) < 3 else 8,
                    color=colour, weight="bold" if name == "N" else "normal", gid="compass")  # fmt: skip


def _overlap(one: _Box, other: _Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def _write_labels(figure: Any, picture: Picture, camera: Camera, wide: int, high: int, scale: _Box) -> None:
    """Labels where they cover no other, nor the scale; how many found no room is said."""
    from matplotlib.lines import Line2D

    taken = [scale, (wide - 160.0, _BOTTOM + 0.0, wide + 0.0, _BOTTOM + 20.0)]
    left = 0
    lifted = 26.0 if picture.beside else 0.0
    for point, text in picture.labels:
        across, above = camera.seen(point)
        x = wide / 2 + across / camera.height * high
        y = _BOTTOM + high / 2 + above / camera.height * high
        half, tall = 3.3 * len(text) + 2, 7.0
        box = (x - half, y + lifted - tall, x + half, y + lifted + tall)
        inside = box[0] > 0 and box[2] < wide and box[1] > _BOTTOM and box[3] < _BOTTOM + high
        if not inside or any(_overlap(box, other) for other in taken):
            left += 1
            continue
        taken.append(box)
        if picture.beside:
            ends = [y / _HEIGHT, (y + lifted) / _HEIGHT]
            figure.add_artist(Line2D([x / _WIDTH] * 2, ends, color="#222222", lw=0.9, marker="o", ms=3, markevery=[0]))
        figure.text(x / _WIDTH, (y + lifted) / _HEIGHT, text, fontsize=8, ha="center", va="center",
                    bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.8})  # fmt: skip
    if left:
        figure.text((wide - 6) / _WIDTH, (_BOTTOM + 6) / _HEIGHT, f"{left} names left out: no room", fontsize=7.5,
                    ha="right", color="#666666")  # fmt: skip


# -- GLB and glTF -----------------------------------------------------------------------------------------------------

_TO_Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1.0]])


def _save_gltf(picture: Picture, path: Path) -> None:
    import trimesh

    scene = trimesh.Scene()
    for k, part in enumerate(_moved(picture).layers):
        if len(part.triangles):
            scene.add_geometry(_mesh(trimesh, part), node_name=part.name, geom_name=f"{k} {part.name}")
    scene.apply_transform(_TO_Y_UP)
    with writing(path), whole_file(path) as file:
        save_gltf(scene, file)


def _mesh(trimesh: Any, part: Layer) -> Any:
    """A layer whose triangles have corners of their own, so that faces stay flat and keep their colours."""
    corners = part.vertices[part.triangles].reshape(-1, 3)
    alpha = np.full((len(part.colours), 1), round(255 * part.opacity))
    colours = np.repeat(np.concatenate([part.colours, alpha], axis=1), 3, axis=0).astype(np.uint8)
    faces = np.arange(len(corners)).reshape(-1, 3)
    return trimesh.Trimesh(corners, faces, vertex_colors=colours, process=False)
