"""What leaves the house: both wheels as they are built, one version everywhere, the files that strangers meet first.

Built here with hatchling, no network and no environment of its own; `.ci/run` installs with pip in a fresh one.
"""

import json
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from email.parser import Parser
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import slopekit as sk
from slopekit._needs import plain

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src/slopekit"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
GITHUB = ROOT / ".github"


def _read(path: Path):
    return YAML(typ="safe").load(path.read_text(encoding="utf-8"))


def _library(requirement: str) -> str:
    """Its name, and its bounds in the order of the alphabet."""
    name, *bounds = re.split(r"(?=[<>])|,", requirement)
    return " ".join([plain(name), *sorted(filter(None, bounds))])


def _built(folder: Path, compiler: str | None) -> Path:
    given = os.environ | {"CFLAGS": "-O0"} | ({"CC": compiler} if compiler else {})
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    done = subprocess.run(build, cwd=ROOT, env=given, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (wheel,) = folder.glob("*.whl")
    return wheel


@pytest.fixture(scope="module")
def pure(tmp_path_factory) -> Path:
    """The wheel where there is no C compiler."""
    return _built(tmp_path_factory.mktemp("pure"), "/bin/false")


# -- wheels ------------------------------------------------------------------------------------------------------------


def test_the_pure_wheel_holds_every_file_of_the_package_and_nothing_else(pure) -> None:
    assert pure.name == f"slopekit-{sk.__version__}-py3-none-any.whl"
    with zipfile.ZipFile(pure) as wheel:
        held = {name for name in wheel.namelist() if ".dist-info/" not in name}
    here = {f"slopekit/{path.relative_to(SOURCE)}" for path in SOURCE.rglob("*") if path.is_file()}
    here = {name for name in here if "__pycache__" not in name and not name.endswith(".so")}
    here |= {f"slopekit/templates/{path.name}" for path in (ROOT / "templates").glob("*.yaml")}
    assert held == here
    named = {
        "core/messages.toml",
        "py.typed",
        "views/templates/viewer.js",
        "views/templates/report.html.j2",
        "templates/wedge.yaml",
        "studies/suite/verification.json",
        "preie/_kernels.c",
    }
    assert {f"slopekit/{name}" for name in named} <= held


def test_the_pure_wheel_says_what_the_project_says(pure) -> None:
    with zipfile.ZipFile(pure) as wheel:
        about = f"slopekit-{sk.__version__}.dist-info"
        said = Parser().parsestr(wheel.read(f"{about}/METADATA").decode())
        entries = wheel.read(f"{about}/entry_points.txt").decode()
        assert f"{about}/licenses/LICENSE" in wheel.namelist()
    assert (said["Name"], said["Version"], said["License-Expression"]) == (
        "slopekit",
        sk.__version__,
        "MIT",
    )
    assert "slopekit = slopekit.cli:start" in entries
    bare = {one for one in said.get_all("Requires-Dist") if "extra ==" not in one}
    assert {_library(one) for one in bare} == {_library(one) for one in PROJECT["dependencies"]}
    assert set(said.get_all("Provides-Extra")) == set(PROJECT["optional-dependencies"])
    assert said["Description-Content-Type"] == "text/markdown"


def test_the_page_of_the_package_leads_nowhere_that_it_has_not(pure) -> None:
    """A registry shows README alone: links into the sources would be dead, pictures broken."""
    with zipfile.ZipFile(pure) as wheel:
        page = (
            Parser()
            .parsestr(wheel.read(f"slopekit-{sk.__version__}.dist-info/METADATA").decode())
            .get_payload()
        )
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert page.startswith("# slopekit\n")
    assert re.findall(r"\]\((?!https?:)", page) == []
    assert len(re.findall(r"\]\((?!https?:)", readme)) > 10
    code = re.findall(r"^```.*?^```$", readme, re.MULTILINE | re.DOTALL)
    assert re.findall(r"^```.*?^```$", page, re.MULTILINE | re.DOTALL) == code
    words = re.sub(r"!\[[^]]*\]\([^)]*\)|\]\([^)]*\)", "", readme)
    assert set(re.findall(r"\w+", words)) - set(re.findall(r"\w+", page)) == set()
    assert "*a survey worked through to the client's\n  page*" in page


@pytest.mark.slow
def test_the_pure_wheel_works_without_its_compiled_part(pure, tmp_path) -> None:
    """Read from the archive itself: Goodman & Bray's columns, closed form 0.999957 (tests/validation)."""
    with zipfile.ZipFile(pure) as wheel:
        wheel.extractall(tmp_path)
    program = (
        "import json, slopekit as sk; from slopekit.preie.kernels import chosen; "
        "from slopekit.design.templates import path_of; fos = sk.run(path_of('goodman-bray')).fos; "
        "print(json.dumps([sk.__file__, chosen()[0] is None, fos.limit, fos.closed_form]))"
    )
    given = {key: value for key, value in os.environ.items() if key != "SLOPEKIT_KERNELS"}
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=given | {"PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    place, is_pure, limit, closed_form = json.loads(done.stdout)
    assert Path(place).is_relative_to(tmp_path)
    assert is_pure
    assert limit == pytest.approx(closed_form, rel=1e-9)
    assert limit == pytest.approx(0.999957, abs=5e-7)


@pytest.mark.skipif(os.name == "nt", reason="no compiled part on Windows yet")
def test_the_compiled_wheel_adds_the_kernels_alone(pure, tmp_path) -> None:
    wheel = _built(tmp_path, None)
    if wheel.name == pure.name:
        pytest.skip("no C compiler here")
    assert re.fullmatch(rf"slopekit-{re.escape(sk.__version__)}-cp311-abi3-\w+\.whl", wheel.name)
    with zipfile.ZipFile(wheel) as compiled, zipfile.ZipFile(pure) as plain:
        more = set(compiled.namelist()) - set(plain.namelist())
        assert set(plain.namelist()) < set(compiled.namelist())
    assert more == {"slopekit/preie/_kernels.abi3.so"}


# -- one version, one list of what it needs ----------------------------------------------------------------------------


def test_the_version_is_the_same_everywhere() -> None:
    recipe = (ROOT / "conda/meta.yaml").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r'set version = "([^"]+)"', recipe) == [sk.__version__]
    assert str(_read(ROOT / "CITATION.cff")["version"]) == sk.__version__
    assert re.findall(r"^## (\S+)", changes, re.MULTILINE)[0] == sk.__version__
    assert re.fullmatch(r"\d+\.\d+\.\d+", sk.__version__)


def test_the_conda_recipe_asks_for_what_the_package_asks_for() -> None:
    text = (ROOT / "conda/meta.yaml").read_text(encoding="utf-8")
    run = re.search(r"^  run:\n((?:    - .*\n)+)", text, re.MULTILINE)
    listed = [line.removeprefix("    - ").replace(" ", "") for line in run[1].splitlines()]
    assert listed == [f"python{PROJECT['requires-python']}", *PROJECT["dependencies"]]


# -- what strangers meet -----------------------------------------------------------------------------------------------


def test_workflows_run_every_python_that_the_package_names_on_three_systems() -> None:
    matrix = _read(GITHUB / "workflows/test.yml")["jobs"]["test"]["strategy"]["matrix"]
    named = {
        one.rpartition(" ")[2] for one in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", one)
    }
    assert named == set(matrix["python"])
    assert {one.partition("-")[0] for one in matrix["os"]} == {"ubuntu", "macos", "windows"}
    assert min(matrix["python"]) == PROJECT["requires-python"].removeprefix(">=")


def test_ci_installs_the_lowest_version_of_every_library_of_the_user() -> None:
    """`.ci/lowest` runs commands on them; every bound of pyproject.toml has to be in its list."""
    listed = subprocess.run(
        [sys.executable, ".ci/lowest.py"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    extras = PROJECT["optional-dependencies"]
    lines = {
        *PROJECT["dependencies"],
        *(one for name in extras.keys() - {"docs", "test"} for one in extras[name]),
    }
    lowest = {re.match(r"[\w.-]+>=[\d.]+", line)[0].replace(">=", "==") for line in lines}
    assert set(listed.stdout.split()) == lowest
    assert ".ci/lowest" in (ROOT / ".ci/run").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "path", sorted((GITHUB / "workflows").glob("*.yml")), ids=lambda path: path.name
)
def test_workflows_install_extras_that_exist_and_may_only_read(path) -> None:
    flow = _read(path)
    assert flow["permissions"] == {"contents": "read"}
    text = path.read_text(encoding="utf-8")
    asked = {one for given in re.findall(r"\.\[([\w,]+)\]", text) for one in given.split(",")}
    assert asked <= set(PROJECT["optional-dependencies"])


@pytest.mark.parametrize(
    "path", sorted((GITHUB / "ISSUE_TEMPLATE").glob("*.yml")), ids=lambda path: path.name
)
def test_forms_of_issues_have_what_github_asks_for(path) -> None:
    form = _read(path)
    assert set(form) <= {"name", "description", "labels", "body", "title", "assignees"}
    assert form["name"]
    assert form["description"]
    names = [field["id"] for field in form["body"]]
    assert len(names) == len(set(names))
    assert all(
        field["type"] in ("textarea", "input", "dropdown", "checkboxes") for field in form["body"]
    )
    assert any(field.get("validations", {}).get("required") for field in form["body"])


def test_hooks_before_a_commit_are_those_that_have_to_pass() -> None:
    run = (ROOT / ".ci/run").read_text(encoding="utf-8").splitlines()
    hooks = [
        hook for repo in _read(ROOT / ".pre-commit-config.yaml")["repos"] for hook in repo["hooks"]
    ]
    assert [
        hook["entry"]
        for hook in hooks
        if not any(f"{one} ".startswith(f"{hook['entry']} ") for one in run)
    ] == []


def test_pages_for_those_who_take_part_name_files_that_exist() -> None:
    for name in ("CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md"):
        text = (ROOT / name).read_text(encoding="utf-8")
        links = [link.partition("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", text)]
        paths = re.findall(r"`((?:src|docs|tests|benchmarks|\.ci)/[\w/.-]*)`", text)
        assert [one for one in (*links, *paths) if not (ROOT / one).exists()] == []
