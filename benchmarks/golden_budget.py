"""What starting slopekit costs: modules that its commands load, lines of `src`, cold time against bare imports.

``python -m benchmarks.goldens budget`` prints them beside what is stored, ``budget store`` stores modules and lines
(tests/goldens/budget.txt); times are never stored. Of other packages only the names that pyproject.toml has are
stored: what those load in turn is their own affair, and so is the standard library.
"""

import json
import os
import re
import statistics
import subprocess
import sys
import time
import tomllib
from collections import Counter
from pathlib import Path

from benchmarks.golden_text import Difference, Section, compare_values
from slopekit.design.templates import path_of

ROOT = Path(__file__).parents[1]
SOURCES = ROOT / "src" / "slopekit"
STORED = ROOT / "tests" / "goldens" / "budget.txt"
#: What is started, by name; the first two are what the test of the store looks at.
COMMANDS: dict[str, list[str]] = {
    "wedge": ["wedge", "--dips", "45/115", "45/245"],
    "run wedge.yaml": ["run", "wedge"],
    "run plane.yaml": ["run", "plane"],
    "run footing.yaml": ["run", "footing"],
    "run surface.yaml": ["run", "surface"],
    "run topple.yaml": ["run", "topple"],
    "run blocks.yaml": ["run", "blocks"],
    "run bench.yaml": ["run", "bench", "--set", "slope.length=6", "--set", "slope.height=5"],
}
REPEAT = 40
_LIST = "import sys, json; print(json.dumps(sorted(sys.modules)))"
_RUN = f"""
import sys
from slopekit.cli import main
try:
    main()
except SystemExit:
    pass
{_LIST}
"""


def arguments(name: str) -> list[str]:
    """The words of a command, with the path of its template."""
    words = COMMANDS[name]
    return [words[0], str(path_of(words[1])), *words[2:]] if words[0] == "run" else words


def loaded(name: str) -> list[str]:
    """The modules that a command loads, apart from those of a bare Python."""
    bare = subprocess.run([sys.executable, "-c", _LIST], capture_output=True, text=True, check=True)
    run = subprocess.run(
        [sys.executable, "-c", _RUN, *arguments(name)], capture_output=True, text=True, check=True
    )
    return sorted(set(json.loads(run.stdout.splitlines()[-1])) - set(json.loads(bare.stdout)))


def by_package(modules: list[str]) -> Counter[str]:
    """How many modules of each package; those of the standard library together, names that are no package left out."""
    tops = Counter(module.partition(".")[0] for module in modules)
    found: Counter[str] = Counter()
    for top, count in tops.items():
        if top in sys.stdlib_module_names:
            found["(standard library)"] += count
        elif not top.startswith("_") and top != "cython_runtime":
            found[top] += count
    return found


def declared() -> set[str]:
    """The packages that pyproject.toml names, as they are imported."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    named = [
        *project["dependencies"],
        *(one for extra in project["optional-dependencies"].values() for one in extra),
    ]
    return {re.split(r"[^\w-]", one)[0].replace("-", "_") for one in named}


def modules_of(name: str) -> Section:
    """What is stored of a command: packages, and the modules of slopekit by package."""
    modules = loaded(name)
    own = [
        module.removeprefix("slopekit.")
        for module in modules
        if module.partition(".")[0] == "slopekit"
    ]
    packages = sorted(by_package(modules).keys() & declared())
    rooms: dict[str, list[str]] = {}
    for module in own:
        room, _, rest = module.partition(".")
        rooms.setdefault(room if rest or (SOURCES / room).is_dir() else "(top)", []).append(
            rest or module
        )
    lines = [f"{name}: packages = {' '.join(packages)}", f"{name}: modules = {len(own)}"]
    return lines + [
        f"{name}: {room} = {' '.join(sorted(names))}" for room, names in sorted(rooms.items())
    ]


def sizes() -> Section:
    """Modules and lines of the sources by package."""
    modules, lines = Counter[str](), Counter[str]()
    for path in SOURCES.rglob("*.py"):
        parts = path.relative_to(SOURCES).parts
        room = parts[0] if len(parts) > 1 else "(top)"
        for name in (room, "all"):
            modules[name] += 1
            lines[name] += len(path.read_text(encoding="utf-8").splitlines())
    return [f"src {room} = {modules[room]} modules {lines[room]} lines" for room in sorted(modules)]


def stored() -> Section:
    """What is stored."""
    return STORED.read_text(encoding="utf-8").splitlines() if STORED.exists() else []


def differences(name: str) -> list[Difference]:
    """How the modules that a command loads differ from those stored; what came and what went, by name."""
    old = [line for line in stored() if line.startswith(f"{name}: ")]
    found = []
    for line in compare_values("budget", name, old, modules_of(name)):
        before, after = set(line.old.split()), set(line.new.split())
        came, went = sorted(after - before), sorted(before - after)
        words = (f"without {' '.join(one)}" for one in (came, went))
        found.append(Difference(line.case, line.section, line.key, *words))
    return found


def packages_of(name: str) -> list[str]:
    """The packages that a command loads beside slopekit and the standard library."""
    return sorted(
        top for top in by_package(loaded(name)) if top not in ("slopekit", "(standard library)")
    )


def cold(name: str, packages: list[str], repeat: int = REPEAT) -> tuple[float, float, float]:
    """Median seconds of a command, of importing its packages alone, and the median of their paired ratios.

    Compiled modules are kept even where the environment asks for none, as containers do: else every run compiles ours.
    """
    command = [sys.executable, "-m", "slopekit.cli", *arguments(name)]
    imports = ", ".join(
        "ruamel.yaml" if one == "ruamel" else one for one in packages
    )  # ruamel alone is empty
    bare = [sys.executable, "-c", f"import {imports}"]
    environment = {
        key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"
    }
    ours, theirs = [], []
    for turn in range(
        repeat + 1
    ):  # in turn, so that the machine's mood hits both; the first fills the caches
        for work, times in ((command, ours), (bare, theirs)):
            began = time.perf_counter()
            subprocess.run(work, capture_output=True, check=False, env=environment)
            if turn:
                times.append(time.perf_counter() - began)
    ratio = statistics.median(a / b for a, b in zip(ours, theirs, strict=True))
    return statistics.median(ours), statistics.median(theirs), ratio


def main(words: list[str]) -> None:
    """Print the tables, or store modules and lines."""
    if words == ["store"]:
        lines = [line for name in COMMANDS for line in modules_of(name)] + sizes()
        STORED.write_text("\n".join(lines) + "\n", encoding="utf-8")
        print(f"{len(lines)} lines stored")
        return
    print("modules loaded, by package, beyond a bare Python")
    for name in COMMANDS:
        counts = by_package(loaded(name))
        print(
            f"  {name:<18}{sum(counts.values()):5d}  "
            + "  ".join(f"{top} {n}" for top, n in counts.most_common())
        )
        for one in differences(name):
            print(
                f"    {one.key}: new {one.old.removeprefix('without ')}; gone {one.new.removeprefix('without ')}"
            )
    before = dict(line.split(" = ") for line in stored() if line.startswith("src "))
    print("sources, modules and lines by package")
    for line in sizes():
        room, now = line.split(" = ")
        was = "" if before.get(room) == now else f"   stored: {before.get(room, 'nothing')}"
        print(f"  {room.removeprefix('src '):<18}{now}{was}")
    print(
        f"cold, median of {REPEAT} runs in turn with importing alone what the command loads of other packages"
    )
    for name in list(COMMANDS)[:2]:
        needs = packages_of(name)
        ours, theirs, ratio = cold(name, needs)
        bare = f"import {', '.join(needs)} {theirs * 1e3:.0f} ms"
        print(f"  {name:<18}{ours * 1e3:6.0f} ms  {bare}  ratio {ratio:.2f}")
