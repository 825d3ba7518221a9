"""`slopekit app` as a shell starts it: its address, that it ends, and what stops it before it begins."""

import asyncio
import json
import os
import signal
import socket
import subprocess
import sys

import pytest

from tests.commands import slopekit

connect = pytest.importorskip("websockets.asyncio.client").connect


@pytest.mark.slow
def test_it_serves_this_machine_alone_and_ends_by_ctrl_c(tmp_path):
    file = tmp_path / "my wall.yaml"
    file.write_text(
        "slopekit: 1\nkind: wedge\njoints: {J1: {plane: 45/115}, J2: {plane: 45/245}}\n",
        encoding="utf-8",
    )
    own = os.environ | {
        "XDG_STATE_HOME": str(tmp_path / "state"),
        "LOCALAPPDATA": str(tmp_path / "state"),
        "PYTHONUNBUFFERED": "1",
    }
    command = [sys.executable, "-m", "slopekit.cli", "app", str(file), "--no-browser"]
    run = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=own
    )
    try:
        address = next(word for word in run.stdout.readline().split() if word.startswith("http"))
        host, token = address.split("/")[2:4]
        assert host.startswith("127.0.0.1:")
        assert len(token) == 32

        async def scene():
            async with connect(
                f"ws://{host}/{token}/link", origin=f"http://{host}", max_size=None
            ) as link:
                first = [json.loads(await link.recv())["of"] for _ in range(3)]
                await link.send(
                    json.dumps({"id": 1, "do": "set", "values": {"joints.J1.plane.dip": 50}})
                )
                return first, json.loads(await link.recv())

        first, answer = asyncio.run(scene())
        assert first == ["hello", "design", "answer"]
        assert answer["fos"]["limit"] == pytest.approx(answer["fos"]["closed_form"], rel=1e-9)
        with socket.socket() as other:  # no other address of this machine is listened on
            other.settimeout(2.0)
            with pytest.raises(OSError):  # noqa: PT011
                other.connect(("127.0.0.2", int(host.rpartition(":")[2])))
        taken = slopekit("app", "--no-browser", "--port", host.rpartition(":")[2])
        assert (taken.returncode, taken.stderr[:4]) == (2, "E544")
    finally:
        run.send_signal(signal.SIGINT if sys.platform != "win32" else signal.SIGTERM)
        _, err = run.communicate(timeout=60)
    assert "Traceback" not in err
    assert sys.platform == "win32" or run.returncode == 0
    assert file.read_text(encoding="utf-8").count("\n") == 3  # it is as it was
    kept = list((tmp_path / "state").rglob("*.json"))
    assert len(kept) == 1  # what was not saved
    assert json.loads(kept[0].read_text(encoding="utf-8"))["text"].count("50/115") == 1


@pytest.mark.parametrize(
    ("arguments", "code"),
    [(("--port", "70000"), "E106"), (("none.yaml",), "E147"), (("--port", "x"), "E100")],
)
def test_what_cannot_be_served_is_said_by_code(arguments, code, tmp_path):
    run = slopekit("app", "--no-browser", *arguments, cwd=tmp_path)
    assert (run.returncode, run.stderr[:4], run.stdout) == (2, code, "")


def test_a_design_with_faults_is_not_opened(tmp_path):
    (tmp_path / "bad.yaml").write_text(
        "slopekit: 1\nkind: wedge\njoints: {J1: {plane: 95/115}}\n", encoding="utf-8"
    )
    run = slopekit("app", "bad.yaml", "--no-browser", cwd=tmp_path)
    assert run.returncode == 2
    assert run.stderr.startswith("E1")


@pytest.mark.parametrize("gone", ["starlette", "uvicorn", "websockets", "jinja2"])
def test_without_the_extra_it_says_what_to_install(monkeypatch, gone):
    monkeypatch.setitem(sys.modules, gone, None)
    run = slopekit("app", "--no-browser")
    assert run.returncode == 2
    assert run.stderr.startswith(f"E140 the app needs the extra app ({gone})")
    assert "slopekit[app]" in run.stderr
