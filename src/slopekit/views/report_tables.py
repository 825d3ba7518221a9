"""Tables of a result's document: factors, forces, mechanisms, searches, checks; every number with its unit."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from slopekit.findings import MOTIONS
from slopekit.kinds import status_text, words_named
from slopekit.kinds.words import line_in_words, size_number
from slopekit.orientation import line_of
from slopekit.result import STATUSES
from slopekit.views.bolt_schedule import HEAD, per_slice, schedule
from slopekit.views.report_inputs import Table
from slopekit.views.report_words import block_table, factor, happens, in_names, in_own_names, limit_of

Document = Mapping[str, Any]

METHODS = {
    "fellenius": "Fellenius", "janbu": "Janbu (simplified)", "bishop": "Bishop (simplified)",
    "all_equilibrium": "columns in all equilibrium",
}  # fmt: skip
_MODES = {"slip": "slips", "open": "slips and opens", "stick": "sticks"}
_MOST_ROWS = 40


def factor_table(document: Document) -> Table:
    """Every factor of safety with what it is."""
    fos, rests_on = document["fos"], words_named(str(document["kind"])).rests_on
    proved = "" if document["static_bound_proved"] else ", not proved"
    closed = rests_on or "there is none for this kind"
    if fos["closed_form"] is None and rests_on:
        closed = "none here" if document["agree"] is None else "none: see the status"
    answer = "the answer: forces and moments, slip does not dilate unless given"
    if document.get("assembly"):
        answer += f"; {limit_of(document)}"
    rows = [("limit (PRE-IE)", factor(fos["limit"]), "none: see the status" if fos["limit"] is None else answer)]
    if fos.get("lowest") is not None or fos.get("highest") is not None:
        ends = " .. ".join(factor(fos.get(end)) for end in ("lowest", "highest"))
        rows.append(("same mechanism", ends, "whatever forces are locked in"))
    rows += [
        ("closed form", factor(fos["closed_form"]), closed),
    ]
    if document["moments_govern"]:
        rows.append(
            ("forces only (PRE-IE)", factor(document["forces_only"]), "no turning: the closed form's assumptions")
        )
    bound = f"joints free to dilate: an upper bound{proved}, no answer"
    rows.append(("static bound", factor(fos["static_bound"]), "not found" if fos["static_bound"] is None else bound))
    if fos["all_pairs_failed"] is not None or document["inputs"].get("criterion") == "all-pairs":
        said = "the paper's criterion; depends on the joint stiffness"
        rows.append(("all pairs failed", factor(fos["all_pairs_failed"]), said))
    for name, value in document["methods"].items():
        rows.append((METHODS.get(name, name), factor(value), "other mechanics: beside, not compared"))
    return Table("Factors of safety", ("", "factor", "what it is"), tuple(rows))


def force_tables(document: Document) -> Iterator[Table]:
    """Weight, normal forces with their mean stresses, water, what drives and what resists."""
    forces, areas = document["forces_kn"], document["geometry"].get("areas_m2", {})
    at_limit = document["fos"]["limit"] is not None and any(one is not None for one in forces["normal"].values())
    pressures = _pressures(document)
    rows = []
    for joint in [*forces["normal"], *(name for name in forces["water"] if name not in forces["normal"])]:
        normal, water, area = forces["normal"].get(joint), forces["water"].get(joint, 0.0), areas.get(joint)
        mean = _mean(normal, area) if normal is not None else "-"
        pressure = pressures.get(joint, _mean(water, area) if water else "0")
        own = (_number(normal), mean) if at_limit else ()
        rows.append((joint, _number(area), *own, _number(water), pressure))
    own = ("N' / kN", "mean σ' / kPa") if at_limit else ()
    if rows:
        notes = ["N' and σ' are effective, compression positive, at the limit."] if at_limit else []
        if document["fos"]["limit"] is None:
            notes.append("No limit state was found: what the joints carry is not known.")
        if pressures and any(forces["water"].values()):
            notes.append("Water is the resultant, less than u times a curved area.")
        yield Table(
            "On the joints", ("on", "area / m²", *own, "water / kN", "mean u / kPa"), tuple(rows), " ".join(notes)
        )
    whole = [
        (words, f"{size_number(forces[key])} kN")
        for key, words in (("weight", "weight"), ("driving", "driving, along the slide"), ("resisting", "resisting"))
        if forces[key] is not None
    ]
    lost = "with moments there is no limit" if document["fos"]["limit"] is None else (
        "moments lower the limit below resisting / driving"
    )  # fmt: skip
    note = f"Forces alone: {lost}." if document["moments_govern"] else ""
    yield Table("As a whole", ("", "force"), tuple(whole), note)


def _pressures(document: Document) -> dict[str, str]:
    """Mean pressures that the design gives, where the resultant by the area is none: on a curved surface."""
    if "slip" not in document["inputs"]:
        return {}
    given = document["inputs"]["water"]["pressures_kpa"]
    shown = ", ".join(f"{float(one):g}" for one in given)
    return dict.fromkeys(document["forces_kn"]["water"], shown or "0")


def bolt_tables(document: Document) -> Iterator[Table]:
    """The schedule of the bolts, all of them, where the design has any."""
    bolts = schedule(document)
    if bolts:
        said = "" if all(one.head_m for one in bolts) else " A bolt without a head is a force through the centroid."
        section = f" In {per_slice(bolts)}." if per_slice(bolts) else ""
        note = f"E, N, Z of the heads; trend/plunge of the force on the block.{section}{said}"
        yield Table("Schedule", HEAD, tuple(one.cells() for one in bolts), note)


def motion_table(document: Document) -> Table | None:
    """Movement of one block in the mechanism and at full strength."""
    rows = []
    mechanism, one = document["mechanism"], document["at_factor_one"]
    if mechanism is not None and document["assembly"] is None:
        rows.append(
            ("in the mechanism (no size, the direction counts)", _vector(mechanism["displacement"], 4),
             _toward(mechanism["displacement"]), _vector(mechanism["rotation"], 3) + " per m")
        )  # fmt: skip
    if one is not None:
        whose = f" (block {one['block']}, which moves most)" if one.get("block") else ""
        rows.append(
            (f"at full strength on the elastic bed{whose}",
             _vector([1e3 * v for v in one["displacement_m"]], 4) + " mm", _toward(one["displacement_m"]),
             _vector(one["rotation_rad"], 3) + " rad")
        )  # fmt: skip
    head = ("", "displacement of the centroid (east, north, up)", "toward", "rotation about it")
    return Table("Movement", head, tuple(rows), left=4) if rows else None


def assembly_tables(document: Document) -> Iterator[Table]:
    """Mechanisms, interfaces that govern, factors by block, Goodman & Bray's columns."""
    found, kind = document["assembly"], document["kind"]
    if found is None:
        return
    rows = []
    flat = "In the section x is 090." if document["geometry"].get("thickness_m") else ""
    for k, one in enumerate(found["mechanisms"][:_MOST_ROWS], 1):
        ways: dict[str, list[str]] = {}
        for block in one["blocks"]:
            ways.setdefault(block["how"], []).append(block["name"])
        said = "; ".join(f"{len(names)}: {MOTIONS.get(how, how)} ({in_names(names)})"
                         for how, names in ways.items())  # fmt: skip
        toward = _toward(one["blocks"][0]["displacement"]) if one["blocks"] else ""
        rows.append(
            (str(k), happens(kind, one["status"]), said, toward, factor(one["fos"]), factor(one["static_bound"]))
        )
    if rows:
        head = ("n", "what happens", "blocks", "the fastest toward", "factor", "bound")
        yield Table("Mechanisms in order", head, tuple(rows), (flat + _left(found["mechanisms"])).strip(), left=4)
    for k, one in enumerate(found["mechanisms"][:3], 1):
        shown = [i for i in one["interfaces"] if i["share"] >= 1e-3][:12]
        if shown:
            rest = 100.0 * (1.0 - sum(i["share"] for i in shown))
            note = f"The others together {rest:.2g} %." if rest > 1e-3 else ""
            if counts := one["pairs_by_mode"]:
                listed = ", ".join(f"{n} {mode}" for mode, n in counts.items())
                note += f" Node pairs of the mechanism: {listed}."
            yield Table(
                f"Interfaces that govern mechanism {k}", ("interface", "joint", "mode", "share", "N' / kN", "σ' / kPa"),
                tuple(
                    (i["name"], i["joint"], _MODES.get(i["mode"], i["mode"]), f"{100 * i['share']:.1f} %",
                     _number(i["normal_kn"]), _mean(i["normal_kn"], i["area_m2"]))
                    for i in shown
                ), note.strip(), left=3,
            )  # fmt: skip
    yield from _columns(document, found["table"])
    if table := block_table(found):
        yield table


def _columns(document: Document, table: list[Mapping[str, Any]]) -> Iterator[Table]:
    if not table:
        return
    value = document["fos"]["limit"] or document["fos"]["closed_form"]
    at = f"strength divided by {factor(value)}" if value else "strength as given"
    rows = []
    for one in sorted(table, key=lambda column: -column["n"]):
        lengths = (_fixed(one[key]) for key in ("y_m", "M_m", "L_m"))
        forces = (_fixed(one[key]) for key in ("P_topple_kn", "P_slide_kn", "P_kn", "R_kn", "S_kn"))
        rows.append((str(one["n"]), *lengths, *forces, one["mode"], one["mode_preie"]))
    head = (
        "n",
        "y / m",
        "M / m",
        "L / m",
        "P topple / kN",
        "P slide / kN",
        "P / kN",
        "R / kN",
        "S / kN",
        "mode",
        "PRE-IE",
    )
    alike = sum(one["mode"] == one["mode_preie"] for one in table)
    note = f"n counts from the toe. The modes are the same in {alike} of {len(table)} columns."
    yield Table(f"Goodman & Bray's columns, {at}", head, tuple(rows), note)


def search_tables(document: Document) -> Iterator[Table]:
    """The paper's search, the steps of strength reduction, what changes the factor."""
    pairs, count = document["all_pairs"], document["model"]["node_pairs"]
    if pairs is not None:
        rows = tuple((f"{one['factor']:.5f}", str(one["failed_pairs"])) for one in pairs["history"][:_MOST_ROWS])
        low, high = (_number(end) for end in pairs["bracket"])
        lost = "equilibrium is lost at the upper end" if pairs["lost_equilibrium"] else "it stands at the upper end"
        note = f"Bracket {low} to {high}; {lost}.{_left(pairs['history'])}"
        yield Table("All-pairs search", ("strength reduction factor", f"failed of {count} pairs"), rows, note, left=0)
    if document["series"]:
        steps = tuple(
            (f"{step['factor']:.4f}", "stands" if step["stands"] else "does not come to rest",
             str(step["failed_pairs"]),
             "-" if step["displacement_m"] is None else _vector([1e3 * v for v in step["displacement_m"]], 5))
            for step in document["series"][:_MOST_ROWS]
        )  # fmt: skip
        head = ("factor", "", f"failed of {count} pairs", "displacement / mm (east, north, up)")
        yield Table("By strength reduction factor", head, steps, _left(document["series"]))
    if document["governs"] and not document["moments_govern"] and document["status"] != "not_converged":
        base = document["fos"]["closed_form"]
        changed = []
        for one in document["governs"]:
            status = one["status"]
            said = in_own_names(document, status_text(document["kind"], status)) if status in STATUSES else status
            change = "-" if one["fos"] is None or base is None else f"{one['fos'] - base:+.4f}"
            changed.append((one["change"], factor(one["fos"]), change, said))
        head = ("changed input", "closed form", "change", "then")
        yield Table("What changes the factor most", head, tuple(changed), "One at a time, by the closed form.")


def check_tables(document: Document) -> Iterator[Table]:
    """Balance of forces and moments, checks of the geometry, the size of the model."""
    rows = []
    if (balance := document["balance"]) is not None:
        rows += [
            ("largest unbalanced force of a block, part of its load", _small(balance["force"])),
            (
                "largest unbalanced moment of a block, part of its load times the model's length",
                _small(balance["moment"]),
            ),
            ("largest pull on a node pair, part of the mean normal force", _small(balance["pull"])),
            ("largest friction beyond the reduced strength, part of the load", _small(balance["friction_excess"])),
        ]
    found = document["assembly"]
    if found is not None:
        if "CHECKS" not in (document.get("sheet") or {}):  # its words say it better
            rows += [(name.replace("_", " "), _small(value)) for name, value in found["checks"].items()]
        rows += [("groups of blocks that touch only through bedrock", str(found["components"])),
                 ("contacts", str(found["contacts"]))]  # fmt: skip
    if rows:
        yield Table("Checks of the answer", ("", "value"), tuple(rows))
    model = document["model"]
    size = [(words, str(model[key])) for key, words in
            (("moving_blocks", "moving blocks"), ("unknowns", "unknowns"), ("node_pairs", "node pairs"),
             ("refined", "times the triangles were split"), ("passes", "passes or factorisations"))]  # fmt: skip
    if model["mesh_change"] is not None:
        size.append(("change of the factor by the last split", _small(model["mesh_change"])))
    yield Table("Size of the model", ("", "number"), tuple(size))


def time_table(document: Document) -> Table | None:
    """Times of the stages; they alone differ from run to run."""
    rows = tuple((name.replace("_", " "), f"{seconds * 1e3:.1f}") for name, seconds in document["timing_s"].items()
                 if seconds >= 5e-5)  # fmt: skip
    return Table("Times", ("stage", "ms"), rows, "Wall time; it alone differs from run to run.") if rows else None


# -- cells ------------------------------------------------------------------------------------------------------------


def _number(value: Any) -> str:
    return "-" if value is None else size_number(float(value))


def _mean(force: Any, area: Any) -> str:
    return size_number(float(f"{force / area:.4g}")) if area else "-"


def _small(value: Any) -> str:
    return "0" if not value else f"{float(value):.2g}"


def _fixed(value: Any) -> str:
    return "-" if value is None else f"{float(value):.2f}"


def _vector(values: Any, digits: int) -> str:
    size = max(abs(float(value)) for value in values)
    parts = [0.0 if abs(float(value)) < max(1e-9 * size, 1e-13) else float(value) for value in values]
    return "(" + ", ".join(f"{part:.{digits}g}" for part in parts) + ")"


def _toward(values: Any) -> str:
    vector = np.array([float(value) for value in values])
    return line_in_words(line_of(vector)) if float(np.abs(vector).max()) > 0.0 else "-"


def _left(items: Any) -> str:
    return f" {len(items) - _MOST_ROWS} more are in the JSON." if len(items) > _MOST_ROWS else ""
