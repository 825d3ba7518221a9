"""Readers of records: columns, AT2, folders, pulses; what is wrong with a file is said with its line."""

import numpy as np
import pytest

import slopekit as sk
from slopekit.studies.quake.records import GRAVITY, read_record, read_records, record_of

TIMES = np.arange(200) * 0.02
VALUES = 0.3 * np.sin(2.0 * np.pi * 1.5 * TIMES) * np.exp(-(((TIMES - 1.5) / 0.8) ** 2))  # g
AT2 = "PEER NGA STRONG MOTION DATABASE RECORD\nMade, 1/1/2000, North, 000\n{head}\n{points}\n{values}\n"


def _columns(head: str, values=VALUES, mark: str = ",", point: str = ".") -> str:
    rows = [f"{t:.4f}{mark}{a:.9f}".replace(".", point) for t, a in zip(TIMES, values, strict=True)]
    return "\n".join([*([head] if head else []), *rows]) + "\n"


def _at2(
    head="ACCELERATION TIME SERIES IN UNITS OF G",
    points="NPTS=   200, DT=   .0200 SEC",
    values=VALUES,
) -> str:
    words = [f"{value: .7E}" for value in values]
    lines = "\n".join("  ".join(words[k : k + 5]) for k in range(0, len(words), 5))
    return AT2.format(head=head, points=points, values=lines)


@pytest.mark.parametrize(
    "text",
    [
        _columns("time (s),acceleration (g)"),
        _columns("t;a [m/s²]", VALUES * GRAVITY, ";"),
        _columns("Time\tAcc (cm/s^2)", VALUES * GRAVITY * 100.0, "\t"),
        _columns("t;acc_gal", VALUES * GRAVITY * 100, ";", ","),
        "# station A\n" + _columns("time acc_gal", VALUES * GRAVITY * 100.0, " "),
        "\ufeff" + _columns("time,acc [g]").replace("\n", "\r\n"),
        _at2(),
        _at2(points="200 0.02 NPTS, DT"),
        _at2(head="ACCELERATION TIME HISTORY IN UNITS OF CM/S2", values=VALUES * GRAVITY * 100.0),
        "Station Gal, north\n" + _columns("t,acc in m/s^2", VALUES * GRAVITY),
    ],
)
def test_one_motion_in_many_files(tmp_path, text) -> None:
    path = tmp_path / "motion.txt"
    path.write_text(text, encoding="utf-8")
    record = read_record(path)
    np.testing.assert_allclose(record.times_s, TIMES, atol=1e-9)
    np.testing.assert_allclose(
        record.accelerations, VALUES * GRAVITY, atol=2e-8 * GRAVITY
    )  # digits written
    assert record.notices == ()


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        ("", "E512", "is empty"),
        (_columns(""), "E511", "nothing says the unit"),
        (_columns("time (s),acceleration (furlong)"), "E511", "nothing says the unit"),
        (
            _columns("time (s),acceleration (g)").replace("0.1000,", "0.0800,"),
            "E514",
            "from sample 5 (0.08 s) to",
        ),
        (
            _columns("time (s),acceleration (g)").replace("0.1000,", "0.1000,x"),
            "E512",
            "line 7 holds 'x",
        ),
        (
            _columns("time (s),acceleration (g)").replace("0.1000,", "0.1000,1,"),
            "E512",
            "line 7 has 3 columns",
        ),
        (_columns("time (s),acceleration (g)").replace("0.1000,", "nan,"), "E512", "line 7"),
        (
            _columns("time (s),acceleration (g)").replace("0.0000,", "0.0000,O", 1),
            "E512",
            "line 2 holds 'O",
        ),
        (
            _columns("time (s),acceleration (g)").replace("0.0000,", "nan,", 1),
            "E512",
            "line 2 holds 'nan",
        ),
        (_columns("time (s),acceleration (g)", 0.0 * VALUES), "E512", "nothing but zeros"),
        ("time (s),acceleration (g)\n0,0.1\n", "E512", "1 sample"),
        ("one,two\nthree,four\n", "E512", "no line holds numbers alone"),
        ("a,b,c (g)\n" + "1,2,3\n2,3,4\n", "E512", "line 2 has 3 columns, two are needed"),
        (
            _columns("time (s),acceleration (g)", VALUES * GRAVITY * 100.0),
            "E511",
            "more than any earthquake's",
        ),
        (_at2(points="NPTS=   201, DT=   .0200 SEC"), "E512", "NPTS is 201, 200 values follow"),
        (_at2(points="NPTS=   200, DT=   .0000 SEC"), "E512", "a time step above 0"),
        (_at2(head="VELOCITY TIME SERIES IN UNITS OF CM/S"), "E512", "no record of acceleration"),
        (_at2(head="ACCELERATION TIME SERIES"), "E511", "IN UNITS OF G"),
        (_at2().replace("E-0", "x", 1), "E512", "line 5"),
        (
            _columns("time (s),acceleration (g)") + "END OF FILE\n",
            "E512",
            "line 202 has 3 columns,",
        ),
        (_columns("t;a (g)", mark=";") + "\nEnd, of file\n", "E512", "line 203 has 3 columns,"),
        (_columns("period (s),Sa (g)"), "E512", "period in the head"),
        (_columns("freq (Hz),acc (g)"), "E512", "freq in the head"),
        (_columns("time (s),velocity (m/s)"), "E512", "velocity in the head"),
        (_columns("time (s),spectral acceleration (g)"), "E512", "spectral in the head"),
        (_columns("time (s),acc (g) in m/s2"), "E511", "nothing says the unit"),
        (_at2(points="NPTS=   200, DT= fast SEC"), "E512", "line 4 holds 'NPTS="),
        ("acc (g)\n0.1\n0.2\n", "E512", "line 2 has 1 column,"),
        ("Station G, component N\n" + _columns("time,acc"), "E511", "nothing says the unit"),
        ("Gal valley\n" + _columns("time,acc"), "E511", "nothing says the unit"),
        (
            _columns("time (s),acceleration (g)").replace("0.0000,", "0.0000,x", 1),
            "E512",
            "line 2 holds 'x",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path, text, code, said) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(sk.DesignError) as caught:
        read_record(path)
    assert caught.value.faults[0].code == code
    assert said in str(caught.value)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "latin-1"])
def test_files_in_other_encodings(tmp_path, encoding) -> None:
    path = tmp_path / "motion.csv"
    path.write_text(
        _columns("Zeit (s);Beschleunigung (m/s²)", VALUES * GRAVITY, ";", ","), encoding=encoding
    )
    assert read_record(path).pga_g == pytest.approx(np.abs(VALUES).max(), rel=1e-7)


def test_the_unit_may_be_given(tmp_path) -> None:
    path = tmp_path / "bare.csv"
    path.write_text(_columns("", VALUES * GRAVITY * 100.0), encoding="utf-8")
    assert read_record(path, "gal").pga_g == pytest.approx(np.abs(VALUES).max(), rel=1e-8)
    with pytest.raises(sk.DesignError, match="E511"):
        read_record(path, "feet")
    with pytest.raises(sk.DesignError, match="E511"):  # though the pulse names its own
        read_records(["sine:0.5g,1Hz"], "feet")


@pytest.mark.parametrize(
    ("step", "samples", "refused"),
    [
        (20.0, 200, True),
        (5.0, 21, True),
        (1.01, 4000, True),
        (1.0, 4000, True),
        (0.5, 40_000, True),  # ms, of 2 kHz last
        (1.0, 600, False),
        (0.001, 600_001, False),
        (2.0, 5, False),
        (0.02, 100_000, False),  # 1 Hz, 1 kHz, ten minutes
    ],
)
def test_times_in_milliseconds_under_a_head_of_seconds_are_refused(
    tmp_path, step, samples, refused
) -> None:
    """Displacements of 181 km came of them; what instruments write and what is drawn by hand is read as it is."""
    values = 0.1 * np.sin(np.arange(samples))
    if not refused:
        assert record_of(
            "made", step * np.arange(samples), values, "g"
        ).duration_s == pytest.approx(step * (samples - 1))
        return
    path = tmp_path / "north.csv"
    lines = "".join(f"{step * k:.6g},{value:.6f}\n" for k, value in enumerate(values))
    path.write_text(f"time (s),acceleration (g)\n{lines}", encoding="utf-8")
    with pytest.raises(
        sk.DesignError, match=f"E514 north.csv: the time step is {step:g} s and it lasts"
    ) as error:
        read_record(path)
    assert error.value.faults[0].advice.startswith(
        f"Times in ms are written in s, {step * 1e-3:g} s apart; numbers of"
    )


def test_a_file_whose_name_is_like_a_pulse_is_a_file(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "half-sine").write_text(_columns("t,a (g)"), encoding="utf-8")
    assert not read_record("half-sine").is_pulse
    with pytest.raises(sk.DesignError, match="E147"):
        read_record("half-sine.csv")
    with pytest.raises(sk.DesignError, match="E510 a record without a name"):
        read_records([""])


def test_a_name_longer_than_disks_take_is_a_fault_too() -> None:
    with pytest.raises(sk.DesignError) as caught:
        read_records(["x" * 300, "sine:" + "y" * 300])
    assert caught.value.codes == ("E148", "E517")


def test_a_folder_is_read_and_every_bad_file_is_said(tmp_path) -> None:
    folder = tmp_path / "records"
    folder.mkdir()
    with pytest.raises(sk.DesignError, match="E510"):
        read_records([folder])
    (folder / "a.csv").write_text(_columns("t,a (g)"), encoding="utf-8")
    (folder / "b.AT2").write_text(_at2(), encoding="utf-8")
    (folder / "notes.md").write_text("not a record", encoding="utf-8")
    assert [one.name for one in read_records([folder])] == ["a.csv", "b.AT2"]
    assert [one.name for one in read_records([folder, folder / "a.csv"])] == [
        "a.csv (1)",
        "b.AT2",
        "a.csv (2)",
    ]
    (folder / "c.csv").write_text("x", encoding="utf-8")
    with pytest.raises(sk.DesignError) as caught:
        read_records([folder, tmp_path / "nowhere.csv", "sine:1,2"])
    assert caught.value.codes == ("E512", "E147", "E517")
    with pytest.raises(sk.DesignError, match="E510"):
        read_records([])


@pytest.mark.parametrize(
    "name",
    [
        "sine",
        "sine:0.5g",
        "sine:0.5,1Hz",
        "sine:0.5g,1s",
        "sine:0.5g,1Hz,0.5",
        "rectangular:0.5g,-1s",
        "triangular:0.5g,1s,2",
        "rectangular:0g,1s",
        "sine:xg,1Hz",
        "square:0.5g,1s",
        "sine:0.5g,1Hz,0",
        "rect:0.5g,0.3s",
        "half-sine:0.5g,1Hz",
        "half_sine: 0.5g, 1s",
        "half-sine",
        "rectangle:0.5g",
    ],
)
def test_pulses_that_are_none(name) -> None:
    with pytest.raises(sk.DesignError, match="E517"):
        read_record(name)


@pytest.mark.parametrize(
    "name", ["sine:0.5g,0Hz", "triangular:1g,0s", "sine:0.5g,1Hz,101", "sine:0g,1Hz"]
)
def test_pulses_out_of_range_say_the_range(name) -> None:
    with pytest.raises(sk.DesignError, match=r"E517 .* is out of range"):
        read_record(name)


def test_a_pulse_that_no_earthquake_has() -> None:
    with pytest.raises(sk.DesignError, match=r"E511 .* more than any earthquake's"):
        read_record("sine:900g,1Hz")


def test_measures_of_a_record_are_exact() -> None:
    """A triangle of peak A and duration T: PGV A T / 2, Arias π/2g A² T/3."""
    pulse = read_record("triangular:0.4g,0.5s")
    assert pulse.pga_g == pytest.approx(0.4, rel=1e-15)
    assert pulse.pgv_m_s == pytest.approx(0.4 * GRAVITY * 0.25, rel=1e-14)
    assert pulse.arias_m_s == pytest.approx(
        np.pi / (2 * GRAVITY) * (0.4 * GRAVITY) ** 2 * 0.5 / 3.0, rel=1e-14
    )


def test_what_is_said_of_a_record() -> None:
    drifts = record_of("drifts", TIMES, VALUES * GRAVITY + 0.05)
    assert [notice.code for notice in drifts.notices] == ["W460"]
    uneven = record_of(
        "uneven", np.delete(TIMES, slice(150, 170)), np.delete(VALUES, slice(150, 170)), "g"
    )
    assert [notice.code for notice in uneven.notices] == ["W460"]
    assert "0.42 s, is a gap" in uneven.notices[0].message


def test_files_with_anything_in_them_are_read_or_refused(tmp_path) -> None:
    """300 files with bytes changed, taken out, doubled: a record, or a fault with a code; nothing else."""
    rng = np.random.default_rng(5)
    seeds = [
        _columns("time (s),acceleration (g)")[:900].encode(),
        _at2()[:1400].encode(),
        b"t;a gal\n0;1,5\n0,1;-2\n",
    ]
    outcomes = set()
    for k in range(300):
        content = bytearray(seeds[k % 3])
        for _ in range(rng.integers(1, 6)):
            at, what = int(rng.integers(len(content) + 1)), rng.integers(4)
            piece = bytes(rng.choice(list(b"0123456789.,;eE+-\n\t \x00xg\xff"), 4).astype(np.uint8))
            content[at : at + int(rng.integers(0, 40))] = [
                b"",
                piece,
                content[at : at + 30] * 2,
                piece[:1],
            ][what]
        path = tmp_path / "fuzz.csv"
        path.write_bytes(bytes(content))
        try:
            record = read_record(path)
        except sk.DesignError as error:
            outcomes.add(error.codes[0])
        else:
            outcomes.add("read")
            assert np.isfinite(record.accelerations).all()
            assert (np.diff(record.times_s) > 0.0).all()
    assert "read" in outcomes
    assert outcomes == {"read", "E511", "E512", "E514"}
