"""`slopekit export` and `sk.export`: one function from a result to files, and what was written in words."""

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slopekit.core.errors import DesignError, Fault, Notice, did_you_mean, writing
from slopekit.core.extras import require_extra
from slopekit.core.whole_files import whole_files
from slopekit.exchange.bodies import block_bodies
from slopekit.exchange.dxf import write_dxf
from slopekit.exchange.solids import Files, write_glb, write_obj, write_stl
from slopekit.exchange.source import ExportInput, ExportSource, sources_of
from slopekit.exchange.vtu import write_vtu
from slopekit.geometry.solids.sliding_mass import volume_moments

_CURVED_VOLUME_TOLERANCE = (
    1e-6  # of the volume: what flat triangles leave of a curved body is said above it
)


#: Name and writer of each format, by the suffix of the file.
FORMATS: Mapping[str, tuple[str, Callable[[Path, ExportSource], Files]]] = {
    ".stl": ("STL", write_stl),
    ".obj": ("OBJ", write_obj),
    ".glb": ("GLB", write_glb),
    ".gltf": ("glTF", write_glb),
    ".vtu": ("VTU", write_vtu),
    ".dxf": ("DXF", write_dxf),
}
_ROUNDED = (".glb", ".gltf")  # coordinates from each block's own middle are float32
_WITH_BOLTS = (".glb", ".gltf", ".vtu", ".dxf")


@dataclass(frozen=True)
class Written:
    """One export.

    Attributes
    ----------
    files : written, the first is the one asked for; format, precision : in words
    blocks, interfaces, pairs, bolts : how many; volume_m3 : of the blocks as they were written
    case : the load case it is of, empty without
    """

    files: tuple[Path, ...]
    format: str
    precision: str
    blocks: int
    interfaces: int
    pairs: int
    volume_m3: float
    bolts: int
    case: str = ""

    def to_dict(self) -> dict[str, Any]:
        """As JSON values."""
        record = asdict(self) | {"files": [str(path) for path in self.files]}
        return (
            record if self.case else {key: value for key, value in record.items() if key != "case"}
        )


@dataclass(frozen=True)
class Export:
    """The files that `export` wrote, and notices on them."""

    written: tuple[Written, ...]
    warnings: tuple[Notice, ...] = ()

    @property
    def files(self) -> tuple[Path, ...]:
        """Every file."""
        return tuple(path for export in self.written for path in export.files)

    def to_dict(self) -> dict[str, Any]:
        """As JSON values."""
        return {
            "written": [export.to_dict() for export in self.written],
            "warnings": [notice.to_dict() for notice in self.warnings],
        }


def export(
    result: ExportInput,
    path: str | os.PathLike[str],
    *,
    case: str | None = None,
) -> Export:
    """Write the blocks and bolts of a result to a file of another program; in VTU interfaces and node pairs too.

    Parameters
    ----------
    result : a result, its JSON as a dict, or the path of the JSON file or of the folder of result.json
    path : the file, its format by the suffix: .stl .obj .glb .gltf .vtu .dxf (.dxf needs the extra `cad`)
    case : one of the load cases of the result, by name; without it each has a file of its own, NAME-CASE.dxf beside
        `path`

    Raises
    ------
    DesignError
        E129, E140, E141, E197, E313, E340 and E350: see `slopekit explain`.

    Notes
    -----
    Coordinates are m, east, north, up, those of the design with its `origin`. The volume of what was written is counted
    again, m³, and stands in `written[i].volume_m3` to be held against `result.geometry.volume_m3`.

    Examples
    --------
    >>> import slopekit as sk, tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     done = sk.export(sk.wedge(dips=("45/115", "45/245")), pathlib.Path(folder) / "wedge.stl")
    >>> done.written[0].blocks, round(done.written[0].volume_m3)
    (1, 209461)
    """
    target, sources = _target(Path(path)), sources_of(result, case)
    written, cases_by_notice = list[Written](), dict[Notice, list[str]]()
    for name, source in sources.items():
        is_alone = case is not None or not name
        file = target if is_alone else target.with_name(f"{target.stem}-{name}{target.suffix}")
        written.append(_written_file(file, source, name))
        for notice in _notices(source):
            cases_by_notice.setdefault(notice, []).append(name)
    notices = [
        notice
        if len(case_names) == len(sources)
        else Notice(notice.code, f"{', '.join(case_names)}: {notice.message}")
        for notice, case_names in cases_by_notice.items()
    ]
    return Export(tuple(written), tuple(notices))


def _written_file(path: Path, source: ExportSource, case: str) -> Written:
    """Write one file of one case, and count what is in it."""
    suffix, scene, bodies = path.suffix.lower(), source.scene, block_bodies(source.scene)
    name, write = FORMATS[suffix]
    with writing(path), whole_files(path.parent) as staging:  # VTU has a file more for each part
        files, precision = write(staging / path.name, source)
    if suffix in _ROUNDED:
        volume = sum(
            volume_moments(body.local.astype(np.float32).astype(np.float64), body.triangles)[0]
            for body in bodies
        )
    else:
        volume = sum(body.volume for body in bodies)
    interfaces, pairs = (
        (len(scene.shapes.contacts), len(scene.pairs)) if suffix == ".vtu" else (0, 0)
    )
    bolts = len(scene.known_bolts) if suffix in _WITH_BOLTS else 0
    targets = tuple(path.with_name(file.name) for file in files)
    return Written(targets, name, precision, len(bodies), interfaces, pairs, volume, bolts, case)


def _target(path: Path) -> Path:
    """The file to write, refused before any work is done; E129, E140, E141."""
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        suffix_text = f"the suffix {suffix}" if suffix else "a file without suffix"
        advice = f"There are: {' '.join(FORMATS)}. {did_you_mean(suffix, FORMATS)}".rstrip()
        raise DesignError(
            [Fault("E141", f"{suffix_text} is no format that slopekit writes", str(path), advice)]
        )
    if suffix == ".dxf":
        require_extra("cad", "DXF files need", "ezdxf", where=path)
    if path.is_dir():
        raise DesignError([Fault("E129", f"{path} cannot be written: it is a folder", str(path))])
    _refuse_unwritable(path.parent)
    return path


def _refuse_unwritable(folder: Path) -> None:
    """E129 where a file cannot be made in a folder."""
    import tempfile

    with writing(folder, "the folder "), tempfile.TemporaryFile(dir=folder):
        pass


def _notices(source: ExportSource) -> Iterator[Notice]:
    """Iterate over notices on limits of the files: W376 flat triangles for a curved body."""
    true = float((source.document.get("geometry") or {}).get("volume_m3") or 0.0)
    if source.is_curved and true > 0.0:
        flat = sum(body.volume for body in block_bodies(source.scene))
        share, word = abs(1.0 - flat / true), "less" if flat < true else "more"
        if share > _CURVED_VOLUME_TOLERANCE:
            message = f"the mass is written with flat triangles: {flat:.6g} m³"
            yield Notice(
                "W376",
                f"{message}, {share * 100:.2g} % {word} than the curved body's {true:.6g} m³",
            )
