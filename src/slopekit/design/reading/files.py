"""Loading designs: a file or mapping is parsed, its structure checked, and the design read by its kind's reader.

Every value keeps its place, so that every fault names its line and column.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias

from slopekit.core.argument_checks import wrong_kind
from slopekit.core.errors import DesignError, Fault, Faults, did_you_mean
from slopekit.core.options import DESIGN
from slopekit.design.common import Design
from slopekit.design.fields import field_in, in_degrees, record_spec
from slopekit.design.reading.document import read_document, with_overrides
from slopekit.design.reading.nodes import Document, Node
from slopekit.design.reading.reader import Reader
from slopekit.design.reading.structure import Spec, check_structure
from slopekit.design.registry import KINDS, kind_named, record_of

Overrides = Sequence[tuple[str, object]]
#: The design argument of a call: the path of a file, its content as a dict, or a `Design`.
Source: TypeAlias = str | os.PathLike[str] | Mapping[str, Any] | Design
VERSION = 1


def load(
    source: str | os.PathLike[str] | Mapping[str, Any],
    overrides: Overrides = (),
    case: str | None = None,
) -> Design:
    """Read and check a design file (or its content as a Python mapping) and its load cases.

    Parameters
    ----------
    overrides : dotted paths and values that replace those of the file
    case : name of the only load case to return; None: the design with all of them

    Raises
    ------
    DesignError
        With every fault found.
    """
    document, wrong = read_document(source, overrides)
    faults = Faults(wrong)
    design = faults.of(_design_with_overrides, source, overrides, document)
    design = _with_cases(document, faults, design)
    if case is not None:
        from slopekit.design import cases

        return cases.case_named(design, case).design
    return design


def _with_cases(document: Document, faults: Faults, design: Design | None) -> Design:
    """Return the design of a document with its load cases, or raise DesignError with the faults of both."""
    if document.root.get("cases"):
        from slopekit.design import cases  # most designs have none

        document, load_cases, case_faults = cases.read_cases(document, faults, design_of)
        faults += case_faults
        design = None if design is None else replace(design, source=document, cases=load_cases)
    if faults or design is None:
        raise DesignError(dict.fromkeys(faults))
    return design


def design_from(source: Source, function: str, name: str = "design") -> Design:
    """Return the design passed to `function` as its parameter `name`, loaded if it is a path or a dict.

    Raises
    ------
    DesignError
        E405 for anything else, and the faults of `load`.
    """
    if isinstance(source, Design):
        return source
    if not isinstance(source, str | os.PathLike | Mapping):
        raise wrong_kind(function, name, DESIGN.takes, source)
    return load(source)


def _design_with_overrides(
    source: str | os.PathLike[str] | Mapping[str, Any], overrides: Overrides, document: Document
) -> Design:
    """Return the design of a document with overrides; a number replacing a distribution drops its correlations."""
    try:
        return design_of(document)
    except DesignError as error:
        override_paths = [path for path, _ in overrides]
        if (
            {fault.code for fault in error.faults} != {"E168"}
            or not override_paths
            or "correlation" in override_paths
        ):
            raise
        try:
            file_design = load(source)
        except DesignError:
            raise error from None
        design = design_of(document, other_values=True)
        dropped_pairs = [
            f"{a} / {b}"
            for a, b, _ in file_design.correlation
            if (a, b) not in {pair[:2] for pair in design.correlation}
        ]
        note = (
            f"correlation {', '.join(dropped_pairs)} (a number was set in place of a distribution)"
        )
        reading = replace(design.reading, left_out=(*design.reading.left_out, note))
        return replace(design, reading=reading)


def load_document_design(document: Document, faults: Sequence[Fault] = ()) -> Design:
    """Return the design of a document without its load cases; `faults` are raised together with its own.

    Raises
    ------
    DesignError
        With every fault found.
    """
    all_faults = Faults(faults)
    return replace(_with_cases(document, all_faults, all_faults.of(design_of, document)), cases=())


def design_of(document: Document, other_values: bool = False) -> Design:
    """Return the design of a document, without load cases.

    Parameters
    ----------
    other_values : whether values of a sound design were replaced: correlations of values that are no longer random
        variables are then ignored

    Raises
    ------
    DesignError
        E174 a file of results, another version or an unknown kind, and the faults of structure, names and values.
    """
    root = document.root
    if root.get("input_sha256"):
        advice = "Run the design that it was made from."
        raise DesignError(
            [Fault("E174", "these are results of slopekit, not a design", str(root.place), advice)]
        )
    kind = kind_named(_kind(root))
    spec = record_spec(kind.record, kind.record.REQUIRED)
    faults = Faults(check_structure(root, spec, kind.name, partial(_other_specs, kind.name)))
    faults += _version(root)
    factors_node, factors = root.find("analysis.partial_factors"), None
    if factors_node.value is not None:
        from slopekit.design import partial_factors  # most designs have none

        factors = faults.of(partial_factors.read_factors, document, factors_node)
    unsound = {fault.where for fault in faults}
    try:
        design: Design = kind.read(Reader(document, kind.record, faults, other_values))
    except DesignError as error:
        # faults at places that already have a fault of the structure are left out
        faults += [fault for fault in error.faults if fault.where not in unsound]
        raise DesignError(dict.fromkeys(faults or error.faults)) from None
    if factors is not None:
        design = partial_factors.factored(design, kind, factors, str(factors_node.place))
    return replace(design, source=document)


def with_values(design: Design, values: Mapping[str, object]) -> Design:
    """Return the design with some values replaced, read and checked as by `load`.

    Parameters
    ----------
    values : new values by dotted path of the file, as for `--set`

    Raises
    ------
    DesignError
        E280 where the design was not read from a file or a dict, and the faults of `load`.

    >>> wedge = {"slopekit": 1, "kind": "wedge", "joints": {"J1": {"plane": "45/115"}, "J2": {"plane": "45/245"}}}
    >>> with_values(load(wedge), {"slope.height": 20}).height_m
    20.0
    """
    if design.source is None:
        advice = "Give a design file, or the same as a dict: sk.load({...})."
        raise DesignError(
            [Fault("E280", "this design has no file whose values could be changed", "", advice)]
        )
    # angles get their unit, so that a small friction angle in a sample is not taken for radians
    overrides = [(path, _with_unit(design, path, value)) for path, value in values.items()]
    document = with_overrides(design.source, overrides)
    return replace(design_of(document, other_values=True), source=document)


def _with_unit(design: Design, path: str, value: object) -> object:
    root = None if design.source is None else design.source.root
    field = field_in(type(design), root, path) if isinstance(value, float) else None
    return f"{value!r} deg" if field is not None and field.check is in_degrees else value


def _kind(root: Node) -> str:
    node = root.get("kind")
    kinds_text = ", ".join(KINDS)
    if node.text is None:
        location = str((node or root).place)
        has_entries = node.is_mapping or isinstance(node.value, list)
        message = (
            "kind is one word, not a list or keys"
            if has_entries
            else "kind is missing: it says what the design is"
        )
        raise DesignError([Fault("E174", message, location, f"Known: {kinds_text}.")])
    if node.text not in KINDS:
        advice = did_you_mean(node.text.lower(), KINDS, f"Known: {kinds_text}.")
        raise DesignError(
            [Fault("E174", f"{node.text} is not a kind of design", str(node.place), advice)]
        )
    return node.text


def _version(root: Node) -> list[Fault]:
    node = root.get("slopekit")
    if node.text in (None, str(VERSION)):
        return []
    message = f"slopekit: {node.text} is not a version of design files that this slopekit reads"
    return [Fault("E174", message, str(node.place), f"Write slopekit: {VERSION}.")]


def _other_specs(kind: str) -> dict[str, Spec]:
    """Return the key specifications of the other kinds; needed only for the advice about an unknown key."""
    records = {other_kind: record_of(other_kind) for other_kind in KINDS if other_kind != kind}
    return {
        other_kind: record_spec(record, record.REQUIRED) for other_kind, record in records.items()
    }
