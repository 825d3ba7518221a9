"""A result on one line, `--quiet`: status, factor, check. Never a bare factor of safety."""

from slopekit.core.sheet import factor_text
from slopekit.evidence import WithoutBasal
from slopekit.kinds.sheets.shared import judged_factor
from slopekit.notices import INVENTED
from slopekit.result import JUDGED, Result


def line_of(result: Result) -> str:
    """Status, factors, what governs, the check, the codes of the notices that ask for something.

    The factor that acceptance hangs on comes first; those of several stand by their names.
    """
    limit, whole = result.fos.limit, result.comparisons.without_basal
    named = [("", limit)]
    if result.design.analysis.criterion == "all-pairs":
        named = [("limit", limit), ("all-pairs", result.fos.all_pairs_failed)]
    if result.leading is not None:
        name, value = result.leading
        called = {"all_pairs_failed": "all-pairs", WithoutBasal.NAME: WithoutBasal.NAME}.get(name) or JUDGED[name]
        named = [(called, value), ("limit", limit), *(one for one in named[1:] if one[0] != called)]
    elastic = result.comparisons.elastic
    if elastic is not None and elastic.limit is not None:
        named.append(("elastic", elastic.limit))
    rules = [rule for rule in result.design.rules if rule.is_on_factor]
    shown = [f"{name} {'none' if value is None else judged_factor(value, rules)}".strip() for name, value in named]
    parts = [result.status, ", ".join(shown), {True: "agree", False: "disagree", None: "not compared"}[result.agree]]
    parts += ["moments_govern"] if result.moments_govern else []
    if whole is not None and whole.factor is not None and whole.NAME not in dict(named):
        parts += [f"{whole.NAME} {factor_text(whole.factor)}"] if limit is None or whole.factor < limit else []
    parts += [] if result.accepted is None else ["met" if result.accepted else "not met"]
    said = {one.code: one.code for one in result.warnings}
    if INVENTED in said:
        said[INVENTED] += f" ({', '.join(result.design.invented)})"
    return "  ".join([*parts, *said.values()])
