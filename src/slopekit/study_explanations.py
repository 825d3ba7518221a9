"""The long texts of the codes that design studies use: sampling, prob, sweep, solve, support, combos, kinematic."""

from collections.abc import Mapping

STUDIES: Mapping[str, str] = {
    "E280": "A study reads the design again with other values, so it needs the file, or the dict, that it came from. "
    "A wedge made by `sk.wedge(...)` has neither: write it as a design file or as a dict for `sk.load`.",
}  # fmt: skip
