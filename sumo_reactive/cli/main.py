"""From arguments to an exit code: every error of the user becomes one line."""

from __future__ import annotations

import sys
import traceback
from typing import NoReturn

import typer

from sumo_reactive.cli.app import app
from sumo_reactive.cli.interrupts import Interrupts
from sumo_reactive.errors import ReactiveError

USAGE_ERROR, OUT_OF_MEMORY, INTERNAL_ERROR, INTERRUPTED = 2, 3, 70, 130

UsageErrors: tuple[type[Exception], ...] = typer.BadParameter.__bases__
"""Click's `UsageError`, which some releases of typer bring along and others import."""


def main() -> NoReturn:
    """Run the command line and exit with its code; errors of the user become one line."""
    interrupts = Interrupts()
    try:
        interrupts.listen()
        arguments = sys.argv[1:]
        split = arguments.index("--") if "--" in arguments else len(arguments)
        code = _exit_code(arguments[:split], arguments[split + 1 :], interrupts)
    except KeyboardInterrupt:
        code = INTERRUPTED
    interrupts.end()
    raise SystemExit(_fail("interrupted", code) if code == INTERRUPTED else code)


def _exit_code(arguments: list[str], sumo_options: list[str], interrupts: Interrupts) -> int:
    try:
        return int(app(args=arguments, prog_name="sumo-reactive", standalone_mode=False, obj=sumo_options) or 0)
    except ReactiveError as error:
        return _fail(str(error), error.exit_code)
    except UsageErrors as error:
        message = getattr(error, "format_message", error.__str__)()
        asked = getattr(getattr(error, "ctx", None), "command_path", "sumo-reactive")
        return _fail(f"{message} (see {asked} --help)", USAGE_ERROR)
    except MemoryError:
        return _fail("out of memory", OUT_OF_MEMORY)
    except Exception as error:
        if interrupts.requested:
            return INTERRUPTED
        if isinstance(error, OSError) and error.strerror:
            return _fail(": ".join(str(part) for part in (error.filename, error.strerror) if part), USAGE_ERROR)
        traceback.print_exc()
        return _fail("internal error, please report it with the lines above", INTERNAL_ERROR)


def _fail(message: str, code: int) -> int:
    typer.echo(f"sumo-reactive: {' '.join(message.split())}", err=True)
    return code
