"""The words at the head of a result's page: the answer, and the check of the two methods."""

import math
from collections.abc import Mapping
from typing import Any

from slopekit.core.sheet import factor_text
from slopekit.findings import counted_rows
from slopekit.kinds.sheets.many_blocks import path_in_words
from slopekit.result import RULE_QUANTITIES


def factor(value: Any) -> str:
    """A factor of safety, or none."""
    return factor_text(None if value is None else float(value)).strip()


def rounded_down(value: Any) -> str:
    """A factor of safety in two decimals, never more than it is.

    >>> rounded_down(1.4996), rounded_down(1.5), rounded_down(None)
    ('1.49', '1.50', 'none')
    """
    return (
        factor(value)
        if value is None or value >= 1e4
        else f"{math.floor(float(value) * 100.0 + 1e-9) / 100.0:.2f}"
    )


def answer(document: Mapping[str, Any], status: list[str]) -> dict[str, Any]:
    """Status, factor and judgements for the head of the page: never a bare factor of safety.

    Parameters
    ----------
    status : the entry of the sheet, which says more than the document's own sentence
    """
    fos, judged_by = document["fos"], document.get("leading")
    value = judged_by["fos"] if judged_by else fos["limit"]
    factor_name = limit_of(document)
    if judged_by:
        factor_name = (
            f"{RULE_QUANTITIES[judged_by['name']]}: acceptance is held against it; "
            f"{factor(fos['limit'])} is the {factor_name}"
        )
    accepted = document["accepted"]
    acceptance_badge = {
        True: ("acceptance MET", "good"),
        False: ("acceptance NOT MET", "bad"),
        None: ("no acceptance rule given", "plain"),
    }
    badges = [_check_badge(document), acceptance_badge[accepted]]
    if document["moments_govern"]:
        badges.append(("moments govern", "warn"))
    if count := len({notice["code"] for notice in document["warnings"]}):
        badges.append((f"{count} notice{'s' if count > 1 else ''}", "warn"))
    return {
        "status": " ".join(status) or document["status_text"],
        "factor": rounded_down(value),
        "exact": factor(value),
        "is_number": value is not None,
        "what": factor_name,
        "badges": badges,
    }


def _check_badge(document: Mapping[str, Any]) -> tuple[str, str]:
    """Return the badge of the check of the two methods; without convergence nothing was compared."""
    agree = document["agree"]
    if document["status"] == "not_converged":
        return "did not converge: no number", "bad"
    if agree is None:
        return "no closed form to compare", "plain"
    if not agree:
        return "the methods DISAGREE: use neither number before that is explained", "bad"
    if document["moments_govern"]:  # what agrees is not the answer
        return "the methods AGREE on forces alone", "plain" if document["fos"][
            "limit"
        ] is None else "good"
    return "the methods AGREE", "good"


def limit_of(document: Mapping[str, Any]) -> str:
    """Return the words that say what the limit is."""
    assembly = document.get("assembly")
    if not assembly:
        return "PRE-IE"
    first: Mapping[str, Any] = next(
        iter(counted_rows(document)), {"basis": "none", "fos": None, "change": 0.0}
    )
    return path_in_words(first["basis"], assembly["shear_to_normal"], first["fos"], first["change"])
