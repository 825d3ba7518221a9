"""The short excerpt of docs/verification.json that reports show; it ships with the package.

Made again by `python -m benchmarks.verification_excerpt docs/verification.json`; a test holds it to that file.
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

_FILE = Path(__file__).resolve().parents[1] / "src/slopekit/views/verification_excerpt.json"
#: Rows that stand for their kind: those published first.
_ROWS = (
    "1b_sheng_hb_wedge_g981: all_pairs_failed",
    "2g_wm_dry: limit",
    "lythos-readme-dry: limit",
    "lythos-readme-filled: limit",
    "7a_3dec_sliding_wedge: critical_friction_deg@35",
    "4a_wm6: limit",
    "4c_wm6: limit",
    "4d_wm6: limit",
    "geostru-dry: limit",
    "geostru-seismic: limit",
    "geostru-water: limit",
    "6c_footing: limit",
    "6a_ellipsoid_li: limit",
    "6d_sphere_phi0: limit",
    "fredlund-krahn: bishop",
    "5a_goodman_bray: limit",
    "goodman-bray-b: limit",
    "goodman-bray-c: limit",
    "goodman-bray-d: limit",
)
_KEPT = (
    "id",
    "kind",
    "title",
    "source",
    "confidence",
    "quantity",
    "published",
    "exact",
    "value",
    "error",
    "ok",
    "reason",
)


def excerpt(verification: Mapping[str, Any]) -> dict[str, Any]:
    """What reports show of a verification: version, counts, some rows with a published value or an exact one."""
    rows = [
        {key: row[key] for key in _KEPT}
        for row in verification["rows"]
        if row["id"] in _ROWS or (row["kind"] in ("blocks", "bench") and row["quantity"] == "limit")
    ]
    rows = [row for row in rows if row["published"] is not None or row["exact"] is not None]
    own = [row for row in rows if row["kind"] in ("blocks", "bench")][:6]
    named = [
        row
        for row in rows
        if row["kind"] not in ("blocks", "bench") and row["published"] is not None
    ]
    kept = named + own
    return {
        "slopekit": verification["slopekit"],
        "counts": verification["counts"],
        "sources": {
            key: verification["sources"][key]
            for key in dict.fromkeys(row["source"] for row in kept)
        },
        "rows": kept,
    }


def main() -> None:
    """Write the excerpt of the verification named on the command line."""
    verification = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    _FILE.write_text(
        json.dumps(excerpt(verification), ensure_ascii=False, indent=1) + "\n", encoding="utf-8"
    )


if __name__ == "__main__":
    main()
