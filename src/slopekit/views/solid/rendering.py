"""Drawing pictures: pixels by pyvista in parallel projection, words, scale and compass laid out by matplotlib.

GLB and glTF are written with trimesh: a scene of named layers about its middle, in metres, y up.
"""

import math
import textwrap
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import DesignError, Fault, writing
from slopekit.core.whole_files import whole_file
from slopekit.exchange.solids import save_gltf
from slopekit.views.charts import drawing
from slopekit.views.solid.layers import Bar, Layer, Picture
from slopekit.views.solid.scene_parts import nice

_INCHES, _PIXELS = (11.3, 8.0), (1600, 1304)  # the picture; the scene, about two pixels for each of the picture's
_EDGE_DEG = 12.0  # edges between flatter faces are not drawn
_MARGIN = 1.06  # of the frame, about all that is drawn
_END_ON = 0.3  # of its length: an axis shorter than that in the picture is named, not drawn
_LEGEND, _NOTES, _ENTRIES = 40, 160, 18  # letters in a line of the legend and of the notes; entries of the legend
_LABEL = (4.3e-3, 0.022)  # of the frame: half the width of a letter, the height of a label
_QUIET = "#444444"
_Box = tuple[float, float, float, float]  # left, lower, right, upper: m in the frame
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
        aspect = _PIXELS[0] / _PIXELS[1]
        middle = about + right * (x.min() + x.max()) / 2.0 + up * (y.min() + y.max()) / 2.0 + eye * z.mean()
        return cls(right, up, eye, middle, _MARGIN * max(high, wide / aspect, 1e-12))

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
                plotter.add_mesh(edges, color="#3a2a1c", line_width=2.4, opacity=max(part.opacity, 0.55))


def _moved(picture: Picture) -> Picture:
    """The same about the middle of the scene."""
    points = np.concatenate([part.vertices[part.triangles.ravel()] for part in picture.layers])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    layers = tuple(replace(part, vertices=part.vertices - middle) for part in picture.layers)
    return replace(picture, layers=layers, labels=tuple((point - middle, text) for point, text in picture.labels))


# -- PNG --------------------------------------------------------------------------------------------------------------


def _save_png(picture: Picture, path: Path) -> None:
    require_drawing(path)
    pyvista = _pyvista()
    picture = _moved(picture)
    plotter = pyvista.Plotter(off_screen=True, window_size=list(_PIXELS))
    camera = Camera.of(picture)
    try:
        _fill(plotter, pyvista, picture, camera.height)
        camera.set(plotter)
        pixels = plotter.screenshot(None, return_img=True)
    finally:
        plotter.close()
    figure = drawing.new_figure(path)
    lay_out(figure, picture, camera, pixels)
    drawing.save(figure, path)


def lay_out(figure: Any, picture: Picture, camera: Camera, pixels: Any) -> None:
    """The pixels of a scene with title, legend, colour bar, scale, compass and notes; axes in m, as `Camera.seen`."""
    high = camera.height / 2.0
    wide = high * _PIXELS[0] / _PIXELS[1]
    figure.set_size_inches(*_INCHES)
    axes = figure.subplots()
    axes.imshow(pixels, extent=(-wide, wide, -high, high))
    axes.axis("off")
    axes.set_anchor("NW")
    answer = textwrap.wrap(picture.subtitle, 110)
    title = textwrap.shorten(drawing.short(picture.title, 110), 110)
    axes.set_title(title, fontsize=13, weight="bold", loc="left", pad=8.0 + 14.0 * len(answer))
    note = {"xycoords": "axes fraction", "textcoords": "offset points", "fontsize": 10}
    axes.annotate("\n".join(answer), (0.0, 1.0), xytext=(0, 5), **note)
    figure.supxlabel("\n".join(line for note in picture.notes for line in textwrap.wrap(note, _NOTES)), x=0.01,
                     ha="left", fontsize=8.5, color=_QUIET)  # fmt: skip
    _legend(figure, picture)
    if picture.bar is not None:
        _bar(figure, axes, picture.bar)
    _scale(axes, wide, high)
    _compass(axes, camera)
    _write_labels(axes, picture, camera, wide, high)


def _legend(figure: Any, picture: Picture) -> None:
    """The legend at the right, below the longest title; how many entries have no room is said."""
    from matplotlib.patches import Patch

    patches = []
    for text, colour, opacity in picture.legend[:_ENTRIES]:
        shade = tuple(1.0 - opacity * (1.0 - part / 255.0) for part in colour)
        label = "\n".join(textwrap.wrap(drawing.short(text, 200), _LEGEND))
        patches.append(Patch(facecolor=shade, edgecolor=_QUIET, linewidth=0.6, label=label))
    left = len(picture.legend) - len(patches)
    patches += [Patch(alpha=0.0, label=f"and {left} more that have no room here")] if left else []
    figure.legend(handles=patches, loc="outside right center", fontsize=9, frameon=False)


def _bar(figure: Any, axes: Any, bar: Bar) -> None:
    """The colour bar beneath the scene."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize
    from matplotlib.ticker import MaxNLocator

    steps = np.linspace(bar.low, bar.high, 128)
    colours = ScalarMappable(Normalize(bar.low, bar.high), ListedColormap(bar.colours(steps) / 255.0))
    ticks = MaxNLocator()
    figure.colorbar(colours, ax=axes, location="bottom", label=bar.label, ticks=ticks, shrink=0.5, aspect=40)


def _scale(axes: Any, wide: float, high: float) -> None:
    """A scale bar beneath the scene: lengths square to the line of sight are true."""
    length, y = nice(0.44 * wide), -1.03 * high
    style = {"color": "black", "linewidth": 1.6, "solid_capstyle": "butt", "marker": "|", "markeredgewidth": 0.8}
    axes.plot([-wide, length - wide], [y, y], clip_on=False, **style)
    axes.text(length / 2.0 - wide, y, f"{length:g} m", fontsize=9, ha="center", va="bottom")
    axes.set_xlim(-wide, wide)
    axes.set_ylim(-high, high)


def _compass(axes: Any, camera: Camera) -> None:
    """North, east and up as they lie in the picture, at the right of its foot; what points end-on is named beneath."""
    inset = axes.inset_axes((1.02, 0.0, 0.16, 0.2))
    inset.axis("off")
    inset.set(xlim=(-1.5, 1.5), ylim=(-1.5, 1.5), aspect="equal")
    ways = (("N", (0.0, 1.0, 0.0), "#b5281e"), ("up", (0.0, 0.0, 1.0), _QUIET), ("E", (1.0, 0.0, 0.0), _QUIET))
    for name, way, colour in ways:
        x, y, toward = (float(np.array(way) @ part) for part in (camera.right, camera.up, camera.eye))
        size = math.hypot(x, y)
        if size < _END_ON:
            said = f"{name} {'toward you' if toward > 0 else 'into the picture'}"
            inset.text(0.0, -0.4, said, ha="center", va="top", fontsize=8, color=colour)
            continue
        inset.annotate("", (x, y), (0.0, 0.0), arrowprops={"arrowstyle": "-|>", "color": colour, "shrinkA": 0})
        out = 1.0 + 0.3 / size
        inset.text(out * x, out * y, name, ha="center", va="center", fontsize=9.5, color=colour)


def _write_labels(axes: Any, picture: Picture, camera: Camera, wide: float, high: float) -> None:
    """Labels where they cover no other; how many found no room is said."""
    taken = list[_Box]()
    lift = 0.08 * high if picture.beside else 0.0
    for point, text in picture.labels:
        x, y = camera.seen(point)
        half, tall = 2.0 * wide * _LABEL[0] * (len(text) + 1), high * _LABEL[1]
        box = x0, y0, x1, y1 = x - half, y + lift - tall, x + half, y + lift + tall
        if max(map(abs, box[::2])) > wide or max(map(abs, box[1::2])) > high:
            continue
        if any(a < x1 and x0 < c and b < y1 and y0 < d for a, b, c, d in taken):
            continue
        taken.append(box)
        if picture.beside:
            axes.plot([x, x], [y, y + lift], color="#222222", linewidth=0.9, marker="o", markersize=3, markevery=[0])
        axes.text(x, y + lift, text, fontsize=8, ha="center", va="center", bbox=drawing.BOX)
    if left := len(picture.labels) - len(taken):
        axes.text(wide, -1.03 * high, f"{left} names left out: no room", fontsize=7.5, ha="right", color=_QUIET)


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
