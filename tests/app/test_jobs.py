"""Jobs: what comes of them is what the studies give; cancel ends the process that works, whatever it does."""

import asyncio
import threading

import pytest

from slopekit.app.desk import jobs_of
from slopekit.app.jobs import JOBS, Jobs, run_job
from slopekit.app.session import Session, opened_template
from slopekit.core.errors import DesignError
from slopekit.design.reading.files import with_values
from slopekit.design.registry import KINDS
from slopekit.kinds import factors_of
from slopekit.studies.prob import prob
from slopekit.studies.support import support
from tests.app.pages import Page, desk_of

DIP = "joints.J1.plane.dip"


def silent(done, total, words):
    """Nobody looks on."""


def test_a_curve_is_both_methods_at_each_value():
    moment, told = Session(opened_template("wedge")).moment, []
    found = run_job(
        "curve",
        moment,
        {"path": DIP, "low": 10, "high": 50, "points": 5},
        lambda *said: told.append(said),
    )
    assert found["x"] == [10.0, 20.0, 30.0, 40.0, 50.0]
    assert (found["now"], found["label"], found["unit"]) == (45.0, "dip of J1", "°")
    for value, limit, closed, status in zip(
        found["x"], found["limit"], found["closed_form"], found["status"], strict=True
    ):
        if limit is None:
            assert status == "E205"
            continue
        own = factors_of(with_values(moment.design, {DIP: value}))
        assert (limit, closed, status) == (own.limit, own.closed_form, own.status)
    assert told[0] == (0, 5, "points")
    assert told[-1] == (5, 5, "points")


def test_a_curve_goes_by_default_where_the_slider_goes():
    found = run_job(
        "curve",
        Session(opened_template("footing")).moment,
        {"path": "weak_plane.pairs", "points": 6},
        silent,
    )
    assert all(value == int(value) for value in found["x"])  # of what counts whole numbers
    found = run_job(
        "curve",
        Session(opened_template("wedge")).moment,
        {"path": "water.fill", "points": 3},
        silent,
    )
    assert found["x"] == [0.0, 0.5, 1.0]


def test_a_probability_is_that_of_the_study_with_the_scatter_put_in():
    moment = Session(opened_template("wedge")).moment
    scatter = {
        "strength.weak.phi": {"dist": "normal", "sd": 5},
        "strength.weak.c": {"dist": "uniform", "min": 0, "max": 20},
    }
    found = run_job("probability", moment, {"samples": 500, "seed": 4, "scatter": scatter}, silent)
    own = prob(
        with_values(
            moment.design,
            {
                "strength.weak.phi": {"dist": "normal", "mean": 20, "sd": 5},
                "strength.weak.c": {"dist": "uniform", "min": 0, "max": 20},
            },
        ),
        500,
        seed=4,
    )
    assert (found["pf"], found["low"], found["high"]) == (
        own.all_samples.share,
        own.all_samples.low,
        own.all_samples.high,
    )
    assert found["pf_closed_form"] == own.by_closed_form.share
    assert not {"pf_of", "confirm"} & set(found)
    assert 0.0 < found["pf"] < 0.5
    assert found["histogram"]["limit"] == own.to_dict()["histogram"]["counts"]
    assert len(found["histogram"]["edges"]) == len(found["histogram"]["limit"]) + 1


@pytest.mark.slow
def test_a_scatter_of_the_design_can_be_taken_out():
    moment = Session(opened_template("wedge-scatter")).moment
    given = dict.fromkeys(("strength.clay.phi.mean", "strength.clay.c"))
    found = run_job("probability", moment, {"samples": 200, "scatter": given}, silent)
    names = [one["label"] for one in found["sensitivity"]]
    assert not any("clay" in name for name in names)
    assert any("rough" in name for name in names)
    means = with_values(
        moment.design, {"strength.clay.phi": 24.0, "strength.clay.c": 15.0}
    )  # as the template has them
    assert found["pf"] == prob(means, 200).all_samples.share
    assert found["histogram"]["edges"] == prob(means, 200).to_dict()["histogram"]["edges"]


@pytest.mark.slow
def test_bolts_are_those_of_the_study():
    moment = Session(opened_template("wedge")).moment
    found = run_job("support", moment, {"fos": 1.6}, silent)
    own = support(moment.design, 1.6, acts="active").cases[0]
    assert found["force"] == own.force
    assert found["direction"] == {"trend": own.toward.trend_deg, "plunge": own.toward.plunge_deg}
    assert found["bolts"] == own.support["bolts"]
    assert found["reached"]
    assert any("closed form" in line for line in found["words"])


@pytest.mark.parametrize(
    ("what", "options"),
    [
        ("rm", {}),
        ("curve", {}),
        ("curve", {"path": DIP, "points": 1}),
        ("curve", {"path": DIP, "points": 10**9}),
        ("curve", {"path": DIP, "low": 5, "high": 4}),
        ("curve", {"path": DIP, "low": "x"}),
        ("probability", {"samples": 10**9}),
        ("probability", {"scatter": [1]}),
        ("probability", {"samples": True}),
        ("probability", {"scatter": {DIP: {"dist": "normal", "evil": 1}}}),
        ("support", {"fos": "x"}),
    ],
)
def test_options_that_are_none_are_refused(what, options):
    with pytest.raises(DesignError) as error:
        run_job(what, Session(opened_template("wedge")).moment, options, silent)
    assert error.value.codes == ("E541",)


@pytest.mark.parametrize(
    ("what", "options", "code"),
    [
        ("curve", {"path": "a.b"}, "E310"),
        ("probability", {"samples": 100}, "E302"),
        ("probability", {"scatter": {DIP: {"dist": "normal", "sd": -1}}}, "E186"),
        ("support", {"acts": "x"}, "E307"),
    ],
)
def test_what_studies_refuse_is_said_by_their_codes(what, options, code):
    with pytest.raises(DesignError) as error:
        run_job(what, Session(opened_template("wedge")).moment, options, silent)
    assert code in error.value.codes


def test_every_kind_can_start_what_there_is_for_it():
    for kind in KINDS:
        assert set(jobs_of(kind)) <= set(JOBS)
        assert ("support" in jobs_of(kind)) == (kind in ("wedge", "plane"))


# -- the process ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_job_is_done_over_there_cancel_ends_it_and_the_next_one_works(tmp_path):
    """A bench of a second: ended while it works, its process is gone; the answer of another stands on the page."""
    desk = desk_of(tmp_path, "bench")

    async def scene():
        async with Page(desk) as page:
            first = (await page.begin())[-1]
            assert (first["lead"], first["stale"]) == (None, True)
            job = (await page.ask(do="start", job="analyse"))["job"]
            process = desk.jobs.process
            busy = await page.ask(do="start", job="analyse")
            assert (await page.hear())["of"] == "progress"  # it is at work
            number = page.send(do="cancel", job=job)
            ended, cancelled = None, None
            while ended is None or cancelled is None:
                said = await page.hear()
                ended = said if said["of"] == "done" else ended
                cancelled = said if said.get("id") == number else cancelled
            assert not process.is_alive()
            curve = (await page.ask(do="start", job="curve", path="slope.height", points=200))[
                "job"
            ]
            await page.ask(do="cancel", job=curve)
            while True:  # one that is ended at once is ended too
                said = await page.hear() if not page.events else page.events.pop()
                if said.get("job") == curve and said["of"] == "done":
                    break
            await page.ask(do="open", template="footing")
            small = (await page.ask(do="start", job="analyse"))["job"]
            done = await page.end_of_job()
            return busy, ended, small, done

    busy, ended, small, done = asyncio.run(scene())
    assert busy["faults"][0]["code"] == "E544"
    assert ended["cancelled"] is True
    assert "result" not in ended
    assert (done["job"], done["result"]["lead"]) == (small, "1.184")
    assert done["result"]["stale"] is False
    process = desk.jobs.process
    desk.close()
    assert not process.is_alive()
    assert list(tmp_path.iterdir()) == []


def test_a_process_that_dies_is_said_and_not_waited_for():
    jobs, heard, ended = Jobs(), [], threading.Event()

    def hear(event):
        heard.append(event)
        if event["of"] == "done":
            ended.set()

    jobs.start(
        "curve", Session(opened_template("wedge")).moment, {"path": DIP, "points": 400}, hear
    )
    jobs.process.kill()
    assert ended.wait(30)
    assert heard[-1]["faults"][0]["code"] == "E544"
    assert jobs.running == 0
    with pytest.raises(DesignError, match="E544"):
        jobs.cancel(1)
    jobs.close()
