"""The server of the app: one user, this machine alone, a token in the address.

Who may ask and what is served stands here; `desk` has what the pages share, `verbs` what they may ask, `messages` how
it is written.
"""

import asyncio
import secrets
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from urllib.parse import quote

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from slopekit._version import __version__
from slopekit.app.desk import Desk, Link
from slopekit.app.messages import LARGEST_SURVEY
from slopekit.app.session import Opened
from slopekit.app.verbs import VERBS
from slopekit.core.errors import DesignError, Fault

LOOPBACK = "127.0.0.1"
_NAMES = (LOOPBACK, "localhost")
_MOST_LINKS = 8
_HERE = Path(__file__).parent
_PAGE = _HERE / "page"
_VIEWER = _HERE.parent / "views" / "templates" / "viewer.js"
_TYPES = {".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".png": "image/png"}
#: What a browser is told of every answer: nothing from elsewhere, nothing inline, nothing kept.
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Resource-Policy": "same-origin",
}  # fmt: skip


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
        why = self.refused(scope)
        if not why:
            await self.inner(scope, receive, send)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 4403, "reason": why})
        else:
            await PlainTextResponse(why, 403 if "token" not in why else 404, HEADERS)(scope, receive, send)

    def refused(self, scope: Scope) -> str:
        """Why a request is refused; empty where it is not."""
        given = [(name.lower(), value) for name, value in scope["headers"]]
        hosts = [value.decode("latin-1") for name, value in given if name == b"host"]
        allowed = [f"{name}:{self.port()}" for name in _NAMES]
        if len(hosts) != 1 or hosts[0] not in allowed:
            return "this server answers its own address alone"
        origins = [value.decode("latin-1") for name, value in given if name == b"origin"]
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
        file = desk.files.get(request.path_params["number"])
        if file is None:
            return PlainTextResponse("it is there no more", 404, HEADERS)
        named = {"Content-Disposition": f"attachment; filename*=UTF-8''{quote(file.name, safe='')}"}
        return Response(file.content, media_type=file.kind, headers=HEADERS | named)

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
        Route("/{token}/", page), Route("/{token}/static/{name}", asset), Route("/{token}/get/{number}", get),
        WebSocketRoute("/{token}/link", socket),
    ]  # fmt: skip
    return Guard(Starlette(routes=routes, lifespan=lifespan), desk.token, lambda: desk.port)


def _page() -> str:
    if not (_PAGE / "index.html.j2").is_file():
        return f"<!doctype html><title>slopekit {__version__}</title><p>The page is missing from this installation."
    from jinja2 import Environment, FileSystemLoader

    made = Environment(loader=FileSystemLoader(_PAGE), autoescape=True)
    return made.get_template("index.html.j2").render(version=__version__)


def _asset(name: str) -> Path | None:
    """A file of the page, none but those: names have no folders."""
    if name == "viewer.js":
        return _VIEWER
    known = {path.name: path for path in _PAGE.iterdir() if path.suffix in _TYPES} if _PAGE.is_dir() else {}
    return known.get(name)


def new_token() -> str:
    """A token that nobody guesses."""
    return secrets.token_urlsafe(24)


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

    desk = Desk(opened, new_token(), warm=True)
    sock = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if sys.platform != "win32":
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        sock.bind((LOOPBACK, port))
    except OSError as error:
        sock.close()
        message = f"port {port} cannot be listened on: {error.strerror or error}"
        raise DesignError([Fault("E544", message, f"--port {port}", "Leave --port out for any.")]) from None
    desk.port = sock.getsockname()[1]
    config = uvicorn.Config(
        application(desk), log_level="error", access_log=False, server_header=False, ws_max_size=LARGEST_SURVEY * 4,
        ws="websockets-sansio" if _has_sansio() else "websockets", ws_per_message_deflate=False, lifespan="on",
        ws_ping_interval=None, ws_ping_timeout=None,  # nothing lies between: a page that sleeps is no page that is gone
        timeout_graceful_shutdown=1,
    )  # fmt: skip
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


def _has_sansio() -> bool:
    from importlib.util import find_spec

    return find_spec("uvicorn.protocols.websockets.websockets_sansio_impl") is not None
