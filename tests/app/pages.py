"""A page without a browser: what it asks of the app's server, by ASGI, and what it hears."""

import asyncio
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from slopekit.app.controls import groups_of
from slopekit.app.desk import Desk
from slopekit.app.server import application
from slopekit.app.session import opened_template
from slopekit.design.common import Design

TOKEN, PORT = "token-of-the-test", 8123
HOST = f"127.0.0.1:{PORT}"
OWN = {"host": HOST, "origin": f"http://{HOST}"}
FIRST = 3  # hello, design, answer


def desk_of(folder: Path, template: str = "wedge") -> Desk:
    """A desk with a template; what is not saved is kept in a folder of the test."""
    desk = Desk(opened_template(template), TOKEN, folder)
    desk.port = PORT
    return desk


def controls_of(design: Design, opened: Design) -> dict[str, Any]:
    """Every control by its path."""
    return {
        control["path"]: control
        for group in groups_of(design, opened)
        for control in group["controls"]
    }


def _scope(kind: str, path: str, headers: Mapping[str, str]) -> dict[str, Any]:
    named = [(name.encode(), value.encode("latin-1")) for name, value in headers.items()]
    return {
        "type": kind,
        "path": path,
        "raw_path": path.encode(),
        "query_string": b"",
        "headers": named,
        "root_path": "",
        "scheme": "http" if kind == "http" else "ws",
        "http_version": "1.1",
        "method": "GET",
        "subprotocols": [],
        "server": ("127.0.0.1", PORT),
        "client": ("127.0.0.1", 50000),
        "state": {},
        "extensions": {},
    }


async def got(
    desk: Desk, path: str, headers: Mapping[str, str] | None = None
) -> tuple[int, dict[str, str], bytes]:
    """Status, headers and body of a GET."""
    sent: list[Any] = []

    async def receive() -> dict[str, Any]:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Any) -> None:
        sent.append(message)

    await application(desk)(
        _scope("http", path, {"host": HOST} if headers is None else headers), receive, send
    )
    head = {name.decode().lower(): value.decode() for name, value in sent[0]["headers"]}
    return sent[0]["status"], head, b"".join(part.get("body", b"") for part in sent[1:])


class Page:
    """One open page: `async with Page(desk) as page`; `closed` has the code where it is refused."""

    def __init__(
        self, desk: Desk, path: str = f"/{TOKEN}/link", headers: Mapping[str, str] = OWN
    ) -> None:
        self.desk, self.scope = desk, _scope("websocket", path, headers)
        self.to: asyncio.Queue[Any] = asyncio.Queue()
        self.back: asyncio.Queue[Any] = asyncio.Queue()
        self.closed: int | None = None
        self.number = 0
        self.events: list[dict[str, Any]] = []

    async def __aenter__(self) -> "Page":
        self.task = asyncio.create_task(
            application(self.desk)(self.scope, self.to.get, self.back.put)
        )
        await self.to.put({"type": "websocket.connect"})
        first = await asyncio.wait_for(self.back.get(), 20)
        if first["type"] == "websocket.close":
            self.closed = first["code"]
        return self

    async def __aexit__(self, *_: object) -> None:
        if self.closed is None:
            await self.to.put({"type": "websocket.disconnect", "code": 1000})
        await asyncio.wait_for(self.task, 20)

    async def hear(self) -> dict[str, Any]:
        """The next message."""
        found = await asyncio.wait_for(self.back.get(), 60)
        assert found["type"] == "websocket.send", found
        said: dict[str, Any] = json.loads(found["text"])
        return said

    async def begin(self) -> list[dict[str, Any]]:
        """What is said when a page opens."""
        return [await self.hear() for _ in range(FIRST)]

    def say(self, text: str) -> None:
        """Send a text, whatever it is."""
        self.to.put_nowait({"type": "websocket.receive", "text": text})

    def send(self, **message: Any) -> int:
        """Send a message; its number."""
        self.number += 1
        self.say(json.dumps({"id": self.number, **message}))
        return self.number

    async def ask(self, **message: Any) -> dict[str, Any]:
        """Send a message and wait for its answer; events go to `events`."""
        number = self.send(**message)
        while True:
            found = await self.hear()
            if found.get("id") == number:
                return found
            self.events.append(found)

    async def end_of_job(self) -> dict[str, Any]:
        """Wait until a job has ended."""
        while True:
            found = await self.hear()
            self.events.append(found)
            if found["of"] == "done":
                return found
