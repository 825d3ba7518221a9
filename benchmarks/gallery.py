"""docs/gallery.md and its pictures: every picture that `slopekit plot` can give, each by the commands beside it.

    python -m benchmarks.gallery            # minutes: run the commands, draw, write docs/images/gallery and the page
    python -m benchmarks.gallery page       # the page alone

Pictures are drawn as the commands draw them, then made smaller (WIDTH pixels, a palette of 128 colours).
"""

import shlex
import shutil
import sys
import tempfile
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/gallery.md"
IMAGES = ROOT / "docs/images/gallery"
WIDTH = 640


@dataclass(frozen=True)
class Picture:
    """A picture: the word of `slopekit plot`, what to look for, and the commands that make it, the last one drawing."""

    what: str
    look: str
    commands: tuple[str, ...]
    also: str = ""

    @property
    def name(self) -> str:
        """Of its file and its heading."""
        return f"{self.what}-{self.also}" if self.also else self.what


_WEDGE = (
    "slopekit wedge --dips 45/105 70/235 --face 65/185 --upper 12/195 --height 30 --c 24,48 --phi 20,30 --water 50% "
    "--crack 80/185@3m -o wedge --no-pictures --quiet"
)
_BENCH = (
    "slopekit run templates/bench.yaml --set analysis.mechanisms=4 -o bench --no-pictures --quiet"
)
_COLUMNS = "slopekit run templates/goodman-bray.yaml -o columns --no-pictures --quiet"
_MASS = "slopekit run templates/paper-ellipsoid.yaml -o mass --no-pictures --quiet"
_BOLTED = "slopekit run bolted.yaml --case static -o bolted --no-pictures --quiet"
_PROB = "slopekit prob templates/wedge-scatter.yaml -n 5000 -o scatter --quiet"
_BENCHES = (
    "slopekit bench-design examples/bench-survey.csv --height 10,15 --face 60:80:3 --dip-direction 180 --c 2 --phi 32 "
    "-n 2000 -o benches --quiet"
)


def _plot(source: str, what: str, name: str = "", options: str = "") -> str:
    return f"slopekit plot {source} {what}{options} -o {name or what}.png"


PARTS: tuple[tuple[str, tuple[Picture, ...]], ...] = (
    (
        "One block",
        (
            Picture(
                "scene",
                "A wedge with a tension crack in its slope: the block, its joints, the toe.",
                (_WEDGE, _plot("wedge", "scene")),
            ),
            Picture(
                "exploded",
                "The same, out of its place: which face lies on which joint.",
                (_WEDGE, _plot("wedge", "exploded")),
            ),
            Picture(
                "forces",
                "All loads and the resultants on the joints, to scale: what is pressed, and by how much.",
                (_WEDGE, _plot("wedge", "forces")),
            ),
            Picture(
                "tractions",
                "Node pairs by contact mode, and the tractions they carry at the limit: a curved surface.",
                (_MASS, _plot("mass", "tractions")),
            ),
            Picture(
                "displacement",
                "At full strength on its elastic bed, magnified as the picture says: no prediction.",
                (
                    "slopekit wedge --dips 45/115 45/245 -o paper --no-pictures --quiet",
                    _plot("paper", "displacement"),
                ),
            ),
            Picture(
                "elevation",
                "The face as one stands before it, bolts by the numbers of `bolts.csv`. `bolted.yaml` is "
                "that of [lesson 4](tutorial/4-hand-over.md).",
                (_BOLTED, _plot("bolted", "elevation")),
            ),
            Picture(
                "scene",
                "Bolts stand in scenes too: rods and plates, drawn in front of the rock.",
                (_BOLTED, _plot("bolted", "scene", "scene-bolts")),
                "bolts",
            ),
        ),
    ),
    (
        "Many blocks",
        (
            Picture(
                "scene",
                "A bench cut by three joint sets: what moves first, and what stays.",
                (_BENCH, _plot("bench", "scene", "scene-bench")),
                "bench",
            ),
            Picture(
                "mechanism",
                "How columns move as they fail: sliding at the toe, toppling above.",
                (_COLUMNS, _plot("columns", "mechanism")),
            ),
            Picture(
                "factors",
                "Blocks by the factor of safety at which they fail, one mechanism after the other.",
                (_BENCH, _plot("bench", "factors")),
            ),
        ),
    ),
    (
        "Orientations",
        (
            Picture(
                "stereonet",
                "The planes of a design, its line of intersection, face and friction.",
                (_WEDGE, _plot("wedge", "stereonet")),
            ),
            Picture(
                "stereonet",
                "A survey against a face: one test at a time, here the wedge, and the zone that decides.",
                (
                    "slopekit kinematic examples/joints.csv --face 65/180 --phi 32 -o kinematic --quiet",
                    _plot("kinematic", "stereonet", "stereonet-kinematic", " --test wedge"),
                ),
                "kinematic",
            ),
            Picture(
                "stereonet",
                "Sets of a survey: density, poles by set, cones about the means.",
                (
                    "slopekit sets examples/joints.csv -o sets --quiet",
                    _plot("sets", "stereonet", "stereonet-sets"),
                ),
                "sets",
            ),
            Picture(
                "stereonet",
                "The worst pairs of a survey: their planes, poles and lines.",
                (
                    "slopekit combos examples/joints.csv --face 65/180 --c 10 --phi 30 -o combos --quiet",
                    _plot("combos", "stereonet", "stereonet-combos"),
                ),
                "combos",
            ),
            Picture(
                "stereonet",
                "The planes of a design that scatters, at their means.",
                (_PROB, _plot("scatter", "stereonet", "stereonet-prob")),
                "prob",
            ),
        ),
    ),
    (
        "Studies",
        (
            Picture(
                "histogram",
                "Factors of safety of the samples, the share below the target.",
                (_PROB, _plot("scatter", "histogram")),
            ),
            Picture(
                "curve",
                "The factor over one number, by both methods.",
                (
                    "slopekit sweep templates/wedge.yaml water.fill=0:1:11 -o water --quiet",
                    _plot("water", "curve"),
                ),
            ),
            Picture(
                "contour",
                "Over two numbers, with the line of the acceptance rule.",
                (
                    "slopekit sweep templates/wedge.yaml slope.face.dip=50:80:13 water.fill=0:1:9 "
                    "--closed-form -o grid "
                    "--quiet",
                    _plot("grid", "contour"),
                ),
            ),
            Picture(
                "tornado",
                "What each number does to the factor, the strongest first.",
                (
                    "slopekit sweep templates/wedge.yaml --tornado -o each --quiet",
                    _plot("each", "tornado"),
                ),
            ),
            Picture(
                "backbreak",
                "How much of the crest is lost along the bench, by height and face angle.",
                (_BENCHES, _plot("benches", "backbreak")),
            ),
            Picture(
                "motion",
                "Acceleration, velocity and displacement in the record that moves the block most.",
                (
                    "slopekit quake templates/wedge.yaml sine:0.5g,1Hz,3 -o quake --quiet",
                    _plot("quake", "motion"),
                ),
            ),
        ),
    ),
    (
        "Checks",
        (
            Picture(
                "speed-error",
                "What an accuracy costs: every rung of the ladder of `check`.",
                (
                    "slopekit check templates/plane.yaml -o checked --quiet",
                    _plot("checked", "speed-error"),
                ),
            ),
            Picture(
                "reduction",
                "Failed node pairs and displacement over the reduction factor, as the paper's Figure 7.",
                (
                    "slopekit run templates/paper-footing.yaml -o footing --no-pictures --quiet",
                    _plot("footing", "reduction"),
                ),
            ),
        ),
    ),
)


def page() -> str:
    """The page as Markdown."""
    lines = [
        "# Gallery: every picture",
        "",
        "What `slopekit plot` can give, each by the commands that made it (`python -m benchmarks.gallery`). The",
        "pictures are smaller here than the commands write them. `slopekit plot FILE` lists those that a file of yours",
        "can give; options and formats: [plot](howto/plot.md). `-o DIR` draws the usual ones unasked.",
        "",
    ]
    for head, pictures in PARTS:
        lines += [f"## {head}", ""]
        for one in pictures:
            lines += [
                f"### {one.what}{f' ({one.also})' if one.also else ''}",
                "",
                one.look,
                "",
                "```sh",
            ]
            lines += [*one.commands, "```", "", f"![{one.name}](images/gallery/{one.name}.png)", ""]
    return "\n".join(lines)


def draw() -> None:
    """Run the commands in a folder of their own, and keep their pictures, smaller."""
    from PIL import Image

    from tests.test_docs import blocks_of, called

    IMAGES.mkdir(exist_ok=True)
    done = set[str]()
    lesson = (ROOT / "docs/tutorial/4-hand-over.md").read_text(encoding="utf-8")
    bolted = next(block for block in blocks_of(lesson) if block.lines[0] == "# bolted.yaml")
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        for name in ("templates", "examples"):
            shutil.copytree(ROOT / name, name)
        Path("bolted.yaml").write_text("\n".join(bolted.lines) + "\n", encoding="utf-8")
        for one in (one for _, pictures in PARTS for one in pictures):
            for command in one.commands:
                if command in done:
                    continue
                done.add(command)
                code, said = called(shlex.split(command)[1:])
                if code > 1:
                    sys.exit(f"{command} ends with {code}: {said}")
            with Image.open(f"{one.name}.png") as image:
                size = WIDTH, round(image.height * WIDTH / image.width)
                small = image.convert("RGB").resize(size, Image.Resampling.LANCZOS).quantize(128)
                small.save(IMAGES / f"{one.name}.png", optimize=True)
            print(
                f"{one.name:<24}{(IMAGES / f'{one.name}.png').stat().st_size / 1000:6.0f} kB",
                flush=True,
            )


def main() -> None:
    """Draw, unless the page alone is asked for; write the page."""
    if sys.argv[1:] != ["page"]:
        draw()
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
