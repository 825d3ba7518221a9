"""What the documents of one page have in common, said once, and what their inputs have not."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from slopekit.core.orientation import Line, number
from slopekit.core.sheet import counted
from slopekit.design.parts import Bolt
from slopekit.kinds.words import bolt_text, more_of
from slopekit.views.pages.report_inputs import InputTable, input_rows, words

Document = Mapping[str, Any]
Notices = Sequence[tuple[str, str]]

_LEAST = 3  # rows of a table that is not written twice
_NO_INPUT = ("title", "joint_names", "joint_name", "top")


# -- notices -----------------------------------------------------------------------------------------------------------


def shared_notices(every: Sequence[Notices], names: Sequence[str]) -> list[tuple[str, list[tuple[str, str]]]]:
    """Notices that several documents have: whose they are in words, and they themselves.

    >>> shared_notices([[("W1", "a"), ("W2", "b")], [("W1", "a")]], ["1 Run", "2 Support"])
    [('1 Run and 2 Support', [('W1', 'a')])]
    """
    whose: dict[tuple[str, str], list[str]] = {}
    for notices, name in zip(every, names, strict=True):
        for one in dict.fromkeys(notices):
            whose.setdefault(one, []).append(name)
    shared: dict[str, list[tuple[str, str]]] = {}
    for one, having in whose.items():
        if len(having) > 1:
            shared.setdefault(f"{', '.join(having[:-1])} and {having[-1]}", []).append(one)
    return list(shared.items())


def folded(notices: Notices) -> list[tuple[str, str]]:
    """Notices of one code as one: what differs of messages that say the same is listed after the first.

    >>> folded([("W1", "c is drawn: this takes 3"), ("W1", "phi is drawn: this takes 20"), ("W2", "b")])
    [('W1', 'c is drawn: this takes 3; phi 20'), ('W2', 'b')]
    """
    by_code: dict[str, list[str]] = {}
    for code, message in notices:
        by_code.setdefault(code, []).append(message)
    return [(code, _one_of(messages)) for code, messages in by_code.items()]


def _one_of(messages: Sequence[str]) -> str:
    parts = [message.split() for message in messages]
    alike = len(messages) > 1 and all(len(part) > 2 and part[1:-1] == parts[0][1:-1] for part in parts)
    rest = [f"{part[0]} {part[-1]}" for part in parts[1:]] if alike else messages[1:]
    return "; ".join([messages[0], *rest])


# -- sheets ------------------------------------------------------------------------------------------------------------


def sheets_once(documents: Sequence[Document], names: Sequence[str]) -> list[Any]:
    """The sheets, with a reference where a table stands in the sheet of an earlier document already."""
    seen: dict[str, str] = {}
    sheets: list[Any] = []
    for document, name in zip(documents, names, strict=True):
        sheet = document.get("sheet")
        if not isinstance(sheet, Mapping):
            sheets.append(sheet)
            continue
        own: dict[str, Any] = {}
        for label, entries in sheet.items():
            own[label] = entries
            if isinstance(entries, list):
                own[label] = [_or_reference(one, label, name, seen) for one in entries]
        sheets.append(own)
    return sheets


def _or_reference(entry: Any, label: str, name: str, seen: dict[str, str]) -> Any:
    if not isinstance(entry, Mapping) or len(entry.get("shown") or ()) < _LEAST:
        return entry
    first = seen.setdefault(json.dumps([label, entry], sort_keys=True), name)
    return entry if first == name else f"{counted(len(entry['shown']), 'row')}, the same as in {first}."


def without_bolts(entries: Sequence[Any], bolts: Sequence[Document]) -> list[Any]:
    """Entries on loads, the bolts that a schedule lists counted in place of written out."""
    listed = {bolt_text(_bolt(one)) for one in bolts}
    kept = [one for one in entries if one not in listed]
    rest = more_of(len(bolts) - (len(entries) - len(kept)), "bolt")
    return [*(one for one in kept if one != rest), f"{counted(len(bolts), 'bolt')}, in the schedule"]


def _bolt(one: Document) -> Bolt:
    """A bolt of the inputs."""
    head = one["head_m"]
    return Bolt(one["force_kn"], Line(**one["toward"]), one["acts"], head and (head[0], head[1], head[2]),
                one["length_m"], one["block"])  # fmt: skip


# -- inputs ------------------------------------------------------------------------------------------------------------


def inputs_table(documents: Sequence[Document], names: Sequence[str]) -> InputTable | None:
    """Which inputs differ between documents, and what studies change of them; None where nothing does."""
    rows = [*_differing(documents), *_scatter(documents)]
    changes = [_changed(document) for document in documents]
    if any(changes):
        rows.append(("changed by the study", *(change or "nothing" for change in changes)))
    if not rows:
        return None
    return InputTable("", ("input", *names), tuple(rows), left=len(names) + 1)


def same_design(documents: Sequence[Document]) -> bool:
    """Whether all are of one design."""
    return len({document.get("input_sha256") for document in documents}) == 1


def _differing(documents: Sequence[Document]) -> Iterator[tuple[str, ...]]:
    surveys = [document.get("study") == document.get("kind") for document in documents]  # of many joints, no design
    inputs = [
        own_inputs
        if isinstance(own_inputs := document.get("inputs"), Mapping) and (all(surveys) or not of_survey)
        else {}
        for document, of_survey in zip(documents, surveys, strict=True)
    ]
    for key in dict.fromkeys(key for own in inputs for key in own):
        having = [own[key] for own in inputs if key in own]
        if key in _NO_INPUT or len(having) < 2 or all(one == having[0] for one in having):
            continue
        shown = [_shown(key, own) for own in inputs]
        is_listed = False
        for name in dict.fromkeys(name for own in shown for name in own):
            cells = [own.get(name, "not given" if key in given else "-")
                     for own, given in zip(shown, inputs, strict=True)]  # fmt: skip
            if len({cell for cell, given in zip(cells, inputs, strict=True) if key in given}) > 1:
                yield name, *cells
                is_listed = True
        if not is_listed:
            variants = [own.get(key) for own in inputs]
            yield words(key), *(f"variant {variants.index(value) + 1}: see its inputs" for value in variants)


def _shown(key: str, inputs: Document) -> dict[str, str]:
    """The rows of one input by their names; bolts in short, for a schedule has them."""
    if key not in inputs:
        return {}
    if key != "bolts":
        return {row[0]: row[1] for row in input_rows(key, inputs)}
    forces = [float(one["force_kn"]) for one in inputs[key]]
    of = f"{counted(len(forces), 'bolt')}, {number(round(sum(forces), 1))} kN in all" if forces else "none"
    places = {str((one["head_m"], one["toward"], one["length_m"], one["acts"])) for one in inputs[key]}
    return {"bolts": f"{of}, {len(places)} of them different" if len(places) < len(forces) else of}


def _scatter(documents: Sequence[Document]) -> Iterator[tuple[str, ...]]:
    """Inputs that a study of probability draws, beside the one value that others take."""
    drawn = [{one["path"]: one for one in document.get("variables") or ()} for document in documents]
    taken = [document.get("assumed") or {} for document in documents]
    hashes = [document.get("input_sha256") for document in documents]
    means = {sha: own for sha, own in zip(hashes, taken, strict=True) if own}
    for path in dict.fromkeys(path for own in drawn for path in own):
        cells = []
        for own, sha in zip(drawn, hashes, strict=True):
            if path in own:
                cells.append(f"scatters: mean {_short(own[path]['mean'])}, sd {_short(own[path]['sd'])}")
            else:
                known = means.get(sha, {})
                cells.append(str(known.get(path) or known.get(path.rpartition(".")[0]) or "one value"))
        yield path, *cells


def _short(value: Any) -> str:
    return "-" if value is None else f"{float(value):.4g}"


def _changed(document: Document) -> str:
    """What a study does to the design beside drawing it, in words."""
    study = document.get("study")
    if study == "sweep":
        return "; ".join(f"{one['key']} from {_short(min(one['values']))} to {_short(max(one['values']))} {one['unit']}"
                         for one in document["keys"]).strip()  # fmt: skip
    if study == "tornado":
        return f"{counted(len(document['bars']), 'number')}, one at a time"
    if study == "solve":
        key = document["key"]
        return f"{key['key'] if isinstance(key, Mapping) else key} is looked for"
    if study == "support":
        bolts = [f"{case['pattern']['bolts']} {case['acts']}" for case in document["bolts"] or () if case["pattern"]]
        return f"bolts are proposed: {' or '.join(dict.fromkeys(bolts))}" if bolts else ""
    return ""
