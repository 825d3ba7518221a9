"""The report of a result, without a browser: what stands in the page, what it refuses, what it does without extras."""

import base64
import html
import json
import re
from dataclasses import replace
from functools import cache, partial
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import slopekit as sk
from benchmarks.verification_excerpt import excerpt
from slopekit.cli import app
from slopekit.core.errors import DesignError
from slopekit.core.explanations import explanations
from slopekit.core.sheet import factor_text
from slopekit.design.templates import path_of
from slopekit.kinds.words import force_in_words
from slopekit.views.pages import page_pictures
from slopekit.views.pages import report as room
from slopekit.views.pages.page_pictures import still_pictures
from slopekit.views.pages.page_tables import input_rows, value_text
from slopekit.views.pages.report import report_of, verification_excerpt
from slopekit.views.solid.viewer_data import viewer_data
from tests.support import result_of
from tests.views import scenes

pytest.importorskip("jinja2")

ROOT = Path(__file__).parents[2]
CHEAP = ("wedge", "plane", "footing", "blocks", "goodman-bray", "cylinder")
VOID = {"meta", "link", "img", "input", "br", "line"}


def wet_wedge(**more):
    """A wedge with everything that a page shows: water, crack, bolt, earthquake, acceptance, defaults."""
    given = {
        "dips": ("45/105", "70/235"),
        "face": "65/185",
        "upper": "12/195",
        "height": 30.0,
        "c": (24.0, 48.0),
        "phi": (20.0, 30.0),
        "unit_weight": 25.0,
        "water": "50%",
        "seismic": 0.08,
        "bolts": ["800@005/10,passive"],
        "crack": "80/185@3m",
        "accept": 1.3,
    }
    return sk.wedge(**(given | more))


@cache
def document(name: str) -> dict:
    """The JSON of a template as the commands write it."""
    return json.loads(json.dumps((wet_wedge() if name == "wet" else result_of(name)).to_dict()))


@cache
def page(name: str) -> str:
    return report_of(document(name), with_pictures=False).html


def words(text: str) -> str:
    """What a reader sees of a page."""
    body = re.sub(r"<(script|style)\b.*?</\1>", " ", text, flags=re.S)
    return re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]+>", " ", body)))


class Tags(HTMLParser):
    """Every tag closed by its own, and the references of the page."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.references: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag, attrs) -> None:
        if tag not in VOID:
            self.open.append(tag)
        self.references += [
            value for name, value in attrs if name in ("src", "href", "srcset", "action", "data")
        ]
        self.ids += [value for name, value in attrs if name == "id"]

    def handle_startendtag(self, tag, attrs) -> None:
        self.ids += [value for name, value in attrs if name == "id"]

    def handle_endtag(self, tag) -> None:
        assert self.open.pop() == tag


@pytest.mark.parametrize("name", CHEAP)
def test_each_kind_makes_a_whole_page_that_loads_nothing(name) -> None:
    text, found = page(name), document(name)
    tags = Tags()
    tags.feed(text)
    assert tags.open == []
    assert len(tags.ids) == len(set(tags.ids))
    assert all(one.startswith("data:") for one in tags.references), tags.references
    assert not re.search(
        r"url\(\s*['\"]?(https?:|//)|@import|fetch\(|XMLHttpRequest|WebSocket", text
    )
    assert "default-src 'none'" in text
    seen = words(text)
    assert found["input_sha256"] in seen
    assert f"slopekit {found['slopekit']}" in seen
    for value in found["fos"].values():
        assert value is None or factor_text(value).strip() in seen
    for one in found["warnings"]:
        assert one["code"] in seen
        assert re.sub(r"\s+", " ", one["message"]) in seen
    for one in found["model"]["left_out"]:
        assert one in seen
    assert str(found["model"]["node_pairs"]) in seen
    assert "of the source" in seen  # where the whole verification is
    assert "None" not in seen.replace("None of", "")


@pytest.mark.slow
def test_the_numbers_of_a_wedge_stand_with_their_units() -> None:
    found, seen = document("wet"), words(page("wet"))
    forces, geometry = found["forces_kn"], found["geometry"]
    for joint in ("J1", "J2"):
        assert f"{forces['normal'][joint]:.0f}" in seen
        assert f"{forces['normal'][joint] / geometry['areas_m2'][joint]:.4g}" in seen
        assert f"{forces['water'][joint]:.0f}" in seen
    for text in (
        "dips 45° toward 105 (ESE)",
        "65/185",
        "crack",
        "mean σ' / kPa",
        "water / kN",
        "area / m²",
        f"weight {force_in_words(forces['weight'])}",
        "unit weight 25 kN/m³",
        "water 50 % of full pressure",
        "seismic 0.08 g",
        "bolt 800 kN toward 005/10.0, passive",
        "height 30 m",
        "fos >= 1.3 (limit ",
        "c 24.0 kPa φ 20.0°",
        "friction angle 20, 30°",
        "seismic: coefficient 0.08",
    ):
        assert text in seen, text
    assert ("acceptance MET" in seen) == found["accepted"]
    alone = " (forces alone)" if found["moments_govern"] else ""
    assert (
        f"driving, along the slide{alone} {forces['driving']:.0f} resisting {forces['resisting']:.0f}"
        in seen
    )


@pytest.mark.slow
def test_moments_that_govern_are_said_with_the_number_to_use() -> None:
    """A tall slice whose moments govern; the fields are set by hand, the words follow from them alone."""
    wet = wet_wedge()
    fos = replace(wet.fos, highest=1.9876)
    found = replace(
        wet,
        fos=fos,
        moments_govern=True,
        comparisons=replace(wet.comparisons, forces_only=1.9876, on_pressed=None),
    ).to_dict()
    seen = words(report_of(found, with_pictures=False).html)
    assert "moments govern" in seen
    assert "the methods AGREE on forces alone" in seen
    assert "(forces only 1.988)" in seen


@pytest.mark.parametrize(
    ("agree", "difference", "status", "said"),
    [
        (
            False,
            0.5,
            "slides_on_both",
            "the methods DISAGREE: use neither number before that is explained",
        ),
        (False, None, "slides_on_both", "the methods DISAGREE: use neither number"),
        (True, None, "lifted", "the methods AGREE"),
        (None, None, "slides_on_both", "no closed form to compare"),
    ],
)
def test_what_the_check_says(agree, difference, status, said) -> None:
    found = document("wedge") | {"agree": agree, "difference": difference, "status": status}
    seen = words(report_of(found, with_pictures=False).html)
    assert said in seen


def test_tables_of_many_blocks() -> None:
    found, seen = document("goodman-bray"), words(page("goodman-bray"))
    for one in found["assembly"]["table"]:
        assert f"{one['P_kn']:.2f}" in seen
        assert one["mode"] in seen
    first = found["mechanisms"][0]
    assert f"{first['interfaces'][0]['name']} {first['interfaces'][0]['joint']}" in seen
    assert "10 topple (C4 to C13), 3 slide (C1 to C3)" in seen
    assert "the modes are the same in 16 of 16 columns" in seen


def test_a_bench_without_shapes_has_its_tables() -> None:
    """A result made by hand, without a single triangle: the page stands, the view is empty."""
    design = sk.load(path_of("bench"))
    names = [f"B{k}" for k in range(1, 8)]
    first = scenes.mechanism(
        "slides", 1.25, scenes.motions(names[:3], "slides"), interfaces=scenes.interfaces(5)
    )
    second = scenes.mechanism("topples", 1.75, scenes.motions(names[3:4], "topples"))
    found = scenes.result(design, [first, second], names, fixed=names[5:]).to_dict()
    seen = words(report_of(json.loads(json.dumps(found)), with_pictures=False).html)
    for text in (
        "3 slide (B1 to B3)",
        "33.3 %",
        "S1 30/175 dips 30° toward 175 (S)",
        "spacing 3 m",
        "strengths: bedding: friction angle 42°",
        "no closed form to compare",
        "No published bench is among them",
    ):
        assert text in seen, text


def test_titles_are_texts_and_never_html() -> None:
    evil = "<script>alert(1)</script> & </title><img src=x onerror=alert(2)>"
    found = json.loads(json.dumps(document("blocks")))
    found["title"] = evil
    found["warnings"] = [{"code": "W999", "message": evil}]
    found["sheet"]["STATUS"] = [evil]
    text = report_of(found, with_pictures=False).html
    assert html.escape(evil, quote=False) in text
    assert evil in html.unescape(text)
    assert "<img src=x" not in text
    assert text.count("<script") == 2  # the data and the program of the view
    names = found["scene"]["shapes"]["names"]
    names[0] = "</script><script>alert(3)</script>"
    text = report_of(found, with_pictures=False).html
    assert text.count("</script>") == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("made", "tables"),
    # moments govern the wet one: why its SENSITIVITY is not given is a sentence
    [
        (wet_wedge, ["FORCES", "FoS"]),
        (partial(result_of, "wedge"), ["FORCES", "FoS", "SENSITIVITY"]),
    ],
)
def test_the_sheets_words_are_in_the_json_without_times(made, tables) -> None:
    result = made()
    said = result.to_dict()["sheet"]
    assert "TIME" not in said
    folded = re.sub(r"\s+", "", result.sheet.full)
    for label, entries in said.items():
        assert label.replace(" ", "") in folded
        assert all(
            re.sub(r"\s+", "", entry) in folded for entry in entries if isinstance(entry, str)
        )
    assert [label for label, entries in said.items() if isinstance(entries[0], dict)] == tables
    assert {"MODEL", "SENSITIVITY"} <= set(said)  # details too


@pytest.mark.slow
def test_map_coordinates_lose_nothing_in_the_view() -> None:
    """float32 has seven digits: half a million metres east the view must be the one at the origin."""
    near, far = (
        viewer_data(wet_wedge(origin=at).to_dict())
        for at in ((0, 0, 0), (512345.6, 5412345.6, 321.0))
    )
    for key in ("vertices", "pairs", "load_at", "joint_corners", "velocity"):
        one, two = (
            np.frombuffer(base64.b64decode(data[key]["base64"]), "<f4") for data in (near, far)
        )
        if (
            key == "vertices"
        ):  # those of the wedge come first; the rock about it may be cut into other triangles
            one, two = one[:18], two[:18]
        np.testing.assert_allclose(one, two, atol=2e-6 * near["size_m"])
    np.testing.assert_allclose(
        np.subtract(far["middle_m"], near["middle_m"]), (512345.6, 5412345.6, 321.0), atol=1e-6
    )


def test_edges_and_motions_of_the_view() -> None:
    """A tetrahedron has six edges, a box twelve (each column is one); the mechanism moves nothing of the bedrock."""
    wedge = viewer_data(document("wedge"))
    owner = np.frombuffer(base64.b64decode(wedge["triangle_block"]["base64"]), "<i4")
    triangles = np.frombuffer(base64.b64decode(wedge["triangles"]["base64"]), "<i4").reshape(-1, 3)
    edges = np.frombuffer(base64.b64decode(wedge["edges"]["base64"]), "<i4").reshape(-1, 2)
    assert np.isin(edges[:, 0], triangles[owner == 0]).sum() == 6
    columns = viewer_data(document("goodman-bray"))
    triangles = np.frombuffer(base64.b64decode(columns["triangles"]["base64"]), "<i4").reshape(
        -1, 3
    )
    owner = np.frombuffer(base64.b64decode(columns["triangle_block"]["base64"]), "<i4")
    edges = np.frombuffer(base64.b64decode(columns["edges"]["base64"]), "<i4").reshape(-1, 2)
    for block in range(16):
        assert np.isin(edges[:, 0], triangles[owner == block]).sum() == 12
    velocity = np.frombuffer(base64.b64decode(columns["velocity"]["base64"]), "<f4").reshape(-1, 6)
    assert not velocity[np.array(columns["fixed"], dtype=bool)].any()
    assert velocity[:13].any(axis=1).all()


def test_without_a_sheet_there_is_no_page_without_a_scene_no_view() -> None:
    with pytest.raises(DesignError, match="a result without its sheet") as caught:
        report_of(
            {key: value for key, value in document("wet").items() if key != "sheet"},
            with_pictures=False,
        )
    assert caught.value.codes == ("E340",)
    made = report_of(document("wet") | {"scene": {"shapes": 3}}, with_pictures=False)
    assert [notice.code for notice in made.notices] == ["W372"]
    assert 'id="view-data"' not in made.html
    made = report_of(
        {key: value for key, value in document("wet").items() if key != "scene"},
        with_pictures=False,
    )
    assert [notice.code for notice in made.notices] == ["W372"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "junk"), [("wedge", (None, "x", [3], "gone")), ("goodman-bray", ({"x": 1}, [None]))]
)
def test_damage_never_gives_a_traceback(name, junk, monkeypatch) -> None:
    """Each key taken away, or replaced by something else: a page or a fault with a code."""
    whole = document(name)
    codes = set[str]()

    def tried(broken) -> None:
        try:
            report_of(broken, with_pictures=False)
        except DesignError as error:
            codes.update(error.codes)

    for key in ("kind", "scene"):
        for one in junk:
            tried(whole | {key: one})
    monkeypatch.setattr(room, "viewer_data", lambda document: {})
    for key in whole:
        for one in junk:
            tried(
                {other: value for other, value in whole.items() if other != key}
                | ({} if one == "gone" else {key: one})
            )
    for group in ("fos", "inputs", "forces_kn", "model", "geometry", "assembly"):
        for key in whole[group] or ():
            for one in junk[:2]:
                tried(whole | {group: whole[group] | {key: one}})
    assert {"E340"} <= codes <= {"E340"}


def test_what_has_neither_result_nor_sheet_is_refused_by_name() -> None:
    for study, said in (
        ({"slopekit": "0.1.0", "study": "sweep"}, "a study \\(sweep\\) without its sheet"),
        ({"slopekit": "0.1.0", "kind": "wedge"}, "another document"),
    ):
        with pytest.raises(DesignError, match=said) as caught:
            report_of(study)
        assert caught.value.codes == ("E340",)
    whole = swept()
    for key in ("study", "line", "warnings"):
        with pytest.raises(DesignError) as caught:
            report_of(
                {name: value for name, value in whole.items() if name != key}, with_pictures=False
            )
        assert caught.value.codes == ("E340",)


@cache
def swept() -> dict:
    """The JSON of a sweep."""
    return json.loads(
        json.dumps(sk.sweep(sk.load(path_of("wedge")), {"slope.face.dip": [60, 70]}).to_dict())
    )


def test_a_study_has_a_page_with_the_numbers_of_its_sheet() -> None:
    found = swept()
    seen = words(report_of(found, with_pictures=False).html)
    assert found["line"].replace("  ", " · ") in seen
    (table,) = found["sheet"]["CURVE"]
    for row in table["shown"]:
        assert " ".join(cell for cell in row if cell) in seen
    assert [row[3] for row in table["rows"]] == [point["limit"] for point in found["points"]]


def test_several_documents_have_contents_and_a_view_each_and_say_whose_they_are() -> None:
    first = document("wet") | {"project": {"name": "Route 7", "client": "A & Co"}}
    text = report_of(
        [first, swept(), document("wedge")], with_pictures=False, project={"client": "B & Co"}
    ).html
    tags = Tags()
    tags.feed(text)
    assert tags.open == []
    assert len(tags.ids) == len(set(tags.ids))
    assert [one for one in tags.references if one.startswith("#")] == [
        "#part-1",
        "#part-2",
        "#part-3",
    ]
    assert re.findall(r'id="(view-data[^"]*)"', text) == ["view-data", "view-data-2"]
    assert text.count("<canvas") == 1
    seen = words(text)
    assert "Route 7" in seen
    assert "client B & Co" in seen
    assert "A & Co" not in seen
    with pytest.raises(DesignError) as caught:
        report_of(first, project={"cleint": "C"})
    assert caught.value.codes == ("E142",)


def test_the_factor_at_the_top_is_never_more_than_it_is_and_notices_raise_a_badge() -> None:
    found = document("wedge") | {"warnings": []}
    found["fos"] = found["fos"] | {"limit": 1.49996}
    text = report_of(found, with_pictures=False).html
    assert '<div class="fos">1.49<small>factor of safety 1.500' in text
    assert "1 notice" not in text
    found["warnings"].append({"code": "W317", "message": "not settled"})
    assert "1 notice" in report_of(found, with_pictures=False).html


def test_without_jinja_the_extra_is_named(monkeypatch) -> None:
    monkeypatch.setattr("slopekit.core.extras.find_spec", lambda name: None)
    with pytest.raises(DesignError, match=r"\[report\]") as caught:
        report_of(document("wedge"))
    assert caught.value.codes == ("E140",)


def test_without_the_extra_plot_the_page_names_what_is_missing(monkeypatch) -> None:
    def refuse(found, what, options):
        raise DesignError([sk.Fault("E140", "drawing needs the extra plot (pyvista)")])

    monkeypatch.setattr(page_pictures, "page_picture", refuse)
    pictures, missing = still_pictures(document("wedge"))
    assert pictures == []
    assert missing == [
        "scene, stereonet, tractions, mechanism: E140 drawing needs the extra plot (pyvista)"
    ]
    made = report_of(document("wedge"))
    assert "Not drawn: scene, stereonet" in words(made.html)
    assert "view-data" in made.html


def test_pictures_stand_in_the_page() -> None:
    pytest.importorskip("matplotlib")
    made = report_of({key: value for key, value in document("wedge").items() if key != "scene"})
    assert made.pictures == ("stereonet",)
    assert 'src="data:image/svg+xml;base64,' in made.html


def test_the_excerpt_is_of_the_verification_page() -> None:
    whole = json.loads((ROOT / "docs" / "verification.json").read_text(encoding="utf-8"))
    assert verification_excerpt() == excerpt(whole), (
        "python -m benchmarks.verification_excerpt docs/verification.json"
    )


def test_inputs_of_many_values_are_counted() -> None:
    assert value_text("heights_m", [1.5] * 30).endswith("... and 6 more (in the JSON) m")
    rows = input_rows(document("blocks")["inputs"])
    assert (
        "blocks B1",
        "polygon (0.000, 0.000), (0.000, 5.000), (-5.000, 5.000) m; fixed no",
    ) in rows
    assert ("interfaces", "(B1, B2, smooth)") in rows


@pytest.fixture
def run(capsys, monkeypatch):
    """A command in this process: exit code, stdout, stderr."""

    def command(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["slopekit", *arguments])
        from slopekit.cli import main

        with pytest.raises(SystemExit) as left:
            main()
        out, err = capsys.readouterr()
        return int(left.value.code or 0), out, err

    assert app is not None
    return command


def test_the_command(run, tmp_path) -> None:
    path = tmp_path / "result.json"
    path.write_text(json.dumps(document("wedge")), encoding="utf-8")
    code, out, err = run("report", str(tmp_path), "--no-pictures")
    assert (code, err) == (0, "")
    assert out.startswith(f"wrote {tmp_path / 'report.html'} (")
    code, out, _ = run(
        "report", str(path), "-o", str(tmp_path / "new" / "a.html"), "--no-pictures", "--json"
    )
    assert code == 0
    assert json.loads(out)["bytes"] == (tmp_path / "new" / "a.html").stat().st_size < 1_000_000
    code, out, err = run("report", str(path), "-o", str(tmp_path / "a.pdf"))
    assert (code, out) == (2, "")
    assert err.startswith("E141")
    code, out, err = run("report", str(tmp_path / "none.json"))
    assert (code, out) == (2, "")
    assert err.startswith("E147")
    for content, wanted in (
        ("slopekit: 1", "E340"),
        ("[]", "E340"),
        ('{"slopekit": "0.1.0", "kind": "wedge"}', "E340"),
    ):
        path.write_text(content, encoding="utf-8")
        code, out, err = run("report", str(path), "-o", str(tmp_path / "b.html"))
        assert (code, out, err[:4]) == (2, "", wanted)
        assert not (tmp_path / "b.html").exists()


class Study:
    """What a sweep is to the report: something with a document of its own."""

    def to_dict(self) -> dict:
        return {"slopekit": "0.1.0", "study": "sweep"}


@pytest.mark.slow
def test_from_python(tmp_path) -> None:
    result = wet_wedge()
    one = sk.report(result, tmp_path / "a.html", pictures=False)
    two = sk.report(result.to_dict(), tmp_path, pictures=False)
    assert (one.name, two.name) == ("a.html", "report.html")
    assert one.read_text(encoding="utf-8") == two.read_text(encoding="utf-8")
    (tmp_path / "result.json").write_text(json.dumps(result.to_dict()), encoding="utf-8")
    assert (
        sk.report(tmp_path / "result.json", tmp_path / "c.html", pictures=False).read_bytes()
        == one.read_bytes()
    )
    assert sk.report(tmp_path, tmp_path / "e.html", pictures=False).read_bytes() == one.read_bytes()
    with pytest.raises(DesignError) as caught:
        sk.report(Study(), tmp_path / "d.html")
    assert caught.value.codes == ("E340",)
    with pytest.raises(DesignError) as caught:
        sk.report({"x": 1}, tmp_path / "d.html")
    assert caught.value.codes == ("E340",)


@pytest.mark.parametrize("code", ["E340", "E141", "W372"])
def test_every_code_is_explained(code) -> None:
    assert len(explanations()[code]) > 40


@pytest.mark.parametrize(
    "fault", [lambda: {}.itmes(), lambda: re.serach("a", "b")], ids=["dict", "module"]
)
def test_a_fault_of_the_program_is_not_put_on_the_file(fault, monkeypatch) -> None:
    """An attribute that nothing has is a bug of ours: it goes through (exit code 5), where E340 blamed the user."""
    monkeypatch.setattr(room, "answer", lambda document, status: fault())
    with pytest.raises(AttributeError):
        report_of(document("wedge"), with_pictures=False)
    monkeypatch.setattr(room, "answer", lambda document, status: document["title"].items())
    with pytest.raises(DesignError, match="E340"):
        report_of(document("wedge"), with_pictures=False)
