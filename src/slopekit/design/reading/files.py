"""From a design file to a checked design: the tree of YAML, its structure, its names, then the reader of its kind.

Every value keeps its place, so that each fault names its line and column, whatever finds it.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias

from slopekit.core.errors import DesignError, Fault, Faults, did_you_mean
from slopekit.core.options import DESIGN
from slopekit.core.taken import wrong_kind
from slopekit.design.common import Design
from slopekit.design.fields import field_in, in_degrees, record_spec
from slopekit.design.reading.document import read_document, with_overrides
from slopekit.design.reading.nodes import Document, Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import Spec, check_structure
from slopekit.design.registry import KINDS, kind_named, record_of

Overrides = Sequence[tuple[str, object]]
#: What a call takes for a design: the path of its file, the same as a dict, or the design itself.
Source: TypeAlias = str | os.PathLike[str] | Mapping[str, Any] | Design
VERSION = 1


def load(
    source: str | os.PathLike[str] | Mapping[str, Any], overrides: Overrides = (), case: str | None = None
) -> Design:
    """Read and check a design file (or the same as a Python mapping), and its load cases.

    Parameters
    ----------
    overrides : dotted paths and values that replace those of the file
    case : the load case that is wanted alone, None: all of them

    Raises
    ------
    DesignError
        With every fault found.
    """
    document, wrong = read_document(source, overrides)
    faults = Faults(wrong)
    design = faults.of(_set_over, source, overrides, document)
    design = _with_cases(document, faults, design)
    if case is not None:
        from slopekit.design import cases

        return cases.case_named(design, case).design
    return design


def _with_cases(document: Document, faults: Faults, design: Design | None) -> Design:
    """The design of a document with its load cases, or every fault of both."""
    if document.root.get("cases"):
        from slopekit.design import cases  # most designs have none

        document, load_cases, of_cases = cases.read_cases(document, faults, design_of)
        faults += of_cases
        design = None if design is None else replace(design, source=document, cases=load_cases)
    if faults or design is None:
        raise DesignError(dict.fromkeys(faults))
    return design


def design_from(source: Source, function: str, name: str = "design") -> Design:
    """The design that a function is given as its parameter `name`, read where it is a path or a dict.

    Raises
    ------
    DesignError
        E405 for anything else, and what `load` raises.
    """
    if isinstance(source, Design):
        return source
    if not isinstance(source, str | os.PathLike | Mapping):
        raise wrong_kind(function, name, DESIGN.takes, source)
    return load(source)


def _set_over(
    source: str | os.PathLike[str] | Mapping[str, Any], overrides: Overrides, document: Document
) -> Design:  # fmt: skip
    """The design of a document with overrides: a number in place of a distribution takes its correlations along."""
    try:
        return design_of(document)
    except DesignError as error:
        set_here = [path for path, _ in overrides]
        if {fault.code for fault in error.faults} != {"E168"} or not set_here or "correlation" in set_here:
            raise
        try:
            before = load(source)
        except DesignError:
            raise error from None
        design = design_of(document, other_values=True)
        gone = [
            f"{a} / {b}" for a, b, _ in before.correlation if (a, b) not in {pair[:2] for pair in design.correlation}
        ]
        said = f"correlation {', '.join(gone)} (a number was set in place of a distribution)"
        reading = replace(design.reading, left_out=(*design.reading.left_out, said))
        return replace(design, reading=reading)


def load_document_design(document: Document, faults: Sequence[Fault] = ()) -> Design:
    """The design in a document without its load cases, which `source` then lacks; `faults` are said with its own.

    Raises
    ------
    DesignError
        With every fault found.
    """
    every = Faults(faults)
    return replace(_with_cases(document, every, every.of(design_of, document)), cases=())


def design_of(document: Document, other_values: bool = False) -> Design:
    """The design in a document.

    Parameters
    ----------
    other_values : whether values were put over those of a design that was sound: correlations of what scattered before
        and does not now are passed over

    Raises
    ------
    DesignError
        E174 results, another version or an unknown kind, and what structure, names and values are wrong.
    """
    root = document.root
    if root.get("input_sha256"):
        advice = "Run the design that it was made from."
        raise DesignError([Fault("E174", "these are results of slopekit, not a design", str(root.place), advice)])
    kind = kind_named(_kind(root))
    spec = record_spec(kind.record, kind.record.REQUIRED)
    faults = Faults(check_structure(root, spec, kind.name, partial(_others, kind.name)))
    faults += _version(root)
    wanted, factors = root.at("analysis.partial_factors"), None
    if wanted.value is not None:
        from slopekit.design import partial_factors  # most designs have none

        factors = faults.of(partial_factors.read_factors, document, wanted)
    unsound = {fault.where for fault in faults}
    try:
        design: Design = kind.read(Reader(document, kind.record, faults, other_values))
    except DesignError as error:
        # what the structure has said of a place is not said again by the reader
        faults += [fault for fault in error.faults if fault.where not in unsound]
        raise DesignError(dict.fromkeys(faults or error.faults)) from None
    if factors is not None:
        design = partial_factors.factored(design, kind, factors, str(wanted.place))
    return replace(design, source=document)


def with_values(design: Design, values: Mapping[str, object]) -> Design:
    """The design once more with other values, read and checked as `load` reads them.

    Parameters
    ----------
    values : dotted paths of its file and what they shall be, as `--set` takes them

    Raises
    ------
    DesignError
        E280 where the design was not read from a file or a dict, and what `load` raises.

    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> with_values(load(wedge), {"slope.height": 20}).height_m
    20.0
    """
    if design.source is None:
        advice = "Give a design file, or the same as a dict: sk.load({...})."
        raise DesignError([Fault("E280", "this design has no file whose values could be changed", "", advice)])
    # a small friction angle that a study draws is no slip of radians: it has its unit
    given = [(path, _with_unit(design, path, value)) for path, value in values.items()]
    document = with_overrides(design.source, given)
    return replace(design_of(document, other_values=True), source=document)


def _with_unit(design: Design, path: str, value: object) -> object:
    root = None if design.source is None else design.source.root
    field = field_in(type(design), root, path) if isinstance(value, float) else None
    return f"{value!r} deg" if field is not None and field.check is in_degrees else value


def _kind(root: Node) -> str:
    node = root.get("kind")
    known = ", ".join(KINDS)
    if node.text is None:
        where = str((node or root).place)
        many = node.is_mapping or isinstance(node.value, list)
        message = "kind is one word, not a list or keys" if many else "kind is missing: it says what the design is"
        raise DesignError([Fault("E174", message, where, f"Known: {known}.")])
    if node.text not in KINDS:
        advice = did_you_mean(node.text.lower(), KINDS, f"Known: {known}.")
        raise DesignError([Fault("E174", f"{node.text} is not a kind of design", str(node.place), advice)])
    return node.text


def _version(root: Node) -> list[Fault]:
    node = root.get("slopekit")
    if node.text in (None, str(VERSION)):
        return []
    message = f"slopekit: {node.text} is not a version of design files that this slopekit reads"
    return [Fault("E174", message, str(node.place), f"Write slopekit: {VERSION}.")]


def _others(kind: str) -> dict[str, Spec]:
    """The structures of the other kinds, asked for only where a key does not fit."""
    records = {other: record_of(other) for other in KINDS if other != kind}
    return {other: record_spec(record, record.REQUIRED) for other, record in records.items()}
