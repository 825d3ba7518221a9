"""What slopekit says on a machine where something is missing: the doctor names every library and extra."""

import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest

from slopekit import _needs
from slopekit.views import doctor
from slopekit.views.doctor import _EXTRAS

_FOR_WORK_ON_IT = {"test", "docs", "dev", "all"}
PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]


def _name(requirement: str) -> str:
    return requirement.partition(">")[0]


def test_doctor_knows_every_extra_of_the_package() -> None:
    assert set(_EXTRAS.values()) == set(PROJECT["optional-dependencies"]) - _FOR_WORK_ON_IT


def test_doctor_asks_for_every_library_of_the_package() -> None:
    assert set(_needs.NEEDED) == {_name(one) for one in PROJECT["dependencies"]}
    for library, extra in _EXTRAS.items():
        assert library in {_name(one) for one in PROJECT["optional-dependencies"][extra]}


@pytest.fixture
def quick(monkeypatch):
    """A doctor that looks at versions alone."""
    for name in ("_templates", "_drawing"):
        monkeypatch.setattr(doctor, name, lambda: ("not asked", True))
    monkeypatch.setattr(doctor, "_both", lambda *_: ("not asked", True))
    have = dict.fromkeys((*_needs.NEEDED, *_EXTRAS), "99") | {"typer": "0.28.0"}

    def version(name):
        if name in have:
            return have[name]
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(doctor.metadata, "version", version)
    asked = {"typer": ">=0.26,<0.29", "pyvista": ">=0.44", "ruamel-yaml": ">=0.18"}
    monkeypatch.setattr(doctor, "required_versions", lambda: asked)
    return have


def test_doctor_is_content_with_what_is_asked_for(quick) -> None:
    lines, sound = doctor.examination()
    assert (lines[-1], sound) == ("all is well", True)


def test_doctor_names_a_version_that_is_not_asked_for(quick) -> None:
    quick |= {"typer": "0.29.1", "ruamel.yaml": "0.17"}
    lines, sound = doctor.examination()
    assert "WRONG   ruamel.yaml 0.17, slopekit wants >=0.18" in lines
    assert "WRONG   typer 0.29.1, slopekit wants >=0.26,<0.29" in lines
    assert not sound


def test_doctor_names_what_is_missing_and_goes_on(quick, monkeypatch) -> None:
    del quick["clarabel"], quick["pyvista"]
    monkeypatch.setitem(sys.modules, "slopekit.preie.kernels", None)
    lines, sound = doctor.examination()
    assert "MISSING clarabel" in lines
    assert "-       pyvista not installed (extra: plot)" in lines
    assert any(line.startswith("-       no compiled kernels") for line in lines)
    assert lines[-1] == "something is wrong: see the lines marked MISSING, WRONG or FAILS"
    assert not sound


def test_the_versions_that_are_asked_for_are_those_of_the_package(monkeypatch) -> None:
    monkeypatch.setattr(
        _needs.metadata,
        "requires",
        lambda _: [
            *PROJECT["dependencies"],
            "pyvista>=0.44; extra == 'plot'",
            "bare",
            "pyvista>=0.1; extra == 'other'",
        ],
    )
    found = _needs.required_versions()
    assert [f"{name}{bounds}" for name, bounds in found.items()][:-2] == [
        one.replace("ruamel.yaml", "ruamel-yaml") for one in PROJECT["dependencies"]
    ]
    assert (found["pyvista"], found["bare"]) == (">=0.44", "")

    def unknown(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(_needs.metadata, "requires", unknown)
    assert _needs.required_versions() == {}


@pytest.mark.parametrize(
    ("version", "bounds", "is_one"),
    [
        ("1.26", ">=1.26", True),
        ("1.25.9", ">=1.26", False),
        ("1.3", ">=1.26", False),
        ("2", ">=1.26", True),
        ("0.29", "<0.29", False),
        ("0.28.9", "<0.29", True),
        ("3.0.0", "==3", True),
        ("3.1", "!=3.1", False),
        ("3.1", "<=3.1", True),
        ("3.1", ">3.1", False),
        ("1.2", "", True),
        ("unreadable", ">=1", False),
    ],
)
def test_versions_are_compared_as_numbers(version, bounds, is_one) -> None:
    assert _needs.fits(version, bounds) is is_one


#: What hides a library from a program that has it.
_WITHOUT = "import sys; sys.modules[sys.argv[1]] = None; sys.argv = ['slopekit', *sys.argv[2:]]; "


def _without(library: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    program = _WITHOUT + "from slopekit.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", program, library, *arguments], capture_output=True, text=True
    )


@pytest.mark.parametrize("library", ["numpy", "typer"])
def test_a_command_says_which_library_it_misses(library) -> None:
    run = _without(library, "wedge", "--dips", "45/115", "45/245")
    assert run.returncode == 2
    assert run.stdout == ""
    assert run.stderr.startswith(
        f"E140 {library}, which slopekit needs, is not installed\n     Install slopekit again"
    )
    assert "Traceback" not in run.stderr


def test_a_module_of_ours_that_is_missing_is_a_bug_of_ours() -> None:
    run = _without("slopekit.kinds.wedge.design", "wedge", "--dips", "45/115", "45/245")
    assert run.returncode == 5
    assert run.stderr.startswith("E599 a bug of ours: ModuleNotFoundError")
