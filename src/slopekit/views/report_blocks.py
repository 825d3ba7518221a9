"""Factors of the blocks of a result: a number, or why there is none."""

from collections.abc import Iterable, Mapping
from typing import Any

from slopekit.kinds import status_text
from slopekit.kinds.words import names_in_runs
from slopekit.views.entries import factor_text
from slopekit.views.report_inputs import Table

FALLS = "none: held by no strength that was tried"
UNSETTLED = "not settled"
_STAYS = "none"
_MOST_ROWS = 40


def factor(value: Any) -> str:
    """A factor of safety, or none."""
    return factor_text(None if value is None else float(value)).strip()


def happens(kind: str, status: str) -> str:
    """What happens in a mechanism."""
    return "not settled: its factor is no answer" if status == "not_converged" else status_text(kind, status)


def in_names(names: Iterable[str], most: int | None = None) -> str:
    """Names in their order, runs of them as from and to."""
    ordered = sorted(names, key=_natural)
    return names_in_runs(ordered) if most is None else names_in_runs(ordered, most)


def block_table(assembly: Mapping[str, Any]) -> Table | None:
    """Blocks by their factors, the lowest first, then those without a number and why; None without any."""
    outcome = {name: _STAYS if value is None else factor(value) for name, value in assembly["factor_by_block"].items()}
    for one in assembly["mechanisms"]:
        unsettled = one["status"] == "not_converged"
        for block in one["blocks"]:
            if unsettled:
                outcome[block["name"]] = UNSETTLED
            elif outcome.get(block["name"], _STAYS) == _STAYS:
                outcome[block["name"]] = FALLS if one["fos"] is None else factor(one["fos"])
    groups: dict[str, list[str]] = {}
    for name, shown in outcome.items():
        groups.setdefault(shown, []).append(name)
    if not groups:
        return None
    without = (FALLS, UNSETTLED, _STAYS)  # after the numbers, in this order
    order = sorted(groups, key=lambda s: (without.index(s), 0.0) if s in without else (-1, float(s)))
    rows = tuple((shown, str(len(groups[shown])), in_names(groups[shown], 6)) for shown in order[:_MOST_ROWS])
    notes = ["none: stays, or its mechanism was not asked for."] if _STAYS in groups else []
    notes += ["Not settled: what happens to it is not known."] if UNSETTLED in groups else []
    notes += [f"{len(order) - _MOST_ROWS} more factors are in the JSON."] if len(order) > _MOST_ROWS else []
    return Table("Factor by block", ("factor", "blocks", "which"), rows, " ".join(notes))


def _natural(name: str) -> tuple[str, int, str]:
    head = name.rstrip("0123456789")
    return head, int(name[len(head) :] or 0), name
