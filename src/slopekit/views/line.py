"""A result on one line, `--quiet`: status, factor, check. Never a bare factor of safety."""

from slopekit.result import Result


def line_of(result: Result) -> str:
    """Status, factor, what governs, the check, the codes of the notices."""
    fos = result.fos.limit
    agree = {True: "agree", False: "disagree", None: "not compared"}[result.agree]
    parts = [result.status, "none" if fos is None else f"{fos:.4f}", agree]
    if result.design.criterion == "all-pairs":
        limit, pairs = result.fos.limit, result.fos.all_pairs_failed
        shown = [
            f"{name} {'none' if value is None else f'{value:.4f}'}"
            for name, value in (("limit", limit), ("all-pairs", pairs))
        ]
        parts[1] = ", ".join(shown)
    parts += ["moments_govern"] if result.moments_govern else []
    parts += [] if result.accepted is None else ["met" if result.accepted else "not met"]
    parts += list(dict.fromkeys(notice.code for notice in result.warnings))
    return "  ".join(parts)
