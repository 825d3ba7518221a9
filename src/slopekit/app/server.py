"""The server of the app: one user, this machine alone, a token in the address.

What comes over the socket changes the design at once; a thread analyses it, and while it does only the newest request
waits. docs/howto/app.md lists the messages.
"""

import asyncio
import json
import secrets
from collections.abc import AsyncIterator, Callable, Coroutine, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from slopekit._version import __version__
from slopekit.app import answers, controls, handover, jobs, saving, surveys
from slopekit.app.session import Moment, Opened, Session, opened_template, opened_text
from slopekit.core.errors import DesignError, Fault, SlopekitError
from slopekit.core.records import dataclass
from slopekit.design import templates
from slopekit.design.nodes import cut, printable
from slopekit.result import Result

Message = dict[str, Any]
LOOPBACK = "127.0.0.1"
_NAMES = (LOOPBACK, "localhost")
LARGEST, LARGEST_SURVEY = 1_000_000, 8_000_000  # letters of a message
_DEEPEST = 12
_MOST_VALUES = 200  # that one message sets
_MOST_LINKS = 8
_MOST_FILES = 8  # that can be downloaded
_MOST_SLOW = 4  # surveys and files to hand over that wait
_KEPT_AFTER_S = 1.0  # of rest, what is not saved is kept
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


def _wrong(message: str, advice: str = "", code: str = "E541") -> DesignError:
    return DesignError([Fault(code, message, "", advice)])


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


# -- messages ---------------------------------------------------------------------------------------------------------


def parsed(text: str) -> Message:
    """A message, where it is one.

    Raises
    ------
    DesignError
        E541 for what is none, E543 for what is too large or too deep.
    """
    if len(text) > LARGEST_SURVEY or (len(text) > LARGEST and '"survey"' not in text[:400]):
        raise _wrong(f"the message has {len(text)} letters: too many", f"The most are {LARGEST}.", "E543")
    try:
        found = json.loads(text, parse_constant=_no_constant)
    except RecursionError:
        raise _wrong("the message is nested too deep", "", "E543") from None
    except ValueError as error:
        raise _wrong(f"the message is no JSON: {cut(printable(str(error)))}") from None
    if not isinstance(found, dict):
        raise _wrong("the message is no JSON object", 'Send {"id": 1, "do": "set", ...}.')
    _check_depth(found)
    if len(text) > LARGEST and found.get("do") != "survey":
        raise _wrong(f"the message has {len(text)} letters: too many", f"The most are {LARGEST}.", "E543")
    return found


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is no number of JSON")


def _check_depth(value: Any) -> None:
    level = [value]
    for _ in range(_DEEPEST):
        level = [
            below for one in level if isinstance(one, dict | list)
            for below in (one.values() if isinstance(one, dict) else one) if isinstance(below, dict | list)
        ]  # fmt: skip
        if not level:
            return
    raise _wrong(f"the message is nested more than {_DEEPEST} deep", "", "E543")


def text_of(message: Mapping[str, Any], key: str, default: str | None = None) -> str:
    """A text of a message. Raises DesignError E541 where there is none."""
    found = message.get(key, default)
    if not isinstance(found, str):
        raise _wrong(f"{message.get('do')} needs the text {key}")
    return found


def _values(message: Mapping[str, Any]) -> dict[str, Any]:
    values = message.get("values")
    if not isinstance(values, dict) or not values or len(values) > _MOST_VALUES:
        raise _wrong('set needs values: {"values": {path: value}}', f"At most {_MOST_VALUES} at once.")
    for path, value in values.items():
        if not isinstance(value, int | float | str | None) or isinstance(value, bool):
            raise _wrong(f"the value of {cut(printable(path))} is no number, text or null")
    return values


def written(message: Mapping[str, Any]) -> str:
    """A message as it is sent; lone surrogates, which no socket takes, in their escapes."""
    text = json.dumps(message, separators=(",", ":"), ensure_ascii=False, allow_nan=False, default=_of_numpy)
    try:
        text.encode()
    except UnicodeEncodeError:
        return json.dumps(message, separators=(",", ":"), allow_nan=False, default=_of_numpy)
    return text


def _of_numpy(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is no JSON")


# -- the app ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Wanted:
    """An answer that is asked for: by whom, and of which design."""

    link: "Link | None"
    message: Message
    moment: Moment
    final: bool
    more: Mapping[str, Any]


class Desk:
    """All that the links share: the session, the thread that analyses, what was answered last."""

    def __init__(self, opened: Opened, token: str, folder: Path | None = None, warm: bool = False) -> None:
        self.session = Session(opened)
        self.autosave = saving.Autosave(folder)
        self.jobs = jobs.Jobs()
        self.warm = warm
        self.slow = ThreadPoolExecutor(1, "slow")
        self.waiting = 0
        self.files: dict[str, handover.File] = {}
        self.survey: surveys.Dropped | None = None
        self.bolts: tuple[Moment, list[dict[str, Any]]] | None = None
        self.document: Mapping[str, Any] | None = None
        self.keeping: asyncio.TimerHandle | None = None
        self.token = token
        self.port = 0
        self.links: list[Link] = []
        self.thread = ThreadPoolExecutor(1, "analysis")
        self.next: Wanted | None = None
        self.working = False
        self.last: answers.Answer | None = None
        self.last_moment: Moment | None = None
        self.result: Result | None = None
        self.tasks: set[asyncio.Task[None]] = set()
        self.shape: Any = None

    # -- what is sent -------------------------------------------------------------------------------------------------

    def design(self) -> Message:
        """DESIGN of the contract."""
        session = self.session
        return {
            "of": "design", "rev": session.rev, "kind": session.design.kind, "title": session.design.title,
            "name": session.opened.name, "file": None if session.opened.path is None else str(session.opened.path),
            "live": session.live,
            "groups": controls.groups_of(session.shown, session.opened.design),
            "changed": session.changed, "can_undo": session.can_undo, "can_redo": session.can_redo,
            "jobs": jobs_of(session.design.kind),
        }  # fmt: skip

    def hello(self) -> Message:
        """The first message."""
        return {
            "of": "hello", "version": __version__, "unsaved": self.autosave.offered(),
            "templates": [
                {"name": name, "kind": _kind_of_template(name), "title": templates.summary(name)}
                for name in templates.names()
            ],
        }  # fmt: skip

    def structure(self) -> Any:
        """What the page has controls for: where it changes they are sent again."""
        return [(path, key.given) for path, key in self.session.numbers.items()]

    # -- analysis -----------------------------------------------------------------------------------------------------

    def ask(self, link: "Link", message: Message, final: bool = True, more: Mapping[str, Any] | None = None) -> None:
        """Answer for the present design: at once where it is not analysed now, else when the thread is free."""
        moment, live = self.session.now, self.session.live
        if moment.faults or live == "button" or (live == "release" and not final):
            last = None if self.last is None or self.last["rev"] < self.opened_rev else self.last
            said = answers.waiting(moment, final, last)
            analysed = None if self.last_moment is None else self.last_moment.document
            if last is not None and not moment.faults and analysed is moment.document:  # nothing has changed since
                said = last | {"rev": moment.rev, "final": final, "stale": False}
            self.tell_all(link, message, said, more or {})
            return
        if self.next is not None and self.next.link is not None:
            self.next.link.answer(self.next.message, {"superseded": True})
        self.next = Wanted(link, message, moment, final, more or {})
        if not self.working:
            self._analyse()

    opened_rev = 0

    def warm_up(self) -> None:
        """Have a process ready for jobs, so that the first does not wait for it."""
        if self.warm:
            self.slow.submit(self.jobs.warm, self.session.design.kind)

    def also_send(self, but: "Link", message: Message) -> None:
        """Tell the other pages that are open."""
        for link in self.links:
            if link is not but:
                link.send(message)

    def tell_all(self, link: "Link", message: Message, answer: answers.Answer, more: Mapping[str, Any]) -> None:
        """Answer a page, and the others too: no number of an earlier design stays on one of them."""
        said = {**self.also(answer), **more}
        link.answer(message, said)
        if message.get("do") is not None:
            self.also_send(link, {**said, "of": "answer"})

    def changed(self) -> None:
        """Keep what is not saved, when nothing has changed for a moment."""
        if self.keeping is not None:
            self.keeping.cancel()
        self.keeping = asyncio.get_running_loop().call_later(_KEPT_AFTER_S, self.autosave.keep, self.session)

    def set_aside(self) -> None:
        """Keep what is not saved of the design that another takes the place of: it is offered again."""
        if self.keeping is not None:
            self.keeping.cancel()
        self.autosave.keep(self.session)
        self.autosave.begin()

    def close(self) -> None:
        """Keep what is not saved, end what runs."""
        if self.keeping is not None:
            self.keeping.cancel()
        self.autosave.keep(self.session)
        self.jobs.close()
        for pool in (self.thread, self.slow):
            pool.shutdown(wait=False, cancel_futures=True)

    async def aside(self, link: "Link", message: Message, work: Callable[[], Message]) -> None:
        """Do something that takes a while beside the messages, and answer with what it returns."""
        try:
            found = await asyncio.get_running_loop().run_in_executor(self.slow, work)
            link.answer(message, found)
        except SlopekitError as error:
            link.refuse(message, error.faults)
        except Exception as error:  # a bug of ours: the page goes on
            link.refuse(message, (bug(error),))
        finally:
            self.waiting -= 1

    def later(self, link: "Link", message: Message, work: Callable[[], Message]) -> None:
        """The same, where not too much waits. Raises DesignError E544."""
        if self.waiting >= _MOST_SLOW:
            raise _wrong("too much waits already", "Wait for it.", "E544")
        self.waiting += 1
        self.start(self.aside(link, message, work))

    def result_document(self) -> Mapping[str, Any]:
        """The JSON of the result of the present design: in a thread.

        Raises
        ------
        DesignError
            E548 where a kind that is analysed on a button was not since it changed.
        """
        session = self.session
        if session.now.faults:
            raise DesignError(session.now.faults)
        if self.last_moment is not None and self.last_moment.document is session.now.document:
            if self.result is not None:
                return self.result.to_dict()
            if self.document is not None:
                return self.document
        if session.live == "button":
            raise _wrong("the design was not analysed since it changed", "Analyse it first.", "E548")
        from slopekit.kinds import analyse

        return analyse(session.design).to_dict()

    def start(self, work: Coroutine[Any, Any, None]) -> None:
        """Begin a piece of work beside the messages."""
        task = asyncio.get_running_loop().create_task(work)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)

    def _analyse(self) -> None:
        """Give the thread what waits."""
        wanted, self.next = self.next, None
        self.working = wanted is not None
        if wanted is not None:
            done = asyncio.get_running_loop().run_in_executor(self.thread, _analysed, wanted.moment, wanted.final)
            done.add_done_callback(partial(self._analysed, wanted))

    def _analysed(self, wanted: Wanted, done: "asyncio.Future[tuple[answers.Answer, Result | None]]") -> None:
        """Begin with the next, then answer this one."""
        if done.cancelled():  # the server ends
            return
        answer, result = done.result()
        if result is not None and wanted.moment.rev >= self.opened_rev:
            self.last, self.result, self.last_moment = answer, result, wanted.moment
            self.document = None
        self._analyse()
        if wanted.link is not None:
            self.tell_all(wanted.link, wanted.message, answer, wanted.more)

    def also(self, answer: answers.Answer) -> answers.Answer:
        """An answer with what the page needs to know of undo."""
        session = self.session
        return answer | {"can_undo": session.can_undo, "can_redo": session.can_redo, "changed": session.changed}


def _analysed(moment: Moment, final: bool) -> tuple[answers.Answer, Result | None]:
    """In the thread: an answer, whatever happens."""
    try:
        return answers.analysed(moment, final)
    except Exception as error:  # a bug of ours: it is said on the page, and the next value may do
        fault = bug(error)
        return answers.faulty(moment, (fault,), final), None


def bug(error: Exception) -> Fault:
    """E599 of what nobody foresaw, as the command line says it."""
    message = f"a bug of ours: {type(error).__name__}: {cut(printable(str(error)))}"
    return Fault("E599", message, "", "Please send us the design with this text.")


def jobs_of(kind: str) -> list[str]:
    """The jobs that can be started with a kind of design."""
    found = ["analyse", "curve", "probability"]
    return [*found, "support"] if kind in ("wedge", "plane", "topple") else found


def _kind_of_template(name: str) -> str:
    for line in templates.path_of(name).read_text(encoding="utf-8").splitlines():
        if line.startswith("kind:"):
            return line.removeprefix("kind:").partition("#")[0].strip()
    return ""


class Link:
    """One page that is open."""

    def __init__(self, desk: Desk, socket: WebSocket) -> None:
        self.desk, self.socket = desk, socket
        self.out: asyncio.Queue[str] = asyncio.Queue()

    def send(self, message: Mapping[str, Any]) -> None:
        """Send a message, after those before it."""
        self.out.put_nowait(written(message))

    def answer(self, message: Message, found: Mapping[str, Any]) -> None:
        """Send what came of a message; without an id it is an event."""
        head = {"id": message["id"], "of": message.get("do")} if message.get("id") is not None else {"of": "answer"}
        self.send({**found, **head})

    def refuse(self, message: Message, faults: tuple[Fault, ...]) -> None:
        """Say what is wrong with a message."""
        root = self.desk.session.now.document.root
        said: Message = {"of": _word(message.get("do")), "faults": [answers.fault_of(fault, root) for fault in faults]}
        values = message.get("values")
        if said["of"] == "set" and isinstance(values, dict):  # nothing was changed: what the boxes hold then
            said["kept"] = self.desk.session.values_at(list(values)[:_MOST_VALUES])
        number = message.get("id")
        self.send({"id": number, **said} if isinstance(number, int | float | str) else said)

    async def run(self) -> None:
        """Greet, then answer messages until the page is closed."""
        writer = asyncio.get_running_loop().create_task(self._write())
        try:
            self.send(self.desk.hello())
            self.send(self.desk.design())
            self.desk.shape = self.desk.structure()
            self.desk.ask(self, {})
            self.desk.warm_up()
            while True:
                got = await self.socket.receive()
                if got["type"] == "websocket.disconnect":
                    return
                self.heard(got.get("text"))
        finally:
            writer.cancel()

    async def _write(self) -> None:
        while True:
            await self.socket.send_text(await self.out.get())

    def heard(self, text: str | None) -> None:
        """Answer one message, by faults where it is none."""
        message: Message = {}
        try:
            if text is None:
                raise _wrong("the message is no text")
            message = parsed(text)
            do = VERBS.get(_word(message.get("do")))
            if do is None:
                raise _wrong(f"{cut(printable(repr(message.get('do'))))} is nothing to do", "", "E542")
            do(self, message)
        except SlopekitError as error:
            self.refuse(message, error.faults)
        except Exception as error:  # a bug of ours: the page goes on
            self.refuse(message, (bug(error),))


def _word(value: Any) -> str:
    return value if isinstance(value, str) and len(value) < 40 else ""


# -- what a page may ask ----------------------------------------------------------------------------------------------


def _set(link: Link, message: Message) -> None:
    desk, final = link.desk, message.get("final", True) is not False
    values = _values(message)
    desk.session.set(values, final)
    if final:
        desk.changed()
    if not desk.session.now.faults and (shape := desk.structure()) != desk.shape:
        desk.shape = shape
        link.send(desk.design())
        desk.also_send(link, desk.design())
    desk.ask(link, message, final, {"values": desk.session.values_at(values)})


def _changed(link: Link, message: Message) -> None:
    """Send the controls, and ask for an answer."""
    desk = link.desk
    desk.shape = desk.structure()
    desk.changed()
    link.send(desk.design())
    desk.also_send(link, desk.design())
    desk.ask(link, message)


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
    desk = link.desk
    if "template" in message:
        opened = opened_template(text_of(message, "template"))
    elif "yaml" in message:
        opened = opened_text(text_of(message, "yaml"), _name(text_of(message, "name", "design.yaml")))
    elif "pair" in message:
        if desk.survey is None:
            raise _wrong("no survey was dropped", "Drop a joint list first.", "E548")
        number = message["pair"]
        if not isinstance(number, int) or isinstance(number, bool):
            raise _wrong("pair needs the number of a pair")
        opened = opened_text(desk.survey.design_of_pair(number), "pair.yaml")
    elif "unsaved" in message:
        desk.set_aside()
        desk.autosave.taken(text_of(message, "unsaved"), desk.session)
        _forget(desk)
        _changed(link, message)
        link.send(desk.hello())
        return
    else:
        raise _wrong("open needs a template, a yaml, a pair or what was not saved")
    take(desk, opened)
    _changed(link, message)
    link.send(desk.hello())


def take(desk: Desk, opened: Opened) -> None:
    """Work on another design."""
    desk.set_aside()
    desk.session.open(opened)
    _forget(desk)


def _forget(desk: Desk) -> None:
    """Forget what was said of another design."""
    desk.last = desk.result = desk.document = desk.last_moment = desk.bolts = None
    desk.opened_rev = desk.session.opened_rev


def _name(name: str) -> str:
    """The name of a file, without its folders."""
    last = name.replace("\\", "/").rpartition("/")[2]
    return cut(printable(last)) or "design.yaml"


def _start(link: Link, message: Message) -> None:
    desk, what = link.desk, text_of(message, "job")
    moment = desk.session.now
    if moment.faults:
        raise DesignError(moment.faults)
    loop = asyncio.get_running_loop()

    def heard(event: Message) -> None:
        loop.call_soon_threadsafe(_of_job, link, what, moment, event)

    options = {key: value for key, value in message.items() if key not in ("id", "do", "job")}
    link.answer(message, {"job": desk.jobs.start(what, moment, options, heard)})


def _analyse(link: Link, message: Message) -> None:
    _start(link, {**message, "job": "analyse"})


def _of_job(link: Link, what: str, moment: Moment, event: Message) -> None:
    """Pass on what a job says; an analysis is the answer from now on."""
    desk = link.desk
    if what == "analyse" and (found := event.get("result")) is not None:
        answer = found.pop("answer")
        if found["document"] is not None and answer["rev"] >= desk.opened_rev:
            desk.last, desk.result, desk.document, desk.last_moment = answer, None, found["document"], moment
        answer["stale"] = desk.session.now.document is not moment.document
        desk.also_send(link, desk.also(answer) | {"of": "answer"})
        event = event | {"result": desk.also(answer)}
    if what == "support" and (found := event.get("result")) is not None:
        desk.bolts = (moment, found["bolts"]) if found["bolts"] else None
    link.send(event)
    if event["of"] == "done" and event.get("cancelled"):
        desk.warm_up()


def _cancel(link: Link, message: Message) -> None:
    number = message.get("job")
    if not isinstance(number, int) or isinstance(number, bool):
        raise _wrong("cancel needs the number of a job")
    desk = link.desk
    if number != desk.jobs.running:
        raise _wrong("this job does not run", "", "E544")
    desk.start(_ended(link, message, number))


async def _ended(link: Link, message: Message, number: int) -> None:
    try:
        await asyncio.get_running_loop().run_in_executor(None, link.desk.jobs.cancel, number)
        link.answer(message, {})
    except DesignError as error:  # it ended by itself meanwhile
        link.refuse(message, error.faults)


def _survey(link: Link, message: Message) -> None:
    desk, design = link.desk, link.desk.session.design
    name, text = _name(text_of(message, "name", "survey.csv")), text_of(message, "text")
    c, phi = (jobs.number_in(message, key, None) for key in ("c", "phi"))

    def work() -> Message:
        desk.survey = surveys.dropped(design, name, text, c, phi)
        return desk.survey.said

    desk.later(link, message, work)


def _add_bolts(link: Link, message: Message) -> None:
    desk = link.desk
    if not desk.bolts:
        raise _wrong("there are no bolts to add: none were looked for, or none give the factor", "", "E548")
    found_for, bolts = desk.bolts
    if found_for.document is not desk.session.now.document:
        raise _wrong("the bolts were found for an earlier design", "Find them again.", "E549")
    desk.session.put("support.bolts", bolts)
    _changed(link, message)


def _file_of(message: Message) -> str | None:
    return text_of(message, "file").strip() or None if message.get("file") is not None else None


def _diff(link: Link, message: Message) -> None:
    change = saving.change_of(link.desk.session, _file_of(message))
    link.answer(message, {
        "diff": change.diff, "file": None if change.target is None else str(change.target),
        "changed_on_disk": change.changed_on_disk, "lines": change.lines,
    })  # fmt: skip


def _save(link: Link, message: Message) -> None:
    desk = link.desk
    target = saving.save(desk.session, _file_of(message), text_of(message, "seen"))
    if desk.last_moment is not None and desk.last_moment.rev == desk.session.rev:
        desk.last_moment = desk.session.now
    desk.shape = desk.structure()
    desk.changed()
    link.answer(message, {"file": str(target)})
    link.send(desk.design())
    desk.also_send(link, desk.design())


def _handover(link: Link, message: Message) -> None:
    desk, what = link.desk, text_of(message, "what")
    if what == "command":
        text, note = handover.command_of(desk.session), handover.note_of(desk.session)
        link.answer(message, {"text": text, "note": note})
        return

    def work() -> Message:
        found = handover.handed(what, desk.session, None if what == "yaml" else desk.result_document())
        number = secrets.token_urlsafe(9)
        desk.files[number] = found
        for old in list(desk.files)[:-_MOST_FILES]:
            del desk.files[old]
        return {"address": f"/{desk.token}/get/{number}", "name": found.name}

    desk.later(link, message, work)


#: What each word does.
VERBS: dict[str, Callable[[Link, Message], None]] = {
    "set": _set, "undo": _undo, "redo": _redo, "reset": _reset, "open": _open, "start": _start, "analyse": _analyse,
    "cancel": _cancel, "survey": _survey, "add_bolts": _add_bolts, "diff": _diff, "save": _save,
    "handover": _handover,
}  # fmt: skip


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
        found = _asset(request.path_params["name"])
        if found is None:
            return PlainTextResponse("there is no such file", 404, HEADERS)
        return Response(found.read_bytes(), media_type=_TYPES[found.suffix], headers=HEADERS)

    async def get(request: Request) -> Response:
        found = desk.files.get(request.path_params["number"])
        if found is None:
            return PlainTextResponse("it is there no more", 404, HEADERS)
        named = {"Content-Disposition": f"attachment; filename*=UTF-8''{quote(found.name, safe='')}"}
        return Response(found.content, media_type=found.kind, headers=HEADERS | named)

    async def socket(websocket: WebSocket) -> None:
        if len(desk.links) >= _MOST_LINKS:
            await websocket.close(4429, "too many pages are open")
            return
        await websocket.accept()
        link = Link(desk, websocket)
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
