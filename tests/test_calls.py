"""What a script gets that gives the public functions something of the wrong kind: a code that says what they take."""

import ast
import inspect
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import slopekit as sk
from slopekit.core.argument_checks import with_checked_arguments
from slopekit.design.templates import path_of

DESIGN = {
    "slopekit": 1,
    "kind": "wedge",
    "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
    "strength": {"weak": {"c": 50, "phi": 20}},
}
#: What each function needs; it is given these, but for one.
NEEDED: dict[str, dict[str, Any]] = {
    "run": {"source": DESIGN},
    "load": {"source": DESIGN},
    "wedge": {"dips": ("45/115", "45/245")},
    "sweep": {"keys": {"strength.weak.phi": [20]}},
    "tornado": {"ranges": {"strength.weak.phi": "20:21"}},
    "solve": {"key": "strength.weak.c=40:60"},
    "prob": {"n": 20, "by": "closed-form"},
    "combos": {"joints": ["45/115", "45/245"], "face": "60/180"},
    "kinematic": {"joints": ["45/115", "45/245"], "face": "60/180"},
}
WRONG = (
    None,
    5,
    float("nan"),
    "",
    b"x",
    [],
    {},
    [None],
    object(),
    np.array([1.0, 2.0]),
    np.array([1j]),
    float("inf"),
    10**400,
    -(10**5000),
    "\x00",
    "nan",
    True,
    "x" * 5000,
    {1: 2},
    1j,
    [b"30", b"40"],
    (None, 5),
    {"k": b"1"},
)
SLOW = {("analyse", "elastic"), ("run", "elastic"), ("wedge", "elastic")}


def functions() -> Iterator[tuple[str, Callable[..., Any]]]:
    for name in dir(sk):
        one = getattr(sk, name)
        if callable(one) and not isinstance(one, type):
            yield name, one


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch) -> None:
    """Some of what is given is a file to write."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="module")
def given() -> dict[str, Any]:
    result = sk.run(DESIGN)
    return {
        "design": sk.load(DESIGN),
        "result": result,
        "results": result,
        "source": result,
        "what": "histogram",
    }


@pytest.mark.parametrize("name", [name for name, _ in functions()])
def test_no_function_breaks_on_the_wrong_kind_of_thing(name, given) -> None:
    """It works, or says by a code what is wrong; nothing else comes out of it."""
    function = getattr(sk, name)
    parameters = inspect.signature(function).parameters
    needed = {key: given[key] for key in parameters if key in given} | NEEDED.get(name, {})
    quick = {"pictures": False} if "pictures" in parameters else {}
    refused = 0
    for key in (key for key in parameters if key not in ("jobs", "pictures", "show")):
        for value in WRONG:
            if ((name, key) in SLOW and value is True) or (
                value is None and parameters[key].default is None
            ):
                continue
            try:
                function(**{**needed, **quick, key: value})
            except sk.SlopekitError as error:
                refused += bool(error.faults[0].message)
    assert refused > len(WRONG) // 2


JOINTS = ["45/115", "45/245"]
WEDGE = ("45/115", "45/245")
BORDER: list[tuple[Callable[[], Any], str]] = [
    (lambda: sk.wedge(WEDGE, phi=b"30"), "E405 wedge takes numbers and texts for phi, not b'30'"),
    (
        lambda: sk.wedge(WEDGE, phi=[b"30", b"20"]),
        "E405 wedge takes numbers and texts for phi, not b'30'",
    ),
    (
        lambda: sk.combos(JOINTS, face="60/180", c=[None], phi=30),
        "E405 combos takes a value in each place of c",
    ),
    (
        lambda: sk.combos(JOINTS, face="60/180", c=5, phi=30, seismic={}),
        "E143 seismic.k is missing",
    ),
    (
        lambda: sk.combos(JOINTS, face="60/180", c=5, phi=30, top=np.array([1, 2])),
        "E405 combos takes a number",
    ),
    (
        lambda: sk.combos(JOINTS, face="60/180", c=5, phi=30, convention="x"),
        "E192 the strike convention 'x'",
    ),
    (lambda: sk.wedge(WEDGE, seismic={"kk": 0.1}), "E142 kk is not a key of seismic"),
    (lambda: sk.wedge(WEDGE, seismic={"toward": 180}), "E143 seismic.k is missing"),
    (lambda: sk.wedge(WEDGE, bolts=[{"force": 2000}]), "E143 bolts.toward is missing"),
    (lambda: sk.wedge(WEDGE, bolts=[{"toward": "355/5"}]), "E143 bolts.force is missing"),
    (
        lambda: sk.wedge(WEDGE, bolts=[{"force": 2000, "towards": "355/5"}]),
        "E142 towards is not a key of bolts",
    ),
    (
        lambda: sk.wedge(WEDGE, forces=[(1, 0, 0), {"at": (0, 0, 0)}]),
        "E143 forces.force is missing",
    ),
    (
        lambda: sk.wedge(WEDGE, face={"dip": 60, "dipdirection": 180}),
        "E142 dipdirection is not a key of face",
    ),
    (lambda: sk.wedge(WEDGE, face={"dip": 60}), "E143 face.dip_direction is missing"),
    (lambda: sk.wedge(WEDGE, shear_stiffness={"a": 2}), "E142 a is not a key of shear_stiffness"),
    (lambda: sk.wedge(WEDGE, criterion={}), "E405 wedge takes a text for criterion, not {}"),
    (lambda: sk.wedge(WEDGE, accept=[None]), "E405 wedge takes a value in each place of accept"),
    (lambda: sk.wedge(WEDGE, desk=True), "E405 wedge takes a workplace for desk, not True"),
    (lambda: sk.wedge(WEDGE, unknown=5), "E142 unknown is not an input of a wedge"),
    (lambda: sk.load(DESIGN, set={1: 2}), "E405 load takes texts for the keys of set, not {1: 2}"),
    (lambda: sk.sweep(sk.load(DESIGN), {1: [2]}), "E405 sweep takes texts for the keys of keys"),
    (
        lambda: sk.sweep(sk.load(DESIGN), {"slope.height": [20]}, closed_form=5),
        "E405 sweep takes True or False for",
    ),
    (
        lambda: sk.prob(sk.load(DESIGN), n=10**400),
        "E105 n is a whole number of 1329 bits, beyond the largest float",
    ),
    (lambda: sk.wedge(WEDGE, phi=10**5000), "E105 phi is a whole number of"),
    (lambda: sk.plot(sk.wedge(WEDGE), "mechanism", step=10**400), "E105 step is a whole number of"),
    (lambda: sk.plot("x" * 5000), "E148"),
    (
        lambda: sk.report(sk.wedge(WEDGE), "\x00"),
        "E405 report takes a text or a path for path, not '\\x00'",
    ),
    (lambda: sk.report(sk.wedge(WEDGE), "x" * 5000), "E129"),
    (
        lambda: sk.export(sk.wedge(WEDGE), "nan"),
        "E405 export takes a text or a path for path, not 'nan'",
    ),
    (
        lambda: sk.report(sk.wedge(WEDGE), "None"),
        "E405 report takes a text or a path for path, not 'None'",
    ),
]


@pytest.mark.parametrize(("call", "said"), BORDER, ids=[said[:40] for _, said in BORDER])
def test_what_is_no_argument_is_refused_at_the_border(call, said) -> None:
    """Each passed for a number, was left out without a word, or ended in a traceback (issue 40, C17)."""
    with pytest.raises(sk.DesignError) as caught:
        call()
    assert str(caught.value).startswith(said)


@pytest.mark.parametrize("name", [name for name, _ in functions() if name != "wedge"])
def test_a_call_says_what_is_missing_too_many_or_unknown(name, given) -> None:
    function = getattr(sk, name)
    for values, named in (((), {}), (range(30), {}), ((), {"nonsense": 1})):
        with pytest.raises(sk.DesignError) as caught:
            function(*values, **named)
        assert caught.value.codes == ("E405",)


CALLS: list[tuple[Callable[[], Any], str]] = [
    (lambda: sk.load(5), "E405 load takes a text, a path or a mapping for source, not 5"),
    (
        lambda: sk.run(None),
        "E405 run takes the path of a design file, the same as a dict, or a design, not None",
    ),
    (
        lambda: sk.report(None),
        "E405 report takes results, studies, or paths of their JSON, not None",
    ),
    (lambda: sk.prob("x"), "E147 x does not exist"),
    (
        lambda: sk.prob(5),
        "E405 prob takes the path of a design file, the same as a dict, or a design, not 5",
    ),
    (
        lambda: sk.prob(sk.run(DESIGN)),
        "E405 prob takes the path of a design file, the same as a dict, or a design",
    ),
    (lambda: sk.sweep(sk.load(DESIGN), 3), "E405 sweep takes a mapping for keys, not 3"),
    (
        lambda: sk.sweep(sk.load(DESIGN), {"strength.weak.phi": [20]}, fos=[1]),
        "E405 sweep takes a number for fos",
    ),
    (
        lambda: sk.solve(sk.load(DESIGN), "strength.weak.c", 1.3),
        "E405 solve: too many positional arguments",
    ),
    (lambda: sk.load(DESIGN, source=DESIGN), "E405 load: multiple values for argument 'source'"),
    (
        lambda: sk.prob(sk.load(DESIGN), fos=1.2, target=1.3),
        "E405 prob: got an unexpected keyword argument 'target'",
    ),
    (
        lambda: sk.sweep(sk.load(DESIGN), {}, fso=1.3),
        "E405 sweep: got an unexpected keyword argument 'fso'",
    ),
    (lambda: sk.solve(sk.load(DESIGN)), "E405 solve: missing a required argument: 'key'"),
    (lambda: sk.report([]), "E405 report takes one result or study, or more, not []"),
]


@pytest.mark.parametrize(("call", "said"), CALLS, ids=[said[:30] for _, said in CALLS])
def test_what_is_said(call, said) -> None:
    with pytest.raises(sk.DesignError) as caught:
        call()
    assert str(caught.value).startswith(said)


OF_A_DESIGN: dict[str, Callable[[Any], Any]] = {
    "run": sk.run,
    "analyse": sk.analyse,
    "check": sk.check,
    "support": lambda design: sk.support(design, 1.6, acts="active"),
    "evaluate": lambda design: SimpleNamespace(
        line=str(sk.evaluate(design, {"slope.height": [20]}).limit.factor)
    ),
    "sweep": lambda design: sk.sweep(design, {"slope.height": [20]}),
    "solve": lambda design: sk.solve(design, "slope.height", fos=1.5),
    "tornado": lambda design: sk.tornado(design, {"slope.height": "20:21"}),
    "quake": lambda design: sk.quake(design, ["sine:0.5g,1Hz"]),
    "prob": lambda design: sk.prob(design, 20, by="closed-form"),
}


@pytest.mark.parametrize("name", OF_A_DESIGN)
def test_a_design_is_given_by_its_path_as_a_dict_or_loaded(name) -> None:
    call, path = OF_A_DESIGN[name], Path("mine.yaml")
    design = {
        **DESIGN,
        "strength": {"weak": {"c": {"dist": "normal", "mean": 50, "sd": 5}, "phi": 20}},
    }
    path.write_text(json.dumps(design), encoding="utf-8")
    loaded = call(sk.load(design))
    given = (
        (path, str(path), design) if name in ("run", "sweep") else (path, design)
    )  # a text is a path to all
    if name in ("check", "quake", "solve", "support"):  # a dict is one to all studies alike
        given = (path,)
    assert {call(one).line for one in given} == {loaded.line}


def test_every_call_of_a_design_is_tested_so() -> None:
    assert {name for name, one in functions() if "design" in inspect.signature(one).parameters} <= {
        *OF_A_DESIGN
    }


def test_a_design_that_is_loaded_takes_no_values() -> None:
    with pytest.raises(sk.DesignError, match="E160"):
        sk.run(sk.load(DESIGN), set={"slope.height": 20})


@pytest.mark.parametrize("call", [sk.load, sk.run])
def test_a_template_is_no_file_and_how_to_get_one_is_said(call) -> None:
    with pytest.raises(sk.DesignError, match="E147 topple does not exist") as caught:
        call("topple")
    assert (
        caught.value.faults[0].advice
        == "topple is a template: slopekit templates new topple writes topple.yaml."
    )


def test_advice_leads_somewhere() -> None:
    with pytest.raises(sk.DesignError) as caught:
        sk.sweep(sk.load(DESIGN), {}, fso=1.3)
    assert (
        caught.value.faults[0].advice
        == "It takes design, keys, closed_form=, fos=, jobs=, scheduler=."
    )


@pytest.mark.slow
def test_numbers_come_as_texts_and_from_numpy() -> None:
    design = sk.load(DESIGN)
    one, other, third = (
        sk.solve(design, "strength.weak.c", fos=fos, within="40:60")
        for fos in (1.5, "1.5", np.float64(1.5))
    )
    assert one == other == third
    scattered = sk.load(path_of("wedge-scatter"))
    few = sk.prob(scattered, n=2e1, by="closed-form", fos=np.int64(1))
    assert (few.asked.n, few.asked.target) == (20, 1)
    with pytest.raises(sk.DesignError, match=r"E405 prob takes a whole number for n, not 20\.5"):
        sk.prob(scattered, n=20.5)


def test_a_function_stays_what_it_is() -> None:
    """Signature, name and docstring: those of the function that is called."""
    from slopekit import api

    assert with_checked_arguments(api.run) is with_checked_arguments(api.run) is sk.run
    assert inspect.signature(sk.run) == inspect.signature(api.run)
    assert (sk.run.__name__, sk.run.__doc__) == ("run", api.run.__doc__)


def used_in(code: str) -> set[str]:
    """The attributes that some code asks for: `sk.run`, `result.fos.limit`."""
    return {one.attr for one in ast.walk(ast.parse(code)) if isinstance(one, ast.Attribute)}


def test_types_are_tested_of_all_that_is_public_and_all_that_the_notebooks_use() -> None:
    """`mypy` checks tests/caller.py strictly, as a script of a user; it leaves nothing out."""
    here = Path(__file__).parent
    caller = used_in((here / "caller.py").read_text(encoding="utf-8"))
    shown = set[str]()
    for notebook in sorted((here.parent / "examples").glob("*.ipynb")):
        cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        shown |= used_in(
            "\n".join("".join(one["source"]) for one in cells if one["cell_type"] == "code")
        )
    assert {name for name, _ in functions()} <= caller
    assert shown - {"shape", "head", "items"} <= caller
