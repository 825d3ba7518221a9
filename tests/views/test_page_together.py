"""Several documents on one page: each fact once, what their inputs do not share, a view of each scene."""

import io
import json
import re
from functools import cache
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.sheet import factor_text
from slopekit.design.templates import path_of
from slopekit.views.pages import page_pictures
from slopekit.views.pages.page_together import inputs_table, same_design
from slopekit.views.pages.report import report_of
from tests.bolted import WEDGE, bolt

pytest.importorskip("jinja2")
BOLTS = [bolt(east, 8.0, 60.0, "active") for east in (-2.0, -1.0, 0.0, 1.0)]
SCATTER: dict[str, Any] = WEDGE | {
    "strength": {
        "rock": {"c": {"dist": "uniform", "min": 4, "max": 8}, "phi": {"dist": "normal", "mean": 28, "sd": 2}},
    },
}  # fmt: skip


@cache
def documents() -> tuple[dict[str, Any], ...]:
    """A run and a probability of one bolted design, and the support of the same without its bolts."""
    bolted, bare = sk.load(SCATTER | {"support": {"bolts": BOLTS}}), sk.load(SCATTER)
    found = sk.analyse(bolted), sk.prob(bolted, n=200, confirm=5), sk.support(bolted), sk.support(bare)
    return tuple(json.loads(json.dumps(one.to_dict())) for one in found)


def page(*which: int) -> str:
    return report_of([documents()[k] for k in which], with_pictures=False).html


def test_notices_bolts_and_hashes_stand_once() -> None:
    text = page(0, 1, 2)
    assert text.count(">W320</strong>") == 1
    assert "Notices of 1 Result and 3 Support" in text
    assert len(re.findall(r"<caption>Schedule</caption>", text)) == 1
    assert "4 rows, the same as in 1 Result." in text
    assert "4 bolts, in the schedule" in text
    assert "bolt 60 kN" not in text
    assert text.count(documents()[0]["input_sha256"]) == 1
    assert text.count("Verification of the program") == 1


def test_alone_each_has_its_own() -> None:
    """Nothing is said to stand elsewhere where there is nothing else."""
    text = page(2)
    assert "the same as in" not in text
    assert text.count(">W320</strong>") == 1
    assert "Inputs differ" not in text


def test_inputs_that_differ_are_a_table() -> None:
    some = [documents()[k] for k in (0, 1, 3)]
    names = ["1 Result", "2 Probability", "3 Support"]
    table = inputs_table(some, names)
    assert table is not None
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["bolts"] == ("4 bolts, 240 kN in all", "4 bolts, 240 kN in all", "none")
    assert rows["strength.rock.phi"][0] == "28"
    assert rows["strength.rock.phi"][1].startswith("scatters: mean 2")
    assert rows["changed by the study"][2].startswith("bolts are proposed: ")
    assert not {"height", "unit weight of rock"} & set(rows)  # as in all
    assert not same_design(some)
    assert "Inputs differ" in page(0, 1, 3)
    other = json.loads(json.dumps(some[0]))
    other["inputs"]["height_m"] = 15.0
    changed = inputs_table([some[0], other], ["1", "2"])
    assert changed is not None
    assert changed.rows == (("height", "14 m", "15 m"),)
    assert inputs_table([some[0], some[0]], ["1", "2"]) is None


def test_benches_stand_on_one_page_with_a_design() -> None:
    """Benches are compared with benches, whose earthquake is a number; not with a design, which has other inputs."""
    joints = ["52/140", "58/150", "61/222", "66/215"]
    still, shaken = (
        json.loads(json.dumps(found.to_dict()))
        for k in (0, 0.1)
        for found in [
            sk.bench_design(joints, height=15, face=65, dip_direction=180, c=5, phi=32, n=100, confirm=0, seismic=k)
        ]
    )
    table = inputs_table([still, shaken], ["1", "2"])
    assert table is not None
    assert ("seismic coefficient", "none", "0.1 g") in table.rows
    assert inputs_table([shaken, documents()[0]], ["1", "2"]) is None
    assert "Bench design" in report_of([shaken, documents()[0]], with_pictures=False).html


def test_what_is_to_be_pasted_stands_as_it_is() -> None:
    """A design with few bolts is pasted from the page; in print it says nothing."""
    text = page(3)
    assert re.search(r'<pre class="paste">.*support:.*force', text, re.DOTALL)


@pytest.mark.parametrize("junk", [None, 3, "x", [1], {"bolts": 3}])
def test_damaged_inputs_are_a_fault_and_no_traceback(junk) -> None:
    run, prob, _, _ = documents()
    for key in ("inputs", "variables", "assumed"):
        for broken in ([run, prob | {key: junk}], [prob | {key: junk}, run]):
            codes = set[str]()
            try:
                report_of(broken, with_pictures=False)
            except sk.DesignError as error:
                codes.update(error.codes)
            assert codes <= {"E340"}


def test_the_histogram_is_drawn_and_not_listed_too(monkeypatch) -> None:
    asked = []
    monkeypatch.setattr(page_pictures, "page_picture", lambda _, what, __: asked.append(what) or "data:,")
    made = report_of(documents()[:2])
    assert "histogram" in made.pictures
    assert asked.count("stereonet") == 1  # one design has one
    assert "The stereonet of this design is that of 1 Result." in made.html
    assert ">HISTOGRAM<" not in made.html.upper()
    assert ">HISTOGRAM<" in page(1).upper()


def test_light_pictures_look_the_same() -> None:
    image = pytest.importorskip("PIL.Image")
    ramp = np.linspace(60, 250, 200, dtype=np.uint8)
    own = np.repeat(np.stack([ramp, ramp[::-1], np.full(200, 90, np.uint8)], axis=-1)[None], 120, axis=0)
    own = np.concatenate([own, np.random.default_rng(1).integers(200, 208, own.shape, dtype=np.uint8)])
    written = io.BytesIO()
    image.fromarray(own).save(written, "PNG")
    light = page_pictures.light_png(written.getvalue())
    assert len(light) < 0.7 * len(written.getvalue())
    seen = np.asarray(image.open(io.BytesIO(light)).convert("RGB"), dtype=float)
    assert np.abs(seen - own).mean() < 4.0


def test_what_acceptance_hangs_on_leads_in_studies() -> None:
    """The upper limit of a probability; the lowest factor of a mechanism."""
    found = sk.prob(sk.load(SCATTER), n=200, confirm=0, accept=0.9)
    first = re.findall(r"[\d.]+(?= %)", found.line)[0]
    assert float(first) == pytest.approx(100.0 * found.all_samples.high, rel=1e-3)
    checked = sk.check(sk.load(path_of("goodman-bray"), set={"acceptance": {"rules": ["fos.lowest >= 0.7"]}}))
    name, value = checked.result.leading
    assert name == "lowest"
    assert re.findall(r"\d\.\d{3}\b", checked.line)[0] == factor_text(value)
    (factors,) = [one for one in checked.sheet.sections if one.label == "FoS"]
    assert str(factors.entries[0]).startswith(f"{factor_text(value)} ")


def test_an_input_that_differs_is_listed_even_where_its_words_are_alike() -> None:
    """Bolts of the same number and force in other places; and water that stands in the crack is not `dry`."""
    some = documents()[0]
    other = json.loads(json.dumps(some))
    other["inputs"]["bolts"][0]["length_m"] = 7.25
    table = inputs_table([some, other, some], ["1", "2", "3"])
    assert table is not None
    assert table.rows == (
        ("bolts", "variant 1: see its inputs", "variant 2: see its inputs", "variant 1: see its inputs"),
    )
    plane = path_of("plane")
    wet, full = (
        json.loads(json.dumps(sk.run(plane, set=set_).to_dict()))
        for set_ in ({}, {"crack": {"depth": 4.35}, "water": {"mode": "full"}})
    )
    table = inputs_table([wet, full], ["1", "2"])
    assert table is not None
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["water"][0] == "in the crack only, falling to nothing at the toe"
