"""The charts: what they refuse, and what their legends and lines say."""

import pytest

from benchmarks import charts
from benchmarks.charts import Curve, speed_error_chart, sweep_chart
from slopekit.core.errors import DesignError

pytest.importorskip("matplotlib")
from matplotlib.figure import Figure


@pytest.fixture
def drawn(monkeypatch) -> list[Figure]:
    """The figures that were saved."""
    figures = []
    save = Figure.savefig

    def kept(figure: Figure, path: object, **more: object) -> None:
        figures.append(figure)
        save(figure, path, **more)

    monkeypatch.setattr(Figure, "savefig", kept)
    return figures


@pytest.mark.parametrize(
    "curves",
    [
        [],
        [Curve("a", [], [])],
        [Curve("a", [], []), Curve("b", [], [])],
        [Curve("a", [float("nan")], [0.1])],
        [Curve("a", [0.0], [0.1])],
    ],
    ids=["none", "empty", "two empty", "nan", "nothing above 0"],
)
@pytest.mark.parametrize(
    "chart",
    [speed_error_chart, lambda *what: sweep_chart(*what, "x", tolerance=1e-9)],
    ids=["speed", "sweep"],
)
@pytest.mark.filterwarnings("error")
def test_nothing_to_draw_is_refused(curves, chart, tmp_path) -> None:
    """E273 and no file, instead of an empty picture and warnings of a logarithmic axis without data."""
    path = tmp_path / "empty.png"
    with pytest.raises(DesignError, match="there is nothing to draw: ") as caught:
        chart(curves, path, "title")
    assert caught.value.codes == ("E273",)
    assert not path.exists()


@pytest.mark.slow
def test_an_empty_curve_beside_others_is_left_out(drawn, tmp_path) -> None:
    speed_error_chart(
        [Curve("a", [], []), Curve("b", [1.0, 2.0], [1e-3, 1e-6])], tmp_path / "b.png", "title"
    )
    assert legend(drawn[0]) == ["b"]


def test_a_parameter_may_be_zero_on_a_plain_axis(drawn, tmp_path) -> None:
    sweep_chart([Curve("a", [0.0], [1e-3])], tmp_path / "a.png", "title", "x", logarithmic=False)
    assert drawn[0].axes[0].get_xscale() == "linear"


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_what_the_picture_says_of_itself(drawn, tmp_path) -> None:
    """Each tolerance with its number and its curves, open markers and crosses in the legend, errors by their name."""
    curves = [
        Curve("wedge", [1.0, 2.0, 3.0], [0.0, 1e-12, 1e-13], crossed=[False, True, False]),
        Curve("block", [1.0, 2.0], [1e-7, 1e-8]),
    ]
    sweep_chart(
        curves,
        tmp_path / "a.png",
        "title",
        "x",
        errors="of the volume",
        crosses="forces alone",
        tolerances=[(1e-9, "wedge"), (1e-5, "block")],
    )
    axes = drawn[0].axes[0]
    assert legend(drawn[0]) == ["wedge", "block", "forces alone", "open: no error to 16 digits"]
    assert [text.get_text() for text in axes.texts] == [
        "tolerance 1e-9: wedge",
        "tolerance 1e-5: block",
    ]
    assert axes.get_ylabel() == "relative error of the volume"
    assert [
        line.get_xdata()[0]
        for line in axes.lines
        if line.get_marker() == "x" and len(line.get_xdata())
    ] == [2.0]


@pytest.mark.slow
def test_a_tolerance_alone_and_no_entry_for_what_is_not_there(drawn, tmp_path) -> None:
    sweep_chart(
        [Curve("a", [1.0], [1e-12])], tmp_path / "a.png", "title", "x", tolerance=1e-9, crosses="c"
    )
    assert [text.get_text() for text in drawn[0].axes[0].texts] == ["tolerance 1e-9"]
    assert legend(drawn[0]) == ["a"]
    assert drawn[0].axes[0].get_ylabel() == "relative error of the factor of safety"


@pytest.mark.parametrize(
    ("letters", "columns"), [([5] * 3, 3), ([40] * 6, 2), ([200], 1), ([], 1), ([60] * 4, 1)]
)
def test_the_legend_takes_as_few_lines_as_fit(letters, columns) -> None:
    assert charts._columns(letters) == columns
