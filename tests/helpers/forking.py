"""A process that has loaded what the project's programs load, and forks another one for each that it is asked to run."""

from __future__ import annotations

import atexit
import json
import os
import runpy
import socket
import sys
import tempfile
import threading
import traceback
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

LONGEST_ORDER = 2**17
LOADED = (
    "sumo_reactive.lab.batch.engine", "sumo_reactive.lab.batch.stored_results",
    "sumo_reactive.lab.comparison.record", "sumo_reactive.lab.recorder", "sumo_reactive.lab.simulation",
    "sumo_reactive.show.explain", "sumo_reactive.show.reports", "sumo_reactive.sumo.crash",
)  # fmt: skip
"""What the commands import when they are called."""


def load(scenario: Path) -> None:
    """Load all modules, and the kernels by driving a scenario."""
    for name in LOADED:
        import_module(name)
    from sumo_reactive.lab.scenario import load_scenario
    from sumo_reactive.lab.simulation import run_trial

    run_trial(load_scenario(scenario))


def serve(orders: socket.socket) -> dict[str, Any]:
    """Fork for each order, and answer with the process id and, when it has ended, the exit code; return in a fork only."""
    while True:
        text, ends, *_ = socket.recv_fds(orders, LONGEST_ORDER, 2)
        if not text:
            os._exit(0)
        child = os.fork()
        if child == 0:
            orders.close()
            for own, end in enumerate(ends, 1):
                os.dup2(end, own)
        for end in ends:
            os.close(end)
        if child == 0:
            order: dict[str, Any] = json.loads(text)
            return order
        orders.send(str(child).encode())
        orders.send(str(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])).encode())


def run(program: str, arguments: list[str], folder: str, environment: dict[str, str], code: str) -> int:
    """Run a file, or a module as `python -m` does, after some code; return its exit code."""
    os.environ.clear()
    os.environ.update(environment)
    tempfile.tempdir = None
    os.chdir(folder)
    is_file = program.endswith(".py")
    sys.argv = [program, *arguments]
    sys.path.insert(0, str(Path(program).parent) if is_file else folder)
    try:
        exec(code, {"__name__": "before"})
        if is_file:
            _run_file(program)
        else:
            runpy.run_module(program, run_name="__main__", alter_sys=True)
    except SystemExit as end:
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def _run_file(program: str) -> None:
    """Run a file as the interpreter does: processes that it starts take what it defines from the module `__main__`."""
    main = sys.modules["__main__"] = sys.modules["__mp_main__"] = ModuleType("__main__")
    main.__file__ = program
    exec(compile(Path(program).read_bytes(), program, "exec"), vars(main))


def end(code: int) -> None:
    """End as the interpreter does, but for taking all that is loaded apart: that takes longer than most programs."""
    threading._shutdown()
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


if __name__ == "__main__":
    load(Path(sys.argv[2]))
    end(run(**serve(socket.socket(fileno=int(sys.argv[1])))))
