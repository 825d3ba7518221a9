"""What a page may ask over its socket: each word of a message and what it does. docs/howto/app.md lists them."""

import asyncio
import secrets
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from pathlib import Path

from slopekit.app import handover, jobs, saving, surveys
from slopekit.app.desk import Desk, Link
from slopekit.app.messages import Message, text_of, values_of, wrong
from slopekit.app.session import Moment, Opened, Session, opened_template, opened_text
from slopekit.core.errors import DesignError
from slopekit.design.reading.nodes import cut, printable

_MOST_FILES = 8  # that can be downloaded


def _set(link: Link, message: Message) -> None:
    desk, final = link.desk, message.get("final", True) is not False
    values = values_of(message)
    desk.session.set(values, final)
    if final:
        desk.changed()
    if not desk.session.now.faults and desk.structure() != desk.shape:
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
        kept = take(link.desk, opened)
        await _greeted(link, message, kept)

    if "unsaved" in message:
        _open_unsaved(link, message, text_of(message, "unsaved"))
    else:
        link.in_turn(message, _reading(link.desk, message), opened_in_thread)


def _reading(desk: Desk, message: Message) -> Callable[[], Opened]:
    """What reads the design that a message opens: in a thread."""
    if "template" in message:
        return partial(opened_template, text_of(message, "template"))
    if "yaml" in message:
        return partial(opened_text, text_of(message, "yaml"), _name(text_of(message, "name", "design.yaml")))
    if "pair" in message:
        if desk.survey is None:
            raise wrong("no survey was dropped", "Drop a joint list first.", "E548")
        number = message["pair"]
        if not isinstance(number, int) or isinstance(number, bool):
            raise wrong("pair needs the number of a pair")
        return partial(opened_text, desk.survey.design_of_pair(number), "pair.yaml")
    raise wrong("open needs a template, a yaml, a pair or what was not saved")


def _open_unsaved(link: Link, message: Message, number: str) -> None:
    """Go on with what was kept under a number."""
    desk = link.desk

    def work() -> Session:
        found = desk.session.snapshot()
        saving.Autosave(desk.autosave.folder).taken(number, found)
        return found

    async def opened_in_thread(found: Session) -> None:
        kept = take(desk, found.opened)
        desk.session.restore(found.now.document)
        desk.autosave.number = number
        await _greeted(link, message, kept)

    link.in_turn(message, work, opened_in_thread)


async def _greeted(link: Link, message: Message, kept: "Future[None]") -> None:
    """Show what was opened; greet again when what it took the place of is kept, which is offered then."""
    _changed(link, message)
    await asyncio.wrap_future(kept)
    link.send(await asyncio.get_running_loop().run_in_executor(link.desk.readers, link.desk.hello))


def take(desk: Desk, opened: Opened) -> "Future[None]":
    """Work on another design; done when what it takes the place of is kept."""
    kept = desk.set_aside()
    desk.session.open(opened)
    _forget(desk)
    return kept


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
    if what == "analyse" and (job_result := event.get("result")) is not None:
        answer = job_result.pop("answer")
        if job_result["document"] is not None and answer["rev"] >= desk.opened_rev:
            desk.last, desk.result, desk.document, desk.last_moment = answer, None, job_result["document"], moment
        answer["stale"] = desk.session.now.document is not moment.document
        desk.also_send(link, desk.also(answer) | {"of": "answer"})
        event = event | {"result": desk.also(answer)}
    if what == "support" and (job_result := event.get("result")) is not None:
        desk.bolts = (moment, job_result["bolts"]) if job_result["bolts"] else None
    link.send(event)
    if event["of"] == "done" and event.get("cancelled"):
        desk.warm_up()


def _cancel(link: Link, message: Message) -> None:
    number = message.get("job")
    if not isinstance(number, int) or isinstance(number, bool):
        raise wrong("cancel needs the number of a job")
    desk = link.desk
    if number != desk.jobs.running:
        raise wrong("this job does not run", "", "E544")
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
    columns, skip_bad = text_of(message, "columns", "") or None, message.get("skip_bad") is True

    def work() -> Message:
        desk.survey = surveys.dropped(design, name, text, c, phi, columns=columns, skip_bad=skip_bad)
        return desk.survey.said

    desk.later(link, message, work)


def _add_bolts(link: Link, message: Message) -> None:
    desk = link.desk
    if not desk.bolts:
        raise wrong("there are no bolts to add: none were looked for, or none give the factor", "", "E548")
    found_for, bolts = desk.bolts
    if found_for.document is not desk.session.now.document:
        raise wrong("the bolts were found for an earlier design", "Find them again.", "E545")
    desk.session.put("support.bolts", bolts)
    _changed(link, message)


def _file_of(message: Message) -> str | None:
    return text_of(message, "file").strip() or None if message.get("file") is not None else None


def _diff(link: Link, message: Message) -> None:
    async def answer(change: saving.SavedChange) -> None:
        link.answer(message, {
            "diff": change.diff, "file": None if change.target is None else str(change.target),
            "changed_on_disk": change.changed_on_disk, "lines": change.lines,
        })  # fmt: skip

    link.in_turn(message, partial(saving.change_of, link.desk.session.snapshot(), _file_of(message)), answer)


def _save(link: Link, message: Message) -> None:
    desk, file, seen = link.desk, _file_of(message), text_of(message, "seen")
    snapshot, before = desk.session.snapshot(), desk.session.now

    def work() -> Path:
        with desk.saving:
            return saving.save(snapshot, file, seen)

    async def saved(target: Path) -> None:
        desk.session.saved_of(snapshot, before)
        if desk.last_moment is not None and desk.last_moment.rev == desk.session.rev:
            desk.last_moment = desk.session.now
        desk.changed()
        link.answer(message, {"file": str(target)})
        desk.show(link)

    link.in_turn(message, work, saved)


def _handover(link: Link, message: Message) -> None:
    desk, what = link.desk, text_of(message, "what")
    if what == "command":
        text, note = handover.command_of(desk.session), handover.note_of(desk.session)
        link.answer(message, {"text": text, "note": note})
        return

    def work() -> Message:
        file = handover.handed(what, desk.session, None if what == "yaml" else desk.result_document())
        number = secrets.token_urlsafe(9)
        desk.files[number] = file
        for old in list(desk.files)[:-_MOST_FILES]:
            del desk.files[old]
        return {"address": f"/{desk.token}/get/{number}", "name": file.name}

    desk.later(link, message, work)


#: What each word does.
VERBS: dict[str, Callable[[Link, Message], None]] = {
    "set": _set, "undo": _undo, "redo": _redo, "reset": _reset, "open": _open, "start": _start, "analyse": _analyse,
    "cancel": _cancel, "survey": _survey, "add_bolts": _add_bolts, "diff": _diff, "save": _save,
    "handover": _handover,
}  # fmt: skip
