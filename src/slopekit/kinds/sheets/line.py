"""A result on one line, `--quiet`: status, factor, check. Never a bare factor of safety."""

from slopekit.core.sheet import factor_text
from slopekit.kinds.sheets.shared import judged_factor
from slopekit.notices import INVENTED
from slopekit.result import JUDGED, Result


def line_of(result: Result) -> str:
    """Status, factors, what governs, the check, the codes of the notices that ask for something.

    The factor that acceptance hangs on comes first; those of several stand by their names.
    """
    named = [("", result.fos.limit)]
    if result.design.criterion == "all-pairs":
        named = [("limit", result.fos.limit), ("all-pairs", result.fos.all_pairs_failed)]
    if result.leading is not None:
        name, value = result.leading
        first = "all-pairs" if name == "all_pairs_failed" else JUDGED[name]
        first = name if result.without_basal is not None and name == result.without_basal.NAME else first
        named = [(first, value), ("limit", result.fos.limit), *(one for one in named[1:] if one[0] != first)]
    if result.elastic is not None and result.elastic.limit is not None:
        named.append(("elastic", result.elastic.limit))
    rules = [rule for rule in result.design.rules if rule.is_on_factor]
    shown = [f"{name} {'none' if value is None else judged_factor(value, rules)}".strip() for name, value in named]
    parts = [result.status, ", ".join(shown), {True: "agree", False: "disagree", None: "not compared"}[result.agree]]
    parts += ["moments_govern"] if result.moments_govern else []
    also, limit = result.without_basal, result.fos.limit
    if (
        also is not None
        and also.factor is not None
        and also.NAME not in dict(named)
        and (limit is None or also.factor < limit)
    ):
        parts.append(f"{also.NAME} {factor_text(also.factor)}")
    parts += [] if result.accepted is None else ["met" if result.accepted else "not met"]
    said = {one.code: one.code for one in result.warnings}
    if INVENTED in said:
        said[INVENTED] += f" ({', '.join(result.design.invented)})"
    return "  ".join([*parts, *said.values()])
