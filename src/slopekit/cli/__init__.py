"""The command line: parse, call one function, print, exit code. Everything else loads only when a command runs."""

try:
    import os
    import signal
    import sys
    import threading

    def _interrupt(_: int, frame: "FrameType | None") -> None:
        """Ctrl-C: end at once while a library loads, of which some abort on an exception; else KeyboardInterrupt."""
        while frame is not None:
            if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
                os._exit(130)
            frame = frame.f_back
        raise KeyboardInterrupt

    _is_interruptible = threading.current_thread() is threading.main_thread() and (
        signal.getsignal(signal.SIGINT) is signal.default_int_handler
    )
    if _is_interruptible:
        signal.signal(signal.SIGINT, _interrupt)

    import atexit
    import errno
    import gc
    import io
    from collections.abc import Iterable, Mapping, Sequence
    from contextlib import suppress
    from importlib import import_module
    from types import FrameType
    from typing import Annotated, Any, NoReturn, cast

    # how many objects may come before the garbage collector looks at them all: those of starting up are all there to
    # stay, and Python's 700 has them gone through a hundred times (a tenth of a cold wedge)
    gc.set_threshold(50_000, 20, 20)

    import typer
    from typer.core import TyperGroup

    from slopekit._version import __version__
    from slopekit.cli.common import canonical_options, print_faults, repeated_options
    from slopekit.core.errors import DesignError, Fault, SlopekitError
    from slopekit.core.synonyms import nearest
    from slopekit.studies.protocol import STUDIES
except ModuleNotFoundError as error:
    from slopekit._needs import missing_library_message

    if not (missing_module_text := missing_library_message(error)):
        raise
    print(missing_module_text, file=sys.stderr)
    sys.exit(2)
except KeyboardInterrupt:  # before the handler above stood
    raise SystemExit(130) from None

#: The commands at the head of the help; studies and the others follow.
_FIRST = ("wedge", "run", "lint")
#: The modules of the commands that are written by hand; those of results and studies are made from their functions.
_HAND_WRITTEN: Mapping[str, str] = {
    "lint": "tools",
    "plot": "outputs",
    "export": "outputs",
    "report": "outputs",
    "app": "tools",
    "templates": "tools",
    "doctor": "tools",
    "explain": "tools",
}


class _Commands(TyperGroup):
    """The commands; each is loaded and made when it is asked for."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands = cast(dict[str, Any], dict.fromkeys([*_FIRST, *STUDIES, *_HAND_WRITTEN]))

    def list_commands(self, ctx: Any) -> list[str]:
        """Their names, in order."""
        return list(self.commands)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command by its name, None for any other word."""
        if cmd_name in self.commands and self.commands[cmd_name] is None:
            self.commands[cmd_name] = typer.main.get_command(_app_of(cmd_name))
        return self.commands.get(cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return a command and its arguments; an option where the value of another belongs is refused."""
        name, command, rest = super().resolve_command(ctx, args)
        if command is not None:
            rest = canonical_options(command.params, rest)
            _refuse_swallowed(command.params, rest)
            if name in _HAND_WRITTEN:  # the others say it with what else is wrong, once all is read
                repeated_options(rest).refuse()
        return name, command, rest


def _app_of(name: str) -> typer.Typer:
    """A command as an app of its own."""
    if name in _HAND_WRITTEN:
        command = getattr(import_module(f"slopekit.cli.{_HAND_WRITTEN[name]}"), name)
    else:
        from slopekit.cli.study_command import command_of

        command = command_of(name)
    if isinstance(command, typer.Typer):
        return command
    command_app = typer.Typer(rich_markup_mode=None, add_completion=False)
    command_app.command(name)(command)
    return command_app


app = typer.Typer(
    cls=_Commands,
    # typer's completion is a module more for every command: it is there where the shell, or the user, asks for it
    add_completion="_SLOPEKIT_COMPLETE" in os.environ
    or any(word.endswith("-completion") for word in sys.argv[1:2]),
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Rock wedges and slopes by rigid blocks (PRE-IE), checked against closed forms.",
)


_ALLOW_OUTSIDE = "--allow-outside"


def _version(show: bool) -> None:
    if show:
        typer.echo(f"slopekit {__version__}")
        raise typer.Exit


@app.callback()
def _slopekit(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Version.")
    ] = False,
    allow_outside: Annotated[
        bool,
        typer.Option(
            _ALLOW_OUTSIDE,
            help="Designs may name files outside their own folder; of every command.",
        ),
    ] = False,
) -> None:
    """Rock wedges and slopes by rigid blocks (PRE-IE), checked against closed forms."""
    if allow_outside:
        os.environ["SLOPEKIT_ALLOW_OUTSIDE"] = "1"  # workers have it too


def _refuse_no_output() -> None:
    """Refuse to run under a shell's `>&-`: the result could not be printed."""
    if cast(object, sys.stdout) is None:
        raise DesignError(
            [
                Fault(
                    "E129",
                    "the output cannot be written: it is closed",
                    "stdout",
                    "Try > /dev/null.",
                )
            ]
        )


def _refuse_swallowed(declared: Iterable[Any], arguments: Sequence[str]) -> None:
    """Refuse an option where a value of the option before it belongs, which the parser would take for the value."""
    options = {
        name: parameter
        for parameter in declared
        for name in (*parameter.opts, *parameter.secondary_opts)
        if name.startswith("-")
    }
    index = 0
    while index < len(arguments) and arguments[index] != "--":
        name, is_joined, _ = arguments[index].partition("=")
        index += 1
        option = options.get(name)
        if option is None or getattr(option, "is_flag", False):
            continue
        end = index + option.nargs - bool(is_joined)
        for value in arguments[index:end]:
            if value.startswith("--") or value.partition("=")[0] in options:
                takes = "a value" if option.nargs == 1 else f"{option.nargs} values"
                message = f"{name} takes {takes}, and {value} is an option"
                raise DesignError([Fault("E100", message, name, "Try --help for the options.")])
        index = end


def main() -> NoReturn:
    """Run the command line; exit codes: 0 done, 1 criterion not met, 2 bad input, 3 no block, 4 disagree, 5 a bug.

    As a shell has it 130 after Ctrl-C, and 141 where what reads the output goes away.
    """
    atexit.register(
        gc.freeze
    )  # what is left goes with the process: to look through it costs a sixth of a cold wedge
    try:
        _refuse_no_output()
        if _ALLOW_OUTSIDE in sys.argv[2:]:  # of every command, wherever it stands
            sys.argv.remove(_ALLOW_OUTSIDE)
            sys.argv.insert(1, _ALLOW_OUTSIDE)
        code = app(standalone_mode=False)
    except SlopekitError as error:
        if isinstance(error, DesignError):
            error = _with_repeats(error)
        print_faults(error)
        sys.exit(error.exit_code)
    except (typer.Abort, KeyboardInterrupt):
        sys.exit(130)
    except typer.TyperException as error:
        if type(error).__name__ == "NoArgsIsHelpError":  # nothing was asked for: the help, as it is
            typer.echo(_message_of(error), err=True)
            sys.exit(2)
        message, suggestion = _message_of(error), _nearest_option(error)
        message = message.partition(" (Possible")[0] if suggestion is not None else message
        wrong = _with_repeats(
            DesignError([Fault("E100", message, "", suggestion or _advice(sys.argv[1:]))])
        )
        print_faults(wrong)
        sys.exit(wrong.exit_code)
    except ModuleNotFoundError as error:
        from slopekit._needs import missing_library_message

        if not (missing_module_text := missing_library_message(error)):
            _say_bug(error)
        typer.echo(missing_module_text, err=True)
        sys.exit(2)
    except OSError as error:
        if error.errno not in _DEVICE_ERRORS:
            _say_bug(error)
        print_faults(
            DesignError(
                [Fault("E129", f"the output cannot be written: {error.strerror}", "stdout")]
            ),
            True,
        )
        _discard_rest_of(sys.stdout)
        sys.exit(2)
    except SystemExit:
        if (
            type(sys.stdout).__name__ == "PacifyFlushWrapper"
        ):  # click's, put there as it ends with 1 at a closed pipe
            sys.exit(_PIPE_CLOSED)
        raise
    except Exception as error:
        _say_bug(error)
    sys.exit(code if isinstance(code, int) else 0)


def _with_repeats(error: DesignError) -> DesignError:
    """Add the options that are given twice to an error that came up before they were looked for."""
    twice = [fault for fault in repeated_options(sys.argv[1:]) if fault not in error.faults]
    return DesignError([*twice, *error.faults]) if twice else error


def start() -> NoReturn:
    """`main` as a process of its own, which ends when all is written.

    Python would take down every object of NumPy and typer one by one first, for nothing: 4 % of a cold wedge. It does
    where something waits for that end: other threads, a profiler, what `_ENDED_BY_PYTHON` names.
    """
    if _is_interruptible:
        signal.signal(signal.SIGINT, _interrupt)
    if sys.stdout is not None and isinstance(getattr(sys.stdout, "buffer", None), io.RawIOBase):
        # of PYTHONUNBUFFERED: a disk that is full takes a part of a text, and Python does not ask for the rest
        sys.stdout = io.TextIOWrapper(
            io.BufferedWriter(sys.stdout.buffer), sys.stdout.encoding, line_buffering=True
        )
    try:
        main()
    except SystemExit as end:
        is_watched = sys.getprofile() or sys.gettrace() or sys.flags.inspect
        is_alone = threading.active_count() == 1 and _ENDED_BY_PYTHON.isdisjoint(sys.modules)
        if is_alone and not is_watched and isinstance(end.code, int):
            with suppress(
                OSError, ValueError, AttributeError
            ):  # what cannot be written is for Python to say
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(end.code)
        raise


#: Modules that write, wait or clear away when Python ends; `_lsprof`: cProfile, of which `sys.getprofile` says nothing
#: from Python 3.12 on.
_ENDED_BY_PYTHON = {
    "_lsprof",
    "concurrent.futures",
    "coverage",
    "distributed",
    "logging",
    "matplotlib",
    "multiprocessing",
    "pyvista",
    "tempfile",
}

_PIPE_CLOSED = 128 + 13  # 1 would be a criterion that is not met

#: A disk or a quota that is full, a device that takes nothing.
_DEVICE_ERRORS = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}


def _discard_rest_of(stream: Any) -> None:
    """Let Python drop, at its end, what a stream could not take."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _nearest_option(error: "typer.TyperException") -> str | None:
    """The option that was likely meant, empty where there is none; None for another error than an unknown option."""
    word, context = getattr(error, "option_name", None), getattr(error, "ctx", None)
    if type(error).__name__ != "NoSuchOption" or word is None or context is None:
        return None
    names = [
        name for option in context.command.params for name in option.opts if name.startswith("-")
    ]
    similar = nearest(word, names, cutoff=0.7 if len(word.lstrip("-")) > 1 else 1.0)
    return f"Did you mean {similar[0]}?" if similar else ""


def _advice(arguments: Sequence[str]) -> str:
    """Return what to type instead: a dash that a text program put for a hyphen is the likeliest mistake."""
    dashed = next((word for word in arguments if word[:1] in "–—−‐‑" and len(word) > 1), "")
    if dashed:
        meant = "--" + dashed.lstrip("–—−‐‑-")
        return f"{dashed} begins with a dash that is no hyphen: type {meant}"
    return "Try --help for the options."


def _say_bug(error: Exception) -> NoReturn:
    typer.echo(f"E599 a bug of ours: {type(error).__name__}: {error}", err=True)
    typer.echo(
        "     Please send us the command with this text. SLOPEKIT_DEBUG=1 prints where it happened.",
        err=True,
    )
    if os.environ.get("SLOPEKIT_DEBUG"):
        raise error
    sys.exit(5)


def _message_of(
    error: "typer.TyperException",
) -> str:  # an older typer has none: `doctor` shall say that it is old
    format_message = getattr(error, "format_message", None)
    return str(format_message() if format_message else error)


if _is_interruptible:
    signal.signal(signal.SIGINT, signal.default_int_handler)
