"""The pages that are open and the state they share: one design, and the thread that analyses it.

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
from slopekit.app.messages import MOST_VALUES, Message, fault_of_bug, message_error, parsed, written
from slopekit.app.session import Moment, Opened, Session
from slopekit.core.errors import DesignError, Fault, SlopekitError
from slopekit.design import templates
from slopekit.design.reading.nodes import cut, printable
from slopekit.kinds import analyse, kind_named
from slopekit.result import Result

T = TypeVar("T")
_MOST_SLOW = 4  # surveys and files to hand over that wait
_KEPT_AFTER_S = 1.0  # of rest, what is not saved is kept
_MOST_READERS = 12  # threads that read and write files: one for each page, and some to spare
MOST_A_SECOND = 500  # messages of one page: what comes faster waits


@dataclass(frozen=True)
class AnalysisRequest:
    """A request for an analysis: the page, its message, and the design at that moment."""

    link: "Link | None"
    message: Message
    moment: Moment
    final: bool
    more: Mapping[str, Any]


class Desk:
    """The state that all pages share: the session, the thread of analyses, the last answer."""

    def __init__(
        self, opened: Opened, token: str, folder: Path | None = None, warm: bool = False
    ) -> None:
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
        self.survey: surveys.DroppedSurvey | None = None
        self.bolts: tuple[Moment, list[dict[str, Any]]] | None = None
        self.document: Mapping[str, Any] | None = None
        self.keeping: asyncio.TimerHandle | None = None
        self.token = token
        self.port = 0
        self.links: list[Link] = []
        self.thread = ThreadPoolExecutor(1, "analysis")
        self.next: AnalysisRequest | None = None
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
            "of": "design",
            "rev": session.rev,
            "kind": session.design.kind,
            "title": session.design.title,
            "name": session.opened.name,
            "file": None if session.opened.path is None else str(session.opened.path),
            "live": session.live,
            "groups": controls.groups_of(session.displayed_design, session.opened.design),
            "changed": session.changed,
            "can_undo": session.can_undo,
            "can_redo": session.can_redo,
            "jobs": jobs_of(session.design.kind),
        }

    def hello(self) -> Message:
        """The first message."""
        return {
            "of": "hello",
            "version": __version__,
            "unsaved": self.autosave.offered(),
            "templates": [
                {"name": name, "kind": _kind_of_template(name), "title": templates.summary(name)}
                for name in templates.names()
            ],
        }

    def structure(self) -> Any:
        """Return the paths of the controls and whether each is given: where this changes, controls are sent again."""
        return [(path, key.given) for path, key in self.session.numbers.items()]

    # -- analysis -----------------------------------------------------------------------------------------------------

    def ask(
        self,
        link: "Link",
        message: Message,
        final: bool = True,
        more: Mapping[str, Any] | None = None,
    ) -> None:
        """Answer for the present design: at once where it needs no analysis now, else when the thread is free."""
        moment, live = self.session.moment, self.session.live
        if moment.faults or live == "button" or (live == "release" and not final):
            last = None if self.last is None or self.last["rev"] < self.opened_rev else self.last
            answer = answers.answer_before_analysis(moment, final, last)
            analysed = None if self.last_moment is None else self.last_moment.document
            if (
                last is not None and not moment.faults and analysed is moment.document
            ):  # nothing has changed since
                answer = last | {"rev": moment.rev, "final": final, "stale": False}
            self.tell_all(link, message, answer, more or {})
            return
        if self.next is not None and self.next.link is not None:
            self.next.link.answer(self.next.message, {"superseded": True})
        self.next = AnalysisRequest(link, message, moment, final, more or {})
        if not self.working:
            self._analyse()

    opened_rev = 0

    def warm_up(self) -> None:
        """Have a process ready for jobs, so that the first does not wait for it."""
        if self.warm:
            self.slow.submit(self.jobs.warm, self.session.design.kind)

    def show(self, link: "Link") -> None:
        """Send a page and the others the design with its controls."""
        self.shape, message = self.structure(), self.design()
        link.send(message)
        self.also_send(link, message)

    def also_send(self, but: "Link", message: Message) -> None:
        """Tell the other pages that are open."""
        for link in self.links:
            if link is not but:
                link.send(message)

    def tell_all(
        self, link: "Link", message: Message, answer: answers.Answer, more: Mapping[str, Any]
    ) -> None:
        """Answer a page and send the answer to the others: none keeps numbers of an earlier design."""
        body = {**self.with_undo_state(answer), **more}
        link.answer(message, body)
        if message.get("do") is not None:
            self.also_send(link, {**body, "of": "answer"})

    def changed(self) -> None:
        """Autosave the design when nothing has changed for a moment."""
        if self.keeping is not None:
            self.keeping.cancel()
        self.keeping = asyncio.get_running_loop().call_later(_KEPT_AFTER_S, self.keep)

    def keep(self) -> "Future[None]":
        """Autosave a snapshot of the design in a thread."""
        return self.keeper.submit(self.autosave.keep, self.session.snapshot(), self.autosave.file)

    def set_aside(self) -> "Future[None]":
        """Autosave the design that another replaces: it is offered again."""
        if self.keeping is not None:
            self.keeping.cancel()
        future = self.keep()
        self.autosave.begin()
        return future

    def close(self) -> None:
        """Autosave the design and end all threads and jobs."""
        if self.keeping is not None:
            self.keeping.cancel()
        self.keeper.shutdown()
        self.autosave.keep(self.session)
        self.jobs.close()
        for pool in (self.thread, self.slow, self.readers):
            pool.shutdown(wait=False, cancel_futures=True)

    async def run_in_thread(
        self,
        link: "Link",
        message: Message,
        pool: ThreadPoolExecutor,
        work: Callable[[], T],
        finish: Callable[[T], Coroutine[Any, Any, None]],
    ) -> None:
        """Run `work` in a thread of a pool, then `finish` in the event loop; faults are sent to the page."""
        try:
            await finish(await asyncio.get_running_loop().run_in_executor(pool, work))
        except SlopekitError as error:
            link.refuse(message, error.faults)
        except Exception as error:  # a bug of ours: the page goes on
            link.refuse(message, (fault_of_bug(error),))

    def later(self, link: "Link", message: Message, work: Callable[[], Message]) -> None:
        """Answer by slow work beside the messages. Raises DesignError E544 where too much waits already."""
        if self.waiting >= _MOST_SLOW:
            raise message_error("too much waits already", "Wait for it.", "E544")
        self.waiting += 1
        self.start(
            self.run_in_thread(link, message, self.slow, work, link.answering(message))
        ).add_done_callback(self._done)

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
        if session.moment.faults:
            raise DesignError(session.moment.faults)
        if self.last_moment is not None and self.last_moment.document is session.moment.document:
            if self.result is not None:
                return self.result.to_dict()
            if self.document is not None:
                return self.document
        if session.live == "button":
            raise message_error(
                "the design was not analysed since it changed", "Analyse it first.", "E548"
            )
        return analyse(session.design).to_dict()

    def start(self, work: Coroutine[Any, Any, None]) -> "asyncio.Task[None]":
        """Begin a piece of work beside the messages."""
        task = asyncio.get_running_loop().create_task(work)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)
        return task

    def _analyse(self) -> None:
        """Start the analysis of the newest request, if one waits."""
        request, self.next = self.next, None
        self.working = request is not None
        if request is not None:
            done = asyncio.get_running_loop().run_in_executor(
                self.thread, _analysed, request.moment, request.final
            )
            done.add_done_callback(partial(self._analysed, request))

    def _analysed(
        self, request: AnalysisRequest, done: "asyncio.Future[tuple[answers.Answer, Result | None]]"
    ) -> None:
        """Start the next analysis, then answer this request."""
        if done.cancelled():  # the server ends
            return
        answer, result = done.result()
        if result is not None and request.moment.rev >= self.opened_rev:
            self.last, self.result, self.last_moment = answer, result, request.moment
            self.document = None
        self._analyse()
        if request.link is not None:
            self.tell_all(request.link, request.message, answer, request.more)

    def with_undo_state(self, answer: answers.Answer) -> answers.Answer:
        """Return an answer with the state of undo and redo."""
        session = self.session
        return answer | {
            "can_undo": session.can_undo,
            "can_redo": session.can_redo,
            "changed": session.changed,
        }


def _analysed(moment: Moment, final: bool) -> tuple[answers.Answer, Result | None]:
    """In the thread: an answer, whatever happens."""
    try:
        return answers.analysed_answer(moment, final)
    except Exception as error:  # a bug of ours: it is said on the page, and the next value may do
        return answers.answer_of_faults(moment, (fault_of_bug(error),), final), None


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

    def __init__(
        self, desk: Desk, socket: WebSocket, verbs: Mapping[str, Callable[["Link", Message], None]]
    ) -> None:
        self.desk, self.socket, self.verbs = desk, socket, verbs
        self.outbox: asyncio.Queue[str] = asyncio.Queue()
        self.turn: asyncio.Task[None] | None = None
        self.begin_of_second, self.in_second = 0.0, 0

    def in_turn(
        self,
        message: Message,
        work: Callable[[], T],
        finish: Callable[[T], Coroutine[Any, Any, None]],
    ) -> None:
        """Read or write a file in a thread; later messages of this page wait, other pages go on."""
        self.turn = self.desk.start(
            self.desk.run_in_thread(self, message, self.desk.readers, work, finish)
        )

    def send(self, message: Mapping[str, Any]) -> None:
        """Send a message, after those before it."""
        self.outbox.put_nowait(written(message))

    def answer(self, message: Message, body: Mapping[str, Any]) -> None:
        """Send what came of a message; without an id it is an event."""
        head = (
            {"id": message["id"], "of": message.get("do")}
            if message.get("id") is not None
            else {"of": "answer"}
        )
        self.send({**body, **head})

    def answering(
        self, message: Message
    ) -> Callable[[Mapping[str, Any]], Coroutine[Any, Any, None]]:
        """Return the coroutine function that answers a message with a body, for `Desk.run_in_thread`."""

        async def answer(body: Mapping[str, Any]) -> None:
            self.answer(message, body)

        return answer

    def refuse(self, message: Message, faults: tuple[Fault, ...]) -> None:
        """Say what is wrong with a message."""
        root = self.desk.session.moment.document.root
        reply: Message = {
            "of": _word(message.get("do")),
            "faults": [answers.fault_of(fault, root) for fault in faults],
        }
        values = message.get("values")
        if reply["of"] == "set" and isinstance(
            values, dict
        ):  # nothing was changed: what the boxes hold then
            reply["kept"] = self.desk.session.values_at(list(values)[:MOST_VALUES])
        number = message.get("id")
        self.send({"id": number, **reply} if isinstance(number, int | float | str) else reply)

    async def run(self) -> None:
        """Greet, then answer messages until the page is closed."""
        writer = asyncio.get_running_loop().create_task(self._write())
        try:
            self.send(
                await asyncio.get_running_loop().run_in_executor(self.desk.readers, self.desk.hello)
            )
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
        """Wait where a page sends more messages a second than allowed: the others have their turn."""
        time_s = asyncio.get_running_loop().time()
        if time_s - self.begin_of_second >= 1.0:
            self.begin_of_second, self.in_second = time_s, 0
        self.in_second += 1
        if self.in_second > self.desk.most_a_second:
            await asyncio.sleep(self.begin_of_second + 1.0 - time_s)

    async def _write(self) -> None:
        while True:
            await self.socket.send_text(await self.outbox.get())

    def heard(self, text: str | None) -> None:
        """Answer one message, by faults where it is none."""
        message: Message = {}
        try:
            if text is None:
                raise message_error("the message is no text")
            message = parsed(text)
            do = self.verbs.get(_word(message.get("do")))
            if do is None:
                raise message_error(
                    f"{cut(printable(repr(message.get('do'))))} is nothing to do", "", "E541"
                )
            do(self, message)
        except SlopekitError as error:
            self.refuse(message, error.faults)
        except Exception as error:  # a bug of ours: the page goes on
            self.refuse(message, (fault_of_bug(error),))


def _word(value: Any) -> str:
    return value if isinstance(value, str) and len(value) < 40 else ""
