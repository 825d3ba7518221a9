"""Several documents on one page: bolts in the schedule, damaged ones, pictures."""

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
from slopekit.views.pages.report import report_of
from tests.bolted import WEDGE, bolt

pytest.importorskip("jinja2")
BOLTS = [bolt(east, 8.0, 60.0, "active") for east in (-2.0, -1.0, 0.0, 1.0)]
SCATTER: dict[str, Any] = WEDGE | {
    "strength": {
        "rock": {
            "c": {"dist": "uniform", "min": 4, "max": 8},
            "phi": {"dist": "normal", "mean": 28, "sd": 2},
        },
    },
}


@cache
def documents() -> tuple[dict[str, Any], ...]:
    """A run and a probability of one bolted design, and the support of the same without its bolts."""
    bolted, bare = sk.load(SCATTER | {"support": {"bolts": BOLTS}}), sk.load(SCATTER)
    found = sk.analyse(bolted), sk.prob(bolted, n=200), sk.support(bolted), sk.support(bare)
    return tuple(json.loads(json.dumps(one.to_dict())) for one in found)


def page(*which: int) -> str:
    return report_of([documents()[k] for k in which], with_pictures=False).html


@pytest.mark.slow
def test_bolts_stand_in_the_schedule_and_hashes_once() -> None:
    text = page(0, 1, 2)
    assert text.count(">W320</strong>") >= 1
    assert 'of-bolts"' in text
    assert text.count("Verification of the program") == 1
    assert documents()[0]["input_sha256"] in text


def test_benches_stand_on_one_page_with_a_design() -> None:
    joints = ["52/140", "58/150", "61/222", "66/215"]
    found = sk.bench_design(joints, height=15, face=65, dip_direction=180, c=5, phi=32, n=100)
    bench = json.loads(json.dumps(found.to_dict()))
    assert "Bench design" in report_of([bench, documents()[0]], with_pictures=False).html


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


def test_the_histogram_is_drawn(monkeypatch) -> None:
    asked = []
    monkeypatch.setattr(
        page_pictures, "page_picture", lambda _, what, __: asked.append(what) or "data:,"
    )
    made = report_of(documents()[:2])
    assert "histogram" in made.pictures


def test_light_pictures_look_the_same() -> None:
    image = pytest.importorskip("PIL.Image")
    ramp = np.linspace(60, 250, 200, dtype=np.uint8)
    own = np.repeat(
        np.stack([ramp, ramp[::-1], np.full(200, 90, np.uint8)], axis=-1)[None], 120, axis=0
    )
    own = np.concatenate(
        [own, np.random.default_rng(1).integers(200, 208, own.shape, dtype=np.uint8)]
    )
    written = io.BytesIO()
    image.fromarray(own).save(written, "PNG")
    light = page_pictures.light_png(written.getvalue())
    assert len(light) < 0.7 * len(written.getvalue())
    seen = np.asarray(image.open(io.BytesIO(light)).convert("RGB"), dtype=float)
    assert np.abs(seen - own).mean() < 4.0


@pytest.mark.slow
def test_what_acceptance_hangs_on_leads_in_studies() -> None:
    """The upper limit of a probability; the lowest factor of a mechanism."""
    found = sk.prob(sk.load(SCATTER), n=200, by="closed-form", accept=0.9)
    first = re.findall(r"[\d.]+(?= %)", found.line)[0]
    assert first == f"{100.0 * found.all_samples.high:.3g}"
    checked = sk.check(
        sk.load(path_of("goodman-bray"), set={"acceptance": {"rules": ["fos.lowest >= 0.7"]}})
    )
    name, value = checked.result.leading
    assert name == "lowest"
    assert re.findall(r"\d\.\d{3}\b", checked.line)[0] == factor_text(value)
    (first_row,) = [line for line in str(checked).splitlines() if line.startswith("FoS ")]
    assert first_row.split()[1] == factor_text(value)
