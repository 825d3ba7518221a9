"""What a result means, in sentences: the answer, and the check of the two methods."""

from collections.abc import Mapping
from typing import Any

from slopekit.views.report_tables import factor

_KINDS = {
    "wedge": "wedge on two joints", "plane": "plane failure, per metre",
    "footing": "footing above a weak plane, per metre",
    "surface": "mass on a curved slip surface", "bench": "bench cut by joint sets", "blocks": "blocks of any shape",
    "topple": "toppling columns",
}  # fmt: skip


def kind_words(kind: str) -> str:
    """A kind of design in words."""
    return _KINDS.get(kind, kind)


def answer(document: Mapping[str, Any], status: list[str]) -> dict[str, Any]:
    """Status, factor and judgements for the head of the page: never a bare factor of safety.

    Parameters
    ----------
    status : the entry of the sheet, which says more than the document's own sentence
    """
    agree, accepted, fos = document["agree"], document["accepted"], document["fos"]
    check = {
        True: ("the methods AGREE", "good"),
        False: ("the methods DISAGREE", "bad"),
        None: ("no closed form to compare", "plain"),
    }
    if document["status"] == "not_converged":
        check[None] = ("did not converge", "bad")
    criterion = document["inputs"].get("criterion", "limit")
    value, name = fos["limit"], "limit, PRE-IE"
    if (
        criterion == "all-pairs"
        and fos["all_pairs_failed"] is not None
        and value is not None
        and fos["all_pairs_failed"] < value
    ):
        name = f"limit, PRE-IE; all pairs failed {factor(fos['all_pairs_failed'])} governs acceptance"
    judged = {
        True: ("acceptance MET", "good"),
        False: ("acceptance NOT MET", "bad"),
        None: ("no acceptance rule given", "plain"),
    }
    badges = [check[agree], judged[accepted]]
    if document["moments_govern"]:
        badges.append(("moments govern", "warn"))
    if count := len(document["warnings"]):
        badges.append((f"{count} notice{'s' if count > 1 else ''}", "warn"))
    return {
        "status": " ".join(status) or document["status_text"], "factor": factor(value), "is_number": value is not None,
        "what": name, "badges": badges,
    }  # fmt: skip


def meaning(document: Mapping[str, Any]) -> list[str]:
    """The check of the two methods: what was compared, how it came out, which number to use."""
    status, agree, fos = document["status"], document["agree"], document["fos"]
    within = f"{float(document['inputs'].get('agree_within', 0.01)) * 100:g} %"
    found = []
    if status == "not_converged":
        return ["The analysis did not converge: there is no number to use."]
    if document["moments_govern"]:
        found.append(
            f"Moments govern: with them the limit is {factor(fos['limit'])}, forces alone give "
            f"{factor(document['forces_only'])}. The closed form balances forces only and does not see this; "
            "the limit is the number to use. The comparison that follows is on the closed form's own assumptions."
        )
    if agree is None:
        found.append(
            "Nothing independent was compared: no closed form covers this design. The number rests on PRE-IE alone, "
            "its balance of forces and its bound; slopekit check looks closer."
        )
    elif document["difference"] is None:
        found.append(
            "Both methods give no factor of safety, for the same reason." if agree
            else "One method gives a factor of safety, the other none: neither is to be used before that is explained."
        )  # fmt: skip
    else:
        percent = document["difference"] * 100.0
        shown = "less than 0.0001 %" if percent < 1e-4 else f"{percent:.2g} %"
        found.append(
            f"PRE-IE and the closed form differ by {shown} (allowed: {within}). They share no code, so agreement "
            "speaks for the arithmetic; it says nothing of strengths, water and planes." if agree
            else f"PRE-IE and the closed form differ by {shown}, more than the {within} allowed: neither number is to "
            "be used before that is explained."
        )  # fmt: skip
    if fos["static_bound"] is not None and fos["limit"]:
        more = (fos["static_bound"] / fos["limit"] - 1.0) * 100.0
        found.append(
            f"The static bound lies {more:.1f} % above the limit: it lets joints dilate, and is unsafe as an answer."
            if more >= 0.05 else "The static bound is no higher than the limit."
        )  # fmt: skip
    return found
