"""Who is connected and what they share: one design, the thread that analyses it, the pages that are open.

A change is taken at once; a thread analyses it, and while it does only the newest request waits.
"""

import asyncio
import threading
from collections.abc import Callable, Coroutine, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from starlette.websockets import WebSocket

from slopekit._version import __version__
from slopekit.app import answers, controls, handover, jobs, saving, surveys
from slopekit.app.messages import MOST_VALUES, Message, bug, parsed, written, wrong
from slopekit.app.session import Moment, Opened, Session
from slopekit.core.errors import DesignError, Fault, SlopekitError
from slopekit.design import templates
from slopekit.design.reading.nodes import cut, printable
from slopekit.kinds import kind_named
from slopekit.result import Result

T = TypeVar("T")
_MOST_SLOW = 4  # surveys and files to hand over that wait
_KEPT_AFTER_S = 1.0  # of rest, what is not saved is kept
_MOST_READERS = 12  # threads that read and write files: one for each page, and some to spare
MOST_A_SECOND = 500  # messages of one page: what comes faster waits


@dataclass(frozen=True)
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
        self.readers = ThreadPoolExecutor(_MOST_READERS, "reader")
        self.keeper = ThreadPoolExecutor(1, "keeper")
        self.saving = threading.Lock()
        self.most_a_second = MOST_A_SECOND
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

    def show(self, link: "Link") -> None:
        """Send a page and the others the design with its controls."""
        self.shape, shown = self.structure(), self.design()
        link.send(shown)
        self.also_send(link, shown)

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
        self.keeping = asyncio.get_running_loop().call_later(_KEPT_AFTER_S, self.keep)

    def keep(self) -> "Future[None]":
        """Keep what is not saved as it is at this moment: in a thread, one after the other."""
        return self.keeper.submit(self.autosave.keep, self.session.snapshot(), self.autosave.file)

    def set_aside(self) -> "Future[None]":
        """Keep what is not saved of the design that another takes the place of: it is offered again."""
        if self.keeping is not None:
            self.keeping.cancel()
        kept = self.keep()
        self.autosave.begin()
        return kept

    def close(self) -> None:
        """Keep what is not saved, end what runs."""
        if self.keeping is not None:
            self.keeping.cancel()
        self.keeper.shutdown()
        self.autosave.keep(self.session)
        self.jobs.close()
        for pool in (self.thread, self.slow, self.readers):
            pool.shutdown(wait=False, cancel_futures=True)

    async def apart(
        self, link: "Link", message: Message, pool: ThreadPoolExecutor, work: Callable[[], T],
        then: Callable[[T], Coroutine[Any, Any, None]],
    ) -> None:  # fmt: skip
        """Do something in a thread of a pool, then the rest of it here; faults are said to the page."""
        try:
            await then(await asyncio.get_running_loop().run_in_executor(pool, work))
        except SlopekitError as error:
            link.refuse(message, error.faults)
        except Exception as error:  # a bug of ours: the page goes on
            link.refuse(message, (bug(error),))

    def later(self, link: "Link", message: Message, work: Callable[[], Message]) -> None:
        """Answer with what takes a while beside the messages, where not too much waits. Raises DesignError E544."""
        if self.waiting >= _MOST_SLOW:
            raise wrong("too much waits already", "Wait for it.", "E544")
        self.waiting += 1
        self.start(self.apart(link, message, self.slow, work, link.answering(message))).add_done_callback(self._done)

    def _done(self, _: "asyncio.Task[None]") -> None:
        self.waiting -= 1

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
            raise wrong("the design was not analysed since it changed", "Analyse it first.", "E548")
        from slopekit.kinds import analyse

        return analyse(session.design).to_dict()

    def start(self, work: Coroutine[Any, Any, None]) -> "asyncio.Task[None]":
        """Begin a piece of work beside the messages."""
        task = asyncio.get_running_loop().create_task(work)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)
        return task

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
        return answers.faulty(moment, (bug(error),), final), None


def jobs_of(kind: str) -> list[str]:
    """The jobs that can be started with a kind of design."""
    job_names = ["analyse", "curve", "probability"]
    return [*job_names, "support"] if kind_named(kind).on_arrays is not None else job_names


def _kind_of_template(name: str) -> str:
    for line in templates.path_of(name).read_text(encoding="utf-8").splitlines():
        if line.startswith("kind:"):
            return line.removeprefix("kind:").partition("#")[0].strip()
    return ""


class Link:
    """One page that is open."""

    def __init__(self, desk: Desk, socket: WebSocket, verbs: Mapping[str, Callable[["Link", Message], None]]) -> None:
        self.desk, self.socket, self.verbs = desk, socket, verbs
        self.out: asyncio.Queue[str] = asyncio.Queue()
        self.turn: asyncio.Task[None] | None = None
        self.begin_of_second, self.in_second = 0.0, 0

    def in_turn(self, message: Message, work: Callable[[], T], then: Callable[[T], Coroutine[Any, Any, None]]) -> None:
        """Read or write a file in a thread, then do the rest; what this page says behind it waits, others go on."""
        self.turn = self.desk.start(self.desk.apart(self, message, self.desk.readers, work, then))

    def send(self, message: Mapping[str, Any]) -> None:
        """Send a message, after those before it."""
        self.out.put_nowait(written(message))

    def answer(self, message: Message, body: Mapping[str, Any]) -> None:
        """Send what came of a message; without an id it is an event."""
        head = {"id": message["id"], "of": message.get("do")} if message.get("id") is not None else {"of": "answer"}
        self.send({**body, **head})

    def answering(self, message: Message) -> Callable[[Mapping[str, Any]], Coroutine[Any, Any, None]]:
        """Return what answers a message with a body, for `Desk.apart`."""

        async def answer(body: Mapping[str, Any]) -> None:
            self.answer(message, body)

        return answer

    def refuse(self, message: Message, faults: tuple[Fault, ...]) -> None:
        """Say what is wrong with a message."""
        root = self.desk.session.now.document.root
        said: Message = {"of": _word(message.get("do")), "faults": [answers.fault_of(fault, root) for fault in faults]}
        values = message.get("values")
        if said["of"] == "set" and isinstance(values, dict):  # nothing was changed: what the boxes hold then
            said["kept"] = self.desk.session.values_at(list(values)[:MOST_VALUES])
        number = message.get("id")
        self.send({"id": number, **said} if isinstance(number, int | float | str) else said)

    async def run(self) -> None:
        """Greet, then answer messages until the page is closed."""
        writer = asyncio.get_running_loop().create_task(self._write())
        try:
            self.send(await asyncio.get_running_loop().run_in_executor(self.desk.readers, self.desk.hello))
            self.send(self.desk.design())
            self.desk.shape = self.desk.structure()
            self.desk.ask(self, {})
            self.desk.warm_up()
            while True:
                got = await self.socket.receive()
                if got["type"] == "websocket.disconnect":
                    return
                await self._pace()
                self.heard(got.get("text"))
                if self.turn is not None:
                    await asyncio.wait({self.turn})
                    self.turn = None
        finally:
            writer.cancel()

    async def _pace(self) -> None:
        """Let what comes faster than so many a second wait for the next: others have their turn."""
        now = asyncio.get_running_loop().time()
        if now - self.begin_of_second >= 1.0:
            self.begin_of_second, self.in_second = now, 0
        self.in_second += 1
        if self.in_second > self.desk.most_a_second:
            await asyncio.sleep(self.begin_of_second + 1.0 - now)

    async def _write(self) -> None:
        while True:
            await self.socket.send_text(await self.out.get())

    def heard(self, text: str | None) -> None:
        """Answer one message, by faults where it is none."""
        message: Message = {}
        try:
            if text is None:
                raise wrong("the message is no text")
            message = parsed(text)
            do = self.verbs.get(_word(message.get("do")))
            if do is None:
                raise wrong(f"{cut(printable(repr(message.get('do'))))} is nothing to do", "", "E541")
            do(self, message)
        except SlopekitError as error:
            self.refuse(message, error.faults)
        except Exception as error:  # a bug of ours: the page goes on
            self.refuse(message, (bug(error),))


def _word(value: Any) -> str:
    return value if isinstance(value, str) and len(value) < 40 else ""
