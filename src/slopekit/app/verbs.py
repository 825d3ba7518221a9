"""What a page may ask over its socket: each word of a message and what it does. docs/howto/app.md lists them."""

import asyncio
import secrets
from collections.abc import Callable

from slopekit.app import handover, jobs, saving, surveys
from slopekit.app.desk import Desk, Link
from slopekit.app.messages import Message, text_of, values_of, wrong
from slopekit.app.session import Moment, Opened, opened_template, opened_text
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
    desk = link.desk
    if "template" in message:
        opened = opened_template(text_of(message, "template"))
    elif "yaml" in message:
        opened = opened_text(text_of(message, "yaml"), _name(text_of(message, "name", "design.yaml")))
    elif "pair" in message:
        if desk.survey is None:
            raise wrong("no survey was dropped", "Drop a joint list first.", "E548")
        number = message["pair"]
        if not isinstance(number, int) or isinstance(number, bool):
            raise wrong("pair needs the number of a pair")
        opened = opened_text(desk.survey.design_of_pair(number), "pair.yaml")
    elif "unsaved" in message:
        desk.set_aside()
        desk.autosave.taken(text_of(message, "unsaved"), desk.session)
        _forget(desk)
        _changed(link, message)
        link.send(desk.hello())
        return
    else:
        raise wrong("open needs a template, a yaml, a pair or what was not saved")
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
        raise wrong("the bolts were found for an earlier design", "Find them again.", "E549")
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
    desk.changed()
    link.answer(message, {"file": str(target)})
    desk.show(link)


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
