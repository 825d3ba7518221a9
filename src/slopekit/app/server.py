"""The server of the app: one user, this machine alone, a token in the address.

This module has the checks of requests, the messages that pages may send (`VERBS`) and the files that are served; `desk`
has the state that pages share, `messages` the format.
"""

import asyncio
import secrets
from collections.abc import AsyncIterator, Callable
from concurrent.futures import Future
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from urllib.parse import quote

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from slopekit._version import __version__
from slopekit.app import handover, jobs, saving, surveys
from slopekit.app.desk import Desk, Link
from slopekit.app.messages import LARGEST_SURVEY, Message, message_error, text_of, values_of
from slopekit.app.session import Moment, Opened, Session, opened_template, opened_text
from slopekit.core.errors import DesignError, Fault
from slopekit.design.reading.nodes import cut, printable

_MOST_FILES = 8  # that can be downloaded


def _set(link: Link, message: Message) -> None:
    desk, final = link.desk, message.get("final", True) is not False
    values = values_of(message)
    desk.session.set(values, final)
    if final:
        desk.changed()
    if not desk.session.moment.faults and desk.structure() != desk.shape:
        desk.show(link)
    desk.ask(link, message, final, {"values": desk.session.values_at(values)})


def _changed(link: Link, message: Message) -> None:
    """Send the controls, and ask for an answer."""
    link.desk.changed()
    link.desk.show(link)
    link.desk.ask(link, message)


def _undo(link: Link, message: Message) -> None:
    link.desk.session.undo()
    _changed(link, message)


def _redo(link: Link, message: Message) -> None:
    link.desk.session.redo()
    _changed(link, message)


def _reset(link: Link, message: Message) -> None:
    link.desk.session.reset(text_of(message, "path"))
    _changed(link, message)


def _open(link: Link, message: Message) -> None:
    async def opened_in_thread(opened: Opened) -> None:
        autosaved = take(link.desk, opened)
        await _show_opened(link, message, autosaved)

    if "unsaved" in message:
        _open_unsaved(link, message, text_of(message, "unsaved"))
    else:
        link.in_turn(message, _reading(link.desk, message), opened_in_thread)


def _reading(desk: Desk, message: Message) -> Callable[[], Opened]:
    """Return the function that reads the design of an `open` message, to be called in a thread."""
    if "template" in message:
        return partial(opened_template, text_of(message, "template"))
    if "yaml" in message:
        return partial(
            opened_text, text_of(message, "yaml"), _name(text_of(message, "name", "design.yaml"))
        )
    if "pair" in message:
        if desk.survey is None:
            raise message_error("no survey was dropped", "Drop a joint list first.", "E548")
        number = message["pair"]
        if not isinstance(number, int) or isinstance(number, bool):
            raise message_error("pair needs the number of a pair")
        return partial(opened_text, desk.survey.design_of_pair(number), "pair.yaml")
    raise message_error("open needs a template, a yaml, a pair or what was not saved")


def _open_unsaved(link: Link, message: Message, number: str) -> None:
    """Go on with what was kept under a number."""
    desk = link.desk

    def work() -> Session:
        session = desk.session.snapshot()
        saving.Autosave(desk.autosave.folder).restore(number, session)
        return session

    async def opened_in_thread(session: Session) -> None:
        autosaved = take(desk, session.opened)
        desk.session.restore(session.moment.document)
        desk.autosave.number = number
        await _show_opened(link, message, autosaved)

    link.in_turn(message, work, opened_in_thread)


async def _show_opened(link: Link, message: Message, autosaved: "Future[None]") -> None:
    """Show what was opened; greet again when what it took the place of is kept, which is offered then."""
    _changed(link, message)
    await asyncio.wrap_future(autosaved)
    link.send(await asyncio.get_running_loop().run_in_executor(link.desk.readers, link.desk.hello))


def take(desk: Desk, opened: Opened) -> "Future[None]":
    """Work on another design; done when what it takes the place of is kept."""
    autosaved = desk.set_aside()
    desk.session.open(opened)
    _forget(desk)
    return autosaved


def _forget(desk: Desk) -> None:
    """Forget what was said of another design."""
    desk.last = desk.result = desk.document = desk.last_moment = desk.bolts = None
    desk.opened_rev = desk.session.opened_rev


def _name(name: str) -> str:
    """The name of a file, without its folders."""
    last = name.replace("\\", "/").rpartition("/")[2]
    return cut(printable(last)) or "design.yaml"


def _start(link: Link, message: Message) -> None:
    desk, job = link.desk, text_of(message, "job")
    moment = desk.session.moment
    if moment.faults:
        raise DesignError(moment.faults)
    loop = asyncio.get_running_loop()

    def heard(event: Message) -> None:
        loop.call_soon_threadsafe(_pass_on, link, job, moment, event)

    options = {key: value for key, value in message.items() if key not in ("id", "do", "job")}
    link.answer(message, {"job": desk.jobs.start(job, moment, options, heard)})


def _analyse(link: Link, message: Message) -> None:
    _start(link, {**message, "job": "analyse"})


def _pass_on(link: Link, job: str, moment: Moment, event: Message) -> None:
    """Pass on what a job says; an analysis is the answer from now on."""
    desk = link.desk
    if job == "analyse" and (job_result := event.get("result")) is not None:
        answer = job_result.pop("answer")
        if job_result["document"] is not None and answer["rev"] >= desk.opened_rev:
            desk.last, desk.result, desk.document, desk.last_moment = (
                answer,
                None,
                job_result["document"],
                moment,
            )
        answer["stale"] = desk.session.moment.document is not moment.document
        desk.also_send(link, desk.with_undo_state(answer) | {"of": "answer"})
        event = event | {"result": desk.with_undo_state(answer)}
    if job == "support" and (job_result := event.get("result")) is not None:
        desk.bolts = (moment, job_result["bolts"]) if job_result["bolts"] else None
    link.send(event)
    if event["of"] == "done" and event.get("cancelled"):
        desk.warm_up()


def _cancel(link: Link, message: Message) -> None:
    number = message.get("job")
    if not isinstance(number, int) or isinstance(number, bool):
        raise message_error("cancel needs the number of a job")
    desk = link.desk
    if number != desk.jobs.running:
        raise message_error("this job does not run", "", "E544")

    def work() -> Message:
        desk.jobs.cancel(number)  # refused where it ended by itself meanwhile
        return {}

    desk.start(desk.run_in_thread(link, message, desk.readers, work, link.answering(message)))


def _survey(link: Link, message: Message) -> None:
    desk, design = link.desk, link.desk.session.design
    name, text = _name(text_of(message, "name", "survey.csv")), text_of(message, "text")
    c, phi = (jobs.number_in(message, key, None) for key in ("c", "phi"))
    columns, skip_bad = text_of(message, "columns", "") or None, message.get("skip_bad") is True

    def work() -> Message:
        desk.survey = surveys.read_dropped_survey(
            design, name, text, c, phi, columns=columns, skip_bad=skip_bad
        )
        return desk.survey.message

    desk.later(link, message, work)


def _add_bolts(link: Link, message: Message) -> None:
    desk = link.desk
    if not desk.bolts:
        raise message_error(
            "there are no bolts to add: none were looked for, or none give the factor", "", "E548"
        )
    found_for, bolts = desk.bolts
    if found_for.document is not desk.session.moment.document:
        raise message_error(
            "the bolts were found for an earlier design", "Find them again.", "E545"
        )
    desk.session.put("support.bolts", bolts)
    _changed(link, message)


def _file_of(message: Message) -> str | None:
    return text_of(message, "file").strip() or None if message.get("file") is not None else None


def _diff(link: Link, message: Message) -> None:
    session, file = link.desk.session.snapshot(), _file_of(message)

    def work() -> Message:
        change = saving.change_of(session, file)
        return {
            "diff": change.diff,
            "file": None if change.target is None else str(change.target),
            "changed_on_disk": change.changed_on_disk,
            "lines": change.lines,
        }

    link.in_turn(message, work, link.answering(message))


def _save(link: Link, message: Message) -> None:
    desk, file, seen = link.desk, _file_of(message), text_of(message, "seen")
    snapshot, saved_moment = desk.session.snapshot(), desk.session.moment

    def work() -> Path:
        with desk.saving:
            return saving.save(snapshot, file, seen)

    async def saved(target: Path) -> None:
        desk.session.saved_of(snapshot, saved_moment)
        if desk.last_moment is not None and desk.last_moment.rev == desk.session.rev:
            desk.last_moment = desk.session.moment
        desk.changed()
        link.answer(message, {"file": str(target)})
        desk.show(link)

    link.in_turn(message, work, saved)


def _handover(link: Link, message: Message) -> None:
    desk, format_name = link.desk, text_of(message, "what")
    if format_name == "command":
        text, note = handover.command_of(desk.session), handover.note_of(desk.session)
        link.answer(message, {"text": text, "note": note})
        return

    def work() -> Message:
        name, content = handover.file_of(
            format_name, desk.session, None if format_name == "yaml" else desk.result_document()
        )
        number = secrets.token_urlsafe(9)
        desk.files[number] = (name, content)
        for old in list(desk.files)[:-_MOST_FILES]:
            del desk.files[old]
        return {"address": f"/{desk.token}/get/{number}", "name": name}

    desk.later(link, message, work)


#: What each word does.
VERBS: dict[str, Callable[[Link, Message], None]] = {
    "set": _set,
    "undo": _undo,
    "redo": _redo,
    "reset": _reset,
    "open": _open,
    "start": _start,
    "analyse": _analyse,
    "cancel": _cancel,
    "survey": _survey,
    "add_bolts": _add_bolts,
    "diff": _diff,
    "save": _save,
    "handover": _handover,
}


LOOPBACK = "127.0.0.1"
_NAMES = (LOOPBACK, "localhost")
_MOST_LINKS = 8
_HERE = Path(__file__).parent
_PAGE = _HERE / "page"
_VIEWER = _HERE.parent / "views" / "templates" / "viewer.js"
_TYPES = {
    ".js": "text/javascript",
    ".css": "text/css",
    ".svg": "image/svg+xml",
    ".png": "image/png",
}
_DOWNLOAD_TYPES = {
    ".html": "text/html",
    ".json": "application/json",
    ".yaml": "application/yaml",
    ".dxf": "application/dxf",
}
#: What a browser is told of every answer: nothing from elsewhere, nothing inline, nothing kept.
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


# -- who may ask ------------------------------------------------------------------------------------------------------


class Guard:
    """Lets through what comes from the app's own page: its host, its origin, the token first in the path."""

    def __init__(self, inner: ASGIApp, token: str, port: Callable[[], int]) -> None:
        self.inner, self.token, self.port = inner, token, port

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or refuse in a few words."""
        if scope["type"] not in ("http", "websocket"):
            await self.inner(scope, receive, send)
            return
        reason = self.refused(scope)
        if not reason:
            await self.inner(scope, receive, send)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 4403, "reason": reason})
        else:
            await PlainTextResponse(reason, 403 if "token" not in reason else 404, HEADERS)(
                scope, receive, send
            )

    def refused(self, scope: Scope) -> str:
        """Return why a request is refused; empty where it is not."""
        headers = [(name.lower(), value) for name, value in scope["headers"]]
        hosts = [value.decode("latin-1") for name, value in headers if name == b"host"]
        allowed = [f"{name}:{self.port()}" for name in _NAMES]
        if len(hosts) != 1 or hosts[0] not in allowed:
            return "this server answers its own address alone"
        origins = [value.decode("latin-1") for name, value in headers if name == b"origin"]
        if any(origin not in [f"http://{host}" for host in allowed] for origin in origins):
            return "another page may not ask"
        if scope["type"] == "websocket" and len(origins) != 1:
            return "another page may not ask"
        first = scope["path"].lstrip("/").partition("/")[0]
        if not secrets.compare_digest(first.encode(), self.token.encode()):
            return "the token in the address is another"
        return ""


# -- pages ------------------------------------------------------------------------------------------------------------


def application(desk: Desk) -> Guard:
    """The server of a desk, for uvicorn and for tests."""

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        yield
        desk.close()  # by SIGTERM too, which ends the process behind this

    async def page(request: Request) -> Response:
        return Response(_page(), media_type="text/html", headers=HEADERS)

    async def asset(request: Request) -> Response:
        path = _asset(request.path_params["name"])
        if path is None:
            return PlainTextResponse("there is no such file", 404, HEADERS)
        return Response(path.read_bytes(), media_type=_TYPES[path.suffix], headers=HEADERS)

    async def get(request: Request) -> Response:
        number = request.path_params["number"]
        if number not in desk.files:
            return PlainTextResponse("it is there no more", 404, HEADERS)
        name, content = desk.files[number]
        disposition = {
            "Content-Disposition": f"attachment; filename*=UTF-8''{quote(name, safe='')}"
        }
        kind = _DOWNLOAD_TYPES.get(Path(name).suffix, "application/octet-stream")
        return Response(content, media_type=kind, headers=HEADERS | disposition)

    async def socket(websocket: WebSocket) -> None:
        if len(desk.links) >= _MOST_LINKS:
            await websocket.close(4429, "too many pages are open")
            return
        await websocket.accept()
        link = Link(desk, websocket, VERBS)
        desk.links.append(link)
        try:
            await link.run()
        except WebSocketDisconnect:
            pass
        finally:
            desk.links.remove(link)

    routes = [
        Route("/{token}/", page),
        Route("/{token}/static/{name}", asset),
        Route("/{token}/get/{number}", get),
        WebSocketRoute("/{token}/link", socket),
    ]
    return Guard(Starlette(routes=routes, lifespan=lifespan), desk.token, lambda: desk.port)


def _page() -> str:
    from jinja2 import Environment, FileSystemLoader

    made = Environment(loader=FileSystemLoader(_PAGE), autoescape=True)
    return made.get_template("index.html.j2").render(version=__version__)


def _asset(name: str) -> Path | None:
    """A file of the page, none but those: names have no folders."""
    if name == "viewer.js":
        return _VIEWER
    return {path.name: path for path in _PAGE.iterdir() if path.suffix in _TYPES}.get(name)


def serve(opened: Opened, port: int, ready: Callable[[str], None]) -> None:
    """Serve a design on this machine until it is stopped (Ctrl-C).

    Parameters
    ----------
    port : 0 for any that is free
    ready : told the address when the server answers

    Raises
    ------
    DesignError
        E544 where the port is taken.
    """
    import socket
    import sys

    import uvicorn

    desk = Desk(opened, secrets.token_urlsafe(24), warm=True)
    sock = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if sys.platform != "win32":
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        sock.bind((LOOPBACK, port))
    except OSError as error:
        sock.close()
        message = f"port {port} cannot be listened on: {error.strerror or error}"
        raise DesignError(
            [Fault("E544", message, f"--port {port}", "Leave --port out for any.")]
        ) from None
    desk.port = sock.getsockname()[1]
    config = uvicorn.Config(
        application(desk),
        log_level="error",
        access_log=False,
        server_header=False,
        ws_max_size=LARGEST_SURVEY * 4,
        ws="websockets-sansio",
        ws_per_message_deflate=False,
        lifespan="on",
        ws_ping_interval=None,
        ws_ping_timeout=None,  # nothing lies between: a page that sleeps is no page that is gone
        timeout_graceful_shutdown=1,
    )
    server = uvicorn.Server(config)

    async def main() -> None:
        work = asyncio.ensure_future(server.serve([sock]))
        while not server.started and not work.done():
            await asyncio.sleep(0.01)
        if server.started:
            ready(f"http://{LOOPBACK}:{desk.port}/{desk.token}/")
        await work

    sys.setswitchinterval(0.001)  # the thread that analyses lets messages through
    try:
        asyncio.run(main())
    except KeyboardInterrupt:
        pass
    finally:
        desk.close()
