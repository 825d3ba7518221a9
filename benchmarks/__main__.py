"""Speed against error: ``python -m benchmarks`` (all of it, about 25 minutes) or ``python -m benchmarks quick``.

Names after it choose scenes (wedge, ellipsoid, columns, wall, stack); the others keep the rows of the last run. The
word ``command`` alone measures nothing but the cold command. Writes docs/speed.md, docs/speed.json and
docs/images/speed-*.png.
"""

import json
import sys
from dataclasses import asdict

from benchmarks import speed_error, speed_pages


def main(words: list[str]) -> None:
    quick = "quick" in words
    if words[:1] == ["case"]:
        rows = speed_error.many(words[1], int(words[2]), quick, int(words[3]))
        print(json.dumps([asdict(row) for row in rows]))
        return
    if words == ["command"]:
        speed_pages.keep_command()
        return
    chosen = [word for word in words if word != "quick"] or list(speed_pages.SCENES)
    unknown = sorted(set(chosen) - set(speed_pages.SCENES))
    if unknown:
        sys.exit(
            f"no such scene: {', '.join(unknown)}; there are {', '.join(speed_pages.SCENES)}, and the word quick"
        )
    for name in chosen:
        rows = speed_pages.SCENES[name].run(quick)
        print(f"\n## {speed_pages.SCENES[name].title}\n\n{speed_pages.table(rows)}", flush=True)
        speed_pages.keep(name, rows, quick)
    speed_pages.write()


if __name__ == "__main__":
    main(sys.argv[1:])
