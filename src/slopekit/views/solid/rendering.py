"""Drawing pictures: pixels by pyvista in parallel projection, words, scale and compass laid out by matplotlib.

GLB and glTF are written with trimesh: a scene of named layers about its middle, in metres, y up.
"""

import math
import textwrap
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.core.arrays import Floats, cross
from slopekit.core.errors import writing
from slopekit.core.extras import require_extra
from slopekit.core.whole_files import whole_file
from slopekit.exchange.solids import save_gltf
from slopekit.views.charts import drawing
from slopekit.views.solid.layers import Bar, Colour, Layer, Picture
from slopekit.views.solid.scene_parts import rounded_down_125

_INCHES, _PIXELS = (
    (11.3, 8.0),
    (1600, 1304),
)  # the picture; the scene, about two pixels for each of the picture's
_EDGE_DEG = 12.0  # edges between flatter faces are not drawn
_MARGIN, _LIFT = (
    1.06,
    1e-3,
)  # of the frame: about all that is drawn; how far edges stand before their faces
_SHORTEST_AXIS = 0.3  # of its length: an axis shorter than that in the picture is named, not drawn
_LEGEND, _NOTES, _ENTRIES = (
    40,
    160,
    18,
)  # letters in a line of the legend and of the notes; entries of the legend
_FOOT = -1.03  # of half the frame: where scale and remarks stand
_TEXT_COLOUR = "#444444"


def save(picture: Picture, path: Path) -> None:
    """Draw a picture to a PNG, GLB or glTF file.

    Raises
    ------
    DesignError
        E140 where pyvista or matplotlib is not installed, E129 where the file cannot be written.
    """
    with writing(path):
        if path.suffix.lower() in (".glb", ".gltf"):
            _save_gltf(picture, path)
        else:
            camera = Camera.about(picture.points, picture.eye)
            pixels = pixels_of(picture, camera)
            with drawing.new_figure(path) as figure:
                lay_out(figure, picture, camera, pixels)
                drawing.save(figure, path)


def require_drawing(path: Path | str) -> None:
    """Raise E140 where no scene can be drawn, before the work is done."""
    require_extra("plot", "drawing needs", "pyvista", "matplotlib", where=path)


class Camera:
    """A parallel projection: `right`, `up`, `eye` (3,) unit; `middle` (3,) m of the frame, `half` of its sides, m."""

    def __init__(
        self, right: Floats, up: Floats, eye: Floats, middle: Floats, half: tuple[float, float]
    ) -> None:
        self.right, self.up, self.eye, self.middle, self.half = right, up, eye, middle, half

    @classmethod
    def about(cls, points: Floats, eye: Floats) -> "Camera":
        """The frame that holds points (n, 3), seen from a direction (3,)."""
        right = cross(np.array([0.0, 0.0, 1.0]), eye)
        right = right / math.sqrt(float(right @ right))
        up = cross(eye, right)
        centre = points.mean(axis=0)
        x, y, z = np.array([right, up, eye]) @ (points - centre).T
        aspect = _PIXELS[0] / _PIXELS[1]
        middle = (
            centre
            + right * (x.min() + x.max()) / 2.0
            + up * (y.min() + y.max()) / 2.0
            + eye * z.mean()
        )
        high = _MARGIN * max(float(np.ptp(y)), float(np.ptp(x)) / aspect, 1e-12) / 2.0
        return cls(right, up, eye, middle, (high * aspect, high))

    def seen(self, point: Floats) -> tuple[float, float]:
        """Return the place of a point in the picture: m to the right of the middle of the frame, and above it."""
        return float((point - self.middle) @ self.right), float((point - self.middle) @ self.up)


def pixels_of(picture: Picture, camera: Camera) -> Any:
    """The scene alone as a camera has it: pixels (rows, columns, 3).

    Layers in front stand nearer to the eye, which a parallel projection does not show.

    Raises
    ------
    DesignError
        E140 where pyvista is not installed.
    """
    require_drawing("")
    import pyvista

    pyvista.vtk_verbosity("off")
    plotter = pyvista.Plotter(off_screen=True, window_size=list(_PIXELS))
    plotter.set_background("white")
    high = camera.half[1]
    try:
        for layer in picture.layers:
            if len(layer.triangles):
                # about the middle: VTK has single precision, map coordinates do not fit into that
                points = layer.vertices - camera.middle + 2.0 * high * layer.front * camera.eye
                mesh = pyvista.PolyData(points, np.insert(layer.triangles, 0, 3, axis=1).ravel())
                _add_layer(plotter, layer, mesh, _LIFT * high * camera.eye)
        plotter.camera_position = [
            tuple(16.0 * high * camera.eye),
            (0.0, 0.0, 0.0),
            tuple(camera.up),
        ]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = high
        plotter.reset_camera_clipping_range()
        return plotter.screenshot(None, return_img=True)
    finally:
        plotter.close()


def _add_layer(plotter: Any, layer: Layer, mesh: Any, lift: Floats) -> None:
    """A layer, and its edges where they are drawn, nearer to the eye by `lift` (3,) m: faces do not cover them."""
    mesh.cell_data["colour"] = layer.colours.astype(np.uint8)
    plotter.add_mesh(
        mesh, scalars="colour", rgb=True, opacity=layer.opacity, ambient=0.45, diffuse=0.62
    )
    if layer.outlined:
        edges = mesh.extract_feature_edges(
            _EDGE_DEG, manifold_edges=False, non_manifold_edges=False
        )
        if layer.shortest > 0.0 and edges.n_points:
            ends = edges.points[edges.lines.reshape(-1, 3)[:, 1:]]
            long = np.sqrt(((ends[:, 1] - ends[:, 0]) ** 2).sum(axis=1)) > layer.shortest
            edges = edges.extract_cells(np.flatnonzero(long))
        if edges.n_points:
            edges.points += lift
            plotter.add_mesh(
                edges, color="#3a2a1c", line_width=2.4, opacity=max(layer.opacity, 0.55)
            )


# -- words about it ---------------------------------------------------------------------------------------------------


def shade(colour: Colour, opacity: float = 1.0) -> tuple[float, ...]:
    """A colour as matplotlib has it, on white."""
    return tuple(1.0 - opacity * (1.0 - component / 255.0) for component in colour)


def lay_out(figure: Any, picture: Picture, camera: Camera, pixels: Any) -> None:
    """The pixels of a scene with title, legend, colour bar, scale, compass and notes; axes in m, as `Camera.seen`."""
    wide, high = camera.half
    figure.set_size_inches(*_INCHES)
    axes = figure.subplots()
    axes.imshow(pixels, extent=(-wide, wide, -high, high))
    axes.axis("off")
    axes.set_anchor("NW")
    answer = textwrap.wrap(picture.subtitle, 110)
    title = textwrap.shorten(drawing.short(picture.title, 110), 110)
    axes.set_title(title, fontsize=13, weight="bold", loc="left", pad=8 + 14 * len(answer))
    axes.annotate(
        "\n".join(answer),
        (0.0, 1.0),
        (0, 5),
        xycoords="axes fraction",
        textcoords="offset points",
        fontsize=10,
    )
    notes = "\n".join(line for note in picture.notes for line in textwrap.wrap(note, _NOTES))
    figure.supxlabel(notes, x=0.01, ha="left", fontsize="medium", color=_TEXT_COLOUR)
    _legend(figure, picture)
    if picture.bar is not None:
        _colour_bar(figure, axes, picture.bar)
    length = rounded_down_125(
        0.44 * wide
    )  # a scale bar: lengths square to the line of sight are true
    axes.plot(
        [-wide, length - wide],
        [_FOOT * high] * 2,
        color="black",
        solid_capstyle="butt",
        marker="|",
        markeredgewidth=0.8,
        clip_on=False,
    )
    axes.text(length / 2.0 - wide, _FOOT * high, f"{length:g} m", ha="center", va="bottom")
    axes.set(xlim=(-wide, wide), ylim=(-high, high))
    _compass(axes, camera)
    _write_labels(axes, picture, camera)


def _legend(figure: Any, picture: Picture) -> None:
    """The legend at the right, below the longest title; how many entries have no room is said."""
    from matplotlib.patches import Patch

    patches = []
    for text, colour, opacity in picture.legend[:_ENTRIES]:
        label = "\n".join(textwrap.wrap(drawing.short(text, 200), _LEGEND))
        patches.append(Patch(facecolor=shade(colour, opacity), edgecolor=_TEXT_COLOUR, label=label))
    omitted = len(picture.legend) - len(patches)
    patches += (
        [Patch(alpha=0.0, label=f"and {omitted} more that have no room here")] if omitted else []
    )
    figure.legend(handles=patches, loc="outside right center")


def _colour_bar(figure: Any, axes: Any, bar: Bar) -> None:
    """The colour bar beneath the scene."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize

    steps = np.linspace(bar.low, bar.high, 128)
    colours = ScalarMappable(
        Normalize(bar.low, bar.high), ListedColormap(bar.colours(steps) / 255.0)
    )
    figure.colorbar(colours, ax=axes, location="bottom", label=bar.label, shrink=0.5, aspect=40)


def _compass(axes: Any, camera: Camera) -> None:
    """North, east and up as they lie in the picture, at the right of its foot; what points end-on is named beneath."""
    inset = axes.inset_axes((1.02, 0.0, 0.14, 0.2))
    inset.axis("off")
    inset.set(xlim=(-1.5, 1.5), ylim=(-1.5, 1.5), aspect="equal")
    directions = (
        ("N", (0.0, 1.0, 0.0), "#b5281e"),
        ("up", (0.0, 0.0, 1.0), _TEXT_COLOUR),
        ("E", (1.0, 0.0, 0.0), _TEXT_COLOUR),
    )
    for name, direction, colour in directions:
        x, y, toward = (
            float(np.array(direction) @ axis) for axis in (camera.right, camera.up, camera.eye)
        )
        size = math.hypot(x, y)
        if size < _SHORTEST_AXIS:
            label = f"{name} {'toward you' if toward > 0 else 'into the picture'}"
            inset.text(0.0, -0.4, label, ha="center", va="top", color=colour)
            continue
        inset.annotate(
            "", (x, y), (0.0, 0.0), arrowprops={"arrowstyle": "-|>", "color": colour, "shrinkA": 0}
        )
        label_distance = 1.0 + 0.3 / size
        inset.text(
            label_distance * x, label_distance * y, name, ha="center", va="center", color=colour
        )


def _write_labels(axes: Any, picture: Picture, camera: Camera) -> None:
    """Labels where they cover no other; how many found no room is said."""
    if not picture.labels:
        return
    axes.figure.draw_without_rendering()  # the layout settles where points come to lie
    label_boxes, (wide, high), omitted = list[Any](), camera.half, 0
    lift = 0.08 * high if picture.has_label_lines else 0.0
    for point, text in picture.labels:
        x, y = camera.seen(point)
        if not drawing.place_label(
            axes, text, (x, y + lift), ((0, 0),), label_boxes, bbox=drawing.BOX
        ):
            omitted += 1
        elif picture.has_label_lines:
            axes.plot(
                [x, x],
                [y, y + lift],
                color="black",
                linewidth=1,
                marker="o",
                markersize=3,
                markevery=[0],
            )
    if omitted:
        axes.text(
            wide, _FOOT * high, f"{omitted} names left out: no room", ha="right", color=_TEXT_COLOUR
        )


# -- GLB and glTF -----------------------------------------------------------------------------------------------------

_TO_Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1.0]])


def _save_gltf(picture: Picture, path: Path) -> None:
    import trimesh

    scene, points = trimesh.Scene(), picture.points
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    for k, layer in enumerate(picture.layers):
        if len(layer.triangles):
            scene.add_geometry(
                _mesh(trimesh, layer, middle), node_name=layer.name, geom_name=f"{k} {layer.name}"
            )
    scene.apply_transform(_TO_Y_UP)
    with whole_file(path) as file:
        save_gltf(scene, file)


def _mesh(trimesh: Any, layer: Layer, middle: Floats) -> Any:
    """A layer about the middle, whose triangles have corners of their own: faces stay flat and keep their colours."""
    corners = (layer.vertices - middle)[layer.triangles].reshape(-1, 3)
    alpha = np.full((len(layer.colours), 1), round(255 * layer.opacity))
    colours = np.repeat(np.concatenate([layer.colours, alpha], axis=1), 3, axis=0).astype(np.uint8)
    faces = np.arange(len(corners)).reshape(-1, 3)
    return trimesh.Trimesh(corners, faces, vertex_colors=colours, process=False)
