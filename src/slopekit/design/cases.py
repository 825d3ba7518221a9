"""Load cases: a design with some of its keys set, and an acceptance of its own.

>>> from slopekit.design.reading.files import load
>>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}},
...          "cases": {"static": {"accept": "fos >= 1.5"}, "quake": {"set": {"loads.seismic.k": 0.1}}}}
>>> [(case.name, case.sets, case.design.seismic.coefficient) for case in load(wedge).cases]
[('static', (), 0.0), ('quake', (('loads.seismic.k', '0.1'),), 0.1)]
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from slopekit.core.errors import DesignError, Fault, did_you_mean
from slopekit.design.common import Design, LoadCase
from slopekit.design.reading.document import with_overrides
from slopekit.design.reading.nodes import Document, Node, cut

_NOT_SET = ("slopekit", "kind", "cases")
_NAME = re.compile(r"[^\W_](?:[\w -]{0,38}\w)?")  # of files and folders on every system, too


def read_cases(
    document: Document, wrong: Sequence[Fault], design_of: Callable[[Document, bool], Design]
) -> tuple[Document, tuple[LoadCase, ...], list[Fault]]:
    """Read the load cases of a document.

    Parameters
    ----------
    wrong : faults of the design itself, which are not repeated for each case
    design_of : reads a document in which values of a sound design are replaced

    Returns
    -------
    the document without its cases, the cases, and their faults: E471 an empty case, E146 a name that cannot be the name
    of a file or that differs from another in capitals alone, E471 a key that a case cannot set, and the faults of the
    design with the case's values
    """
    group = document.root.get("cases")
    bare = replace(
        document,
        root=replace(
            document.root,
            value={key: node for key, node in document.root.items() if key != "cases"},
        ),
    )
    cases, faults, names = list[LoadCase](), list[Fault](), dict[str, str]()
    for name, node in group.items():
        if not node.is_mapping and node.value is not None:
            continue  # a fault of the structure, reported there
        case_faults = [*_misnamed(name, node, names), *_unsettable(name, node)]
        case = None
        if not case_faults:
            try:
                case = _case(bare, name, node, design_of)
            except DesignError as error:
                case_faults = _faults_of_case(
                    name, node, [fault for fault in error.faults if fault not in wrong]
                )
        faults += case_faults
        if case is not None:
            cases.append(case)
    return bare, tuple(cases), faults


def case_named(design: Design, name: str) -> LoadCase:
    """Return the load case of a name. Raises DesignError: E197 unknown name, E313 no load cases."""
    cases = {case.name: case for case in design.cases}
    if not cases:
        message = f"the design has no load cases, {name} is none"
        raise DesignError(
            [
                Fault(
                    "E313",
                    message,
                    f"--case {name}",
                    "Leave --case out, or write cases: in the file.",
                )
            ]
        )
    if name not in cases:
        advice = did_you_mean(name, cases, f"There are: {', '.join(cases)}.")
        raise DesignError(
            [Fault("E197", f"{name} is no load case of this design", f"--case {name}", advice)]
        )
    return cases[name]


def _misnamed(name: str, node: Node, names: dict[str, str]) -> Iterator[Fault]:
    location = str(node.key_place)
    if not _NAME.fullmatch(name) and not re.search(
        r"[./]", name
    ):  # names with . or / are faults of the structure
        message = f"{cut(repr(name))} cannot be the name of a load case: files are named after it"
        yield Fault(
            "E146",
            message,
            location,
            "Letters, digits, blanks, - and _, at most 40, a letter or digit first.",
        )
    first = names.setdefault(name.casefold(), name)
    if first != name:
        message = f"the load cases {first} and {name} differ in capitals alone"
        yield Fault(
            "E146",
            message,
            location,
            "Files are named after them, and many systems do not tell these apart.",
        )


def _unsettable(name: str, node: Node) -> Iterator[Fault]:
    sets, accept = node.get("set"), node.get("accept")
    if not sets.value and not accept.value:
        message = f"the load case {name} is empty: it sets no key and accepts nothing of its own"
        advice = (
            f'Write {name}: {{set: {{loads.seismic.k: 0.1}}}}, or {name}: {{accept: "fos >= 1.5"}}'
        )
        yield Fault("E471", message, str(node.key_place), advice)
    for path, below in sets.items():
        if (top := path.partition(".")[0].strip()) in _NOT_SET:
            subject = "cases within a case" if top == "cases" else f"{top} of the design"
            advice = "A case sets keys of the one design: its slope, strengths, water, loads, support, analysis."
            yield Fault(
                "E471", f"the load case {name} cannot set {subject}", str(below.key_place), advice
            )


def _case(
    bare: Document, name: str, node: Node, design_of: Callable[[Document, bool], Design]
) -> LoadCase | None:
    sets, accept, title = node.get("set"), node.get("accept"), bare.root.get("title")
    if (sets.value is not None and not sets.is_mapping) or accept.is_mapping:
        return None  # a fault of the structure, reported there
    values: list[tuple[str, object]] = [(path.strip(), below) for path, below in sets.items()]
    set_texts = tuple((path, _value_text(below)) for path, below in sets.items())
    if accept.value:
        values.append(("acceptance.rules", accept))
    elif any(
        f"{path}.".startswith("analysis.partial_factors.") and below.value
        for path, below in sets.items()
    ):  # the design's rules ask for a factor of safety, this for 1
        values.append(("acceptance", None))
    title_prefix = f"{title.text}, " if title.text else ""
    if not any(path == "title" for path, _ in values):
        values.append(("title", replace(title or node, value=f"{title_prefix}case {name}")))
    document = with_overrides(bare, values)
    return LoadCase(name, set_texts, replace(design_of(document, True), source=document))


def _faults_of_case(name: str, node: Node, faults: Sequence[Fault]) -> list[Fault]:
    """Return the faults of a case; a fault at a place outside the case gets the case's name in its message."""
    places = {
        str(place)
        for descendant in node.walk()
        for place in (descendant.place, descendant.key_place)
    }
    return [
        fault
        if fault.where in places
        else replace(fault, message=f"{fault.message} (load case {name})")
        for fault in faults
    ]


def _value_text(node: Node) -> str:
    if isinstance(node.value, dict):
        return (
            f"{{{', '.join(f'{key}: {_value_text(below)}' for key, below in node.value.items())}}}"
        )
    if isinstance(node.value, list):
        return f"[{', '.join(_value_text(below) for below in node.value)}]"
    return "null" if node.value is None else node.value
