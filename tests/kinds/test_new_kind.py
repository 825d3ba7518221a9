"""A kind in one file from outside, the one of docs/add-a-kind.md: read, analysed, printed, checked, varied, drawn."""

import json
import math
import re
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

import slopekit as sk
from slopekit import kinds
from slopekit.core.errors import DesignError
from slopekit.design.registry import KINDS
from tests.support import forget_kinds

PAGE = Path(__file__).parents[2] / "docs/add-a-kind.md"
SLAB = {
    "slopekit": 1,
    "kind": "slab",
    "weak_plane": {"dip": 35, "length": "8 m", "thickness": "2 m"},
    "strength": {"seam": {"c": "12 kPa", "phi": 30}},
    "rock": {"unit_weight": 25},
}


@pytest.fixture(autouse=True)
def _slab(tmp_path):
    """The file of the page, imported as one from outside is."""
    code = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
    path = tmp_path / "slab.py"
    path.write_text(code, encoding="utf-8")
    spec = spec_from_file_location("slab", path)
    spec.loader.exec_module(module_from_spec(spec))
    yield
    forget_kinds()


def test_every_kind_that_ships_is_told() -> None:
    folder = Path(kinds.__file__).parent
    files = {path.stem: path for path in folder.glob("*.py")}
    files |= {path.parent.name: path for path in folder.glob("*/__init__.py")}
    have = {name for name, path in files.items() if "\nKIND = " in path.read_text(encoding="utf-8")}
    assert have == {name for name, kind in KINDS.items() if isinstance(kind, str)}


def exact(dip=35.0, c=12.0, phi=30.0) -> float:
    """F = (c L + W cos α tan φ) / (W sin α), 25 kN/m³, 8 m by 2 m."""
    a, weight = math.radians(dip), 25.0 * 16.0
    return (8.0 * c + weight * math.cos(a) * math.tan(math.radians(phi))) / (weight * math.sin(a))


def test_it_is_analysed() -> None:
    result = sk.run(SLAB)
    assert result.fos.limit == pytest.approx(exact(), rel=1e-9)
    assert result.fos.closed_form == pytest.approx(exact(), rel=1e-12)
    assert (result.status_text, result.agree) == ("slides on its seam", True)
    pushed = sk.run(SLAB, set={"loads.seismic": 0.1})
    assert pushed.fos.limit == pytest.approx(pushed.fos.closed_form, rel=1e-9)
    assert pushed.fos.limit < 0.9 * exact()


def test_it_is_printed() -> None:
    result = sk.run(SLAB, set={"loads.seismic": 0.1})
    lines = str(result).splitlines()
    assert lines[1:3] == [
        "PLANES    seam dips 35°, 8 m long, 2 m thick",
        "SIZE      height 6.23 m  volume 16 m³ per metre  weight 400 kN",  # 8 sin 35° + 2 cos 35°
    ]
    assert "LOADS     seismic 0.1 g out of the slope" in lines
    document = json.loads(json.dumps(result.to_dict()))
    assert (document["kind"], document["inputs"]["thickness_m"]) == ("slab", 2.0)
    assert document["governs"][0]["change"] == "dip +1°"
    assert document["mechanism"]["blocks"] == ["slab"]


def test_it_is_checked_and_varied() -> None:
    design = sk.load(SLAB)
    checked = sk.check(design)
    assert (checked.consistent, checked.against) == (True, "the closed form")
    assert {"closed form", "forces alone", "mesh"} <= {rung.method for rung in checked.ladder}
    swept = sk.sweep(design, {"weak_plane.dip": "32:40:5"})
    found = [point.factors.limit for point in swept.points]
    assert found == pytest.approx([exact(dip) for dip in (32, 34, 36, 38, 40)], rel=1e-9)
    root = sk.solve(design, "strength.seam.phi", fos=1.5).answer.value
    assert exact(phi=root) == pytest.approx(1.5, abs=1e-6)


@pytest.mark.slow
def test_it_is_drawn_and_written(tmp_path) -> None:
    result = sk.run(SLAB)
    sk.report(result, tmp_path / "slab.html", pictures=False)
    sk.plot(result, "scene", tmp_path / "slab.png")
    assert (tmp_path / "slab.png").stat().st_size > 10_000
    assert "slab on a seam" in (tmp_path / "slab.html").read_text(encoding="utf-8")
    written = sk.export(result, tmp_path / "slab.stl").written[0]
    assert written.volume_m3 == pytest.approx(16.0)


def test_what_is_wrong_is_refused() -> None:
    with pytest.raises(DesignError) as caught:
        sk.load({**SLAB, "weak_plane": {"dip": -3, "length": "8 kg", "thickness": 2}})
    assert [fault.code for fault in caught.value.faults] == ["E101", "E108"]
    with pytest.raises(DesignError, match="this design is of kind slab"):
        sk.support(sk.load(SLAB), fos=1.5)
    forget_kinds()
    with pytest.raises(DesignError, match="E174"):
        sk.load(SLAB)
