"""The study of docs/add-a-study.md, a folder and a line of registration: its command, its files, Python, page."""

import csv
import inspect
import json

import pytest

import slopekit as sk
from slopekit.design.templates import path_of
from tests.commands import slopekit
from tests.support import study_of_the_page

WEDGE = str(path_of("wedge"))


@pytest.fixture(autouse=True)
def _flip(tmp_path):
    with study_of_the_page(tmp_path / "found"):
        yield


def test_a_script_calls_it() -> None:
    design = sk.load(WEDGE)
    found = sk.flip(design, by=2)
    assert "flip" in dir(sk)
    assert [one.dip_deg for one in found.turned] == [43.0, 47.0, 43.0, 47.0]
    turned = sk.run(WEDGE, set={"joints.J1.plane.dip": 47})
    assert found.turned[1].point.factors.limit == turned.fos.limit
    least = [
        f"<Flip: least {turned.fos.limit:.3f} at joints.{joint}.plane.dip 47°>"
        for joint in ("J1", "J2")
    ]
    assert (
        repr(found) in least
    )  # the joints mirror each other: rounding says which of the two is lower
    assert f"{turned.fos.limit:.3f}" in str(found).splitlines()[3]
    assert f"<td>{turned.fos.limit:.3f}</td>" in found._repr_html_()
    assert found.tables()["flip"].records()[1]["pre_ie"] == turned.fos.limit
    assert "by : How far each joint is turned" in inspect.getdoc(sk.flip)


@pytest.mark.parametrize(
    ("values", "named", "code"),
    [
        (("wedge.yaml",), {}, "E147"),
        ((3, 2), {}, "E405"),
        ((3,), {"bye": 2}, "E405"),
        ((), {}, "E405"),
    ],
)
def test_it_says_what_it_takes(values, named, code) -> None:
    with pytest.raises(sk.DesignError, match=code):
        sk.flip(*values, **named)


def test_it_is_a_command(tmp_path) -> None:
    assert "flip" in slopekit("--help").stdout
    assert "--by" in slopekit("flip", "--help").stdout
    done = slopekit(
        "flip", WEDGE, "--set", "slope.height=20", "--by", "3", "-o", str(tmp_path / "out")
    )
    assert done.returncode == 0
    document = json.loads((tmp_path / "out/flip.json").read_text(encoding="utf-8"))
    assert (document["study"], document["by_deg"]) == ("flip", 3.0)
    first, *others = (tmp_path / "out/flip.txt").read_text(encoding="utf-8").splitlines()
    assert [first.partition("   sha ")[0], *others] == done.stdout.splitlines()
    with (tmp_path / "out/flip.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["pre_ie"]) for row in rows] == [one["limit"] for one in document["turned"]]
    assert slopekit("flip", WEDGE, "--quiet").stdout == sk.flip(sk.load(WEDGE)).line + "\n"
    again = json.loads(slopekit("flip", WEDGE, "--json").stdout)
    assert again == sk.flip(sk.load(WEDGE)).to_dict()


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("no.yaml",), 2, "E147"),
        ((WEDGE, "--by", "far"), 2, "E106"),
        ((WEDGE, "--picture", "x.png"), 2, "E100"),
        ((WEDGE, "--set", "analysis.agree_within=1e-16"), 4, ""),
    ],
)
def test_its_exit_codes(arguments, code, said) -> None:
    done = slopekit("flip", *arguments)
    assert done.returncode == code
    assert done.stderr.startswith(said)


def test_it_has_a_page(tmp_path) -> None:
    pytest.importorskip("jinja2")
    found = sk.flip(sk.load(WEDGE))
    page = sk.report(found, tmp_path / "flip.html", pictures=False).read_text(encoding="utf-8")
    for row in found.sheet.sections[0].to_list()[0]["shown"]:
        assert all(f">{cell}<" in page for cell in row)
