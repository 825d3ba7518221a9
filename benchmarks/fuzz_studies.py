"""Surveys and options of `slopekit sets` and `slopekit bench-design`, mutated: ``python -m benchmarks.fuzz studies``.

A case is a survey (CSV) and options by the names of the command line. Each ends in a result
that is JSON, or in a message with a code.
"""

import json
import random
import time
import traceback
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.fuzz import Outcome, limited
from benchmarks.fuzz_mutations import broken_text
from benchmarks.fuzz_seeds import WRONG
from slopekit.core.errors import SlopekitError
from slopekit.studies.bench_design import bench_design
from slopekit.studies.sets import sets

_LIST = """\
name,set,dip,dip_direction,c (kPa),phi,spacing (m),trace (m),ends,position (m),quantity
N01,A,60,140,5,32,2,8,0,1.0,1
N02,A,58,135,,30,3,6,1,2.5,2
N03,A,63,144,0,,2.5,,2,4.1,1
N04,B,50,215,10,35,4,12,,6.0,1
N05,B,54,222,,33,5,9,0,7.7,1
N06,B,47,210,2,31,,7,1,9.0,3
N07,C,82,355,,,1.5,5,0,11.0,1
N08,C,78,002,,28,1.2,6,0,12.0,1
N09,C,85,350,8,29,1.8,,2,14.0,1
N10,,12,080,,40,,3,0,15.0,1
"""
_BARE = "dip;dip direction\n" + "".join(f"{20 + 7 * k % 60};{(37 * k) % 360}\n" for k in range(24))
#: Surveys by name: the file it is written to, its text.
SURVEYS = {"list": ("survey.csv", _LIST), "bare": ("survey.csv", _BARE)}
#: Options: sound values, extreme ones, and some just outside.
OPTIONS: dict[str, dict[str, tuple[object, ...]]] = {
    "bench-design": {
        "height": ("10", "10,15", "5:20:3", "1e-3", "1e4", "0", "15 m", "10:20:+5", "10,10"),
        "face": ("65", "60:80:3", "60,75", "90", "1", "95", "0.5", "60:80:+0"),
        "dip_direction": ("180", "000", "360", "359.99", "-10", "S"),
        "berm": ("6", "0", "4,8", "-1", "1e5"),
        "c": ("10", "0", "-1", "5 MPa", "5,6"),
        "phi": ("30", "0", "89.9", "0.5", "90", "30,31"),
        "reliability": ("80%", "0.5", "0.999", "0.4", "1"),
        "catch": ("7.5", "0", "1e5", "-1"),
        "toe": ("anywhere", "bench", "crest"),
        "trace": ("10", "1e-3", "0", "1e7"),
        "spacing": ("2", "1e-3", "0"),
        "every": ("5", "0.01", "0", "1e6"),
        "lateral": ("20", "0", "90", "91"),
        "lateral_toppling": ("30", "0", "90", "-1"),
        "density": ("2600", "2.6", "20000"),
        "unit_weight": ("26", "2650", "0"),
        "water": ("dry", "full", "50%", "u=9.8kPa", "101%", "u=-1"),
        "seismic": ("0.1", "0", "2", "3", "0.1@180", "0.1@90"),
        "swell": ("1.4", "1", "3", "0.9"),
        "repose": ("37", "10", "60", "61"),
        "fos": ("1", "1e-6", "1.5", "1e6", "0"),
        "n": ("100", "500", "99", "1e9", "150.5"),
        "confidence": ("95%", "0.5", "1"),
        "accept": ("0.8", "0", "1", "1.1"),
        "seed": ("1", "-1", "2.5", "9e18"),
        "convention": ("dip-direction", "right-hand-rule", "strike", "left-hand-rule"),
        "skip_bad": (True, False),
        "columns": ("dip,dip_direction", "dip_direction,dip", "name"),
    },
    "sets": {
        "n": (1, 2, 3, 9, 0, -1, 100),
        "ignore_sets": (True, False),
        "scanline": ("090/00", "045/45", "000/90", "090", "x", "400/10", "090/-5"),
        "bias_angle": ("15", "0", "90", "91", "1e-6", "x"),
        "skip_bad": (True, False),
        "convention": ("dip-direction", "right-hand-rule", "strike"),
        "columns": ("dip,dip_direction", "dip"),
    },
}
_NEEDED = {
    "bench-design": {
        "height": "10",
        "face": "65",
        "dip_direction": "180",
        "c": "5",
        "phi": "30",
        "n": "200",
    },
    "sets": {},
}


def study_case(index: int, seed: int) -> tuple[str, str, bytes, dict[str, Any], str]:
    """Case `index` of a seed: the study, the file, its content, the options, how it was made."""
    rng = random.Random(f"{seed}/study/{index}")
    study = rng.choice(tuple(OPTIONS))
    name = rng.choice(("list", "bare"))
    file, text = SURVEYS[name]
    content, how = text.encode(), "as it is"
    if rng.random() < 0.6:
        content, how = _of_a_cell(text, rng) if rng.random() < 0.65 else broken_text(text, rng)
    options: dict[str, Any] = dict(_NEEDED[study])
    known = OPTIONS[study]
    for _ in range(rng.choice((0, 1, 2, 4))):
        option = rng.choice(tuple(known))
        is_text = isinstance(known[option][0], str)  # the command line hands it on as it is
        wrong = (
            rng.choice(WRONG[rng.choice(tuple(WRONG))]) if is_text and rng.random() < 0.15 else None
        )
        options[option] = rng.choice(known[option]) if wrong is None else wrong
    if options and rng.random() < 0.05:
        options.pop(rng.choice(tuple(options)))
    return study, file, content, options, f"{study} {name}: {how}; {', '.join(sorted(options))}"


def _of_a_cell(text: str, rng: random.Random) -> tuple[bytes, str]:
    """One cell is another."""
    lines = text.splitlines()
    k = rng.randrange(len(lines))
    mark = "," if "," in lines[k] else ";"
    cells = lines[k].split(mark)
    value = rng.choice(WRONG[rng.choice(tuple(WRONG))]) or ""
    cells[rng.randrange(len(cells))] = rng.choice(
        (value, value, "", "0", "90", "360", "1e-9", "1e9", "-5", "45/115")
    )
    lines[k] = mark.join(cells)
    return ("\n".join(lines) + "\n").encode("utf-8", "surrogatepass"), "cell"


def run_study(index: int, seed: int, folder: Path) -> Outcome:
    """One case through the Python call that the command makes."""
    study, file, content, options, origin = study_case(index, seed)
    path = folder / file
    path.write_bytes(content)
    began = time.process_time()
    stage, code, escaped, codes = "analysed", 0, "", ()
    try:
        with limited(), warnings.catch_warnings():
            warnings.simplefilter("error")
            found = (bench_design if study == "bench-design" else sets)(str(path), **options)
            stage = "result"
            json.dumps(found.to_dict(), allow_nan=False)
            str(found)
            code = found.exit_code
    except SlopekitError as error:
        codes, code = error.codes, error.exit_code
        if code not in (2, 3) or not codes or stage == "result":
            escaped = f"{type(error).__name__}: {error}"
    except Exception:  # what the command would call a bug of ours
        code, codes, escaped = 5, ("E599",), traceback.format_exc(limit=-6)
    seconds = time.process_time() - began
    return Outcome(
        index, origin, stage, code, codes, study if stage == "result" else "", (), seconds, escaped
    )


def study_outcomes(count: int, seed: int, folder: Path) -> Sequence[Outcome]:
    """What became of `count` cases."""
    return [run_study(index, seed, folder) for index in range(count)]
