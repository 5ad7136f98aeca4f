"""From arguments to an exit code: every error of the user, and a request to stop, becomes one line."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time as clock
import traceback
from types import FrameType
from typing import Any, NoReturn

import typer

from sumo_reactive.cli.app import app
from sumo_reactive.cli.streams import outlive_readers
from sumo_reactive.errors import ExitCode, ReactiveError

_PATIENCE_S = 3.0
"""So long after a request others are taken for the same one: what cleans up is not cut short by a second key."""

_AGAIN_S = 0.02
"""So long after a request that has to wait it is looked at again."""

_REQUESTS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))

_TAKE_SUMO_OPTIONS = (" run", " compare")
"""Ends of the commands that hand options on to SUMO."""

_UsageErrors: tuple[type[Exception], ...] = typer.BadParameter.__bases__
"""Click's `UsageError`, which some releases of typer bring along and others import."""


def main() -> NoReturn:
    """Run the command line and exit with its code; errors of the user become one line."""
    interrupts = Interrupts()
    outlive_readers()
    try:
        interrupts.listen()
        arguments = sys.argv[1:]
        split = arguments.index("--") if "--" in arguments else len(arguments)
        code = _exit_code(arguments[:split], arguments[split + 1 :], interrupts)
    except KeyboardInterrupt:
        interrupts.requested, code = True, ExitCode.INTERRUPTED
    interrupts.end()
    raise SystemExit(_fail("interrupted", code) if code == ExitCode.INTERRUPTED and not interrupts.is_told else code)


def _exit_code(arguments: list[str], sumo_options: list[str], interrupts: Interrupts) -> int:
    try:
        return int(app(args=arguments, prog_name="sumo-reactive", standalone_mode=False, obj=sumo_options) or 0)
    except ReactiveError as error:
        interrupts.is_told = not interrupts.requested
        return ExitCode.INTERRUPTED if interrupts.requested else _fail(str(error), error.exit_code)
    except _UsageErrors as error:
        message = getattr(error, "format_message", error.__str__)()
        asked = getattr(getattr(error, "ctx", None), "command_path", "sumo-reactive")
        is_unknown = type(error).__name__ == "NoSuchOption" and asked.endswith(_TAKE_SUMO_OPTIONS)
        hint = "; an option of SUMO goes behind --, as in '-- --time-to-teleport 300'" if is_unknown else ""
        return _fail(f"{message.rstrip('.') if hint else message}{hint} (see {asked} --help)", ExitCode.UNUSABLE)
    except MemoryError:
        return ExitCode.INTERRUPTED if interrupts.requested else _fail("out of memory", ExitCode.SUMO_FAILED)
    except Exception as error:
        if interrupts.requested:
            return ExitCode.INTERRUPTED
        if isinstance(error, OSError) and error.strerror:
            return _fail(": ".join(str(part) for part in (error.filename, error.strerror) if part), ExitCode.UNUSABLE)
        traceback.print_exc()
        return _fail("internal error, please report it with the lines above", ExitCode.INTERNAL_FAULT)


def _fail(message: str, code: int) -> int:
    typer.echo(f"sumo-reactive: {' '.join(message.split())}", err=True)
    return code


class Interrupts:
    """Turns the first request into a `KeyboardInterrupt` in the main thread; tells whether there was one.

    Other languages that call back swallow it: modules in C that import others go on with what these lack, the compiler goes
    on with an object it has not got, and dies. There it waits until they are done (`interrupts_kept`: until a kernel is),
    and so where a temporary file is made that nobody would remove. What the interpreter swallows, as in functions that it
    calls when an object is gone, comes again. If it is swallowed elsewhere, the request is known nevertheless.
    """

    def __init__(self) -> None:
        self.requested = False
        self.is_told = False
        self._last = 0.0
        self._again: threading.Timer | None = None
        self._before: dict[int, Any] = {}
        self._told_before = sys.unraisablehook

    def listen(self) -> None:
        """Take requests from now on; those that the caller's process ignores stay ignored."""
        if threading.current_thread() is not threading.main_thread():
            return
        for number in _REQUESTS:
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                self._before[number] = signal.signal(number, self._interrupt)
        self._told_before, sys.unraisablehook = sys.unraisablehook, self._swallowed

    def end(self) -> None:
        """Leave further requests to whoever took them before.

        Where an interrupt was raised within an `exec`, as class decorators use it, the interpreter ends by killing itself
        instead of with the exit code, unless it executes something after that.
        """
        exec("")
        if self._again is not None:
            self._again.cancel()
        for number, before in self._before.items():
            signal.signal(number, before)
        sys.unraisablehook = self._told_before

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        before, self._last = self._last, clock.monotonic()
        if self.requested and self._again is None and self._last - before < _PATIENCE_S:
            return
        self.requested = True
        if _has_to_wait(frame):
            self._ask_again(number)
            return
        self._again = None
        raise KeyboardInterrupt

    def _ask_again(self, number: int) -> None:
        self._again = threading.Timer(_AGAIN_S, _sent_to_main_thread, (number,))
        self._again.daemon = True
        self._again.start()

    def _swallowed(self, unraisable: Any) -> None:
        if not (self.requested and isinstance(unraisable.exc_value, KeyboardInterrupt)):
            self._told_before(unraisable)
            return
        number = next(iter(self._before))
        if signal.getsignal(number) == self._interrupt:  # else somebody keeps it
            self._ask_again(number)


def _sent_to_main_thread(number: int) -> None:
    """Send a signal so that it ends what the main thread waits for, too."""
    main_thread = threading.main_thread().ident
    if main_thread is not None and hasattr(signal, "pthread_kill"):
        signal.pthread_kill(main_thread, number)
    else:
        _thread.interrupt_main(signal.Signals(number))


_UNCUT = ("importlib._bootstrap.", "numba.", "llvmlite.", "tempfile.")
"""Modules, and those within them, whose functions are not cut short: imports, the compiler, temporary files."""


def _has_to_wait(frame: FrameType | None) -> bool:
    """Tell whether what runs where a signal came, called by `main`, is not to be cut short."""
    while frame is not None and frame.f_code is not main.__code__:
        if f"{frame.f_globals.get('__name__')}.".startswith(_UNCUT):
            return True
        frame = frame.f_back
    return False
