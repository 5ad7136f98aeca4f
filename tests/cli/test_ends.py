"""How the command line ends: whatever happens, one line, its exit code, and nothing left behind."""

from __future__ import annotations

import gzip
import os
import subprocess
import sys

import pytest
from helpers.programs import ROOT, sumo_reactive

FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"
NETWORK = ROOT / "networks" / "four_way_priority"

BEFORE = """
import builtins, ctypes, os, signal, sys

def strike():
    {strike}

def before(module, name, call, only=1):
    real, calls = getattr(module, name), []
    def struck(*arguments, **others):
        calls.append(1)
        if len(calls) == only:
            strike()
        return real(*arguments, **others)
    setattr(module, name, struck)
"""
MAIN = "\nfrom sumo_reactive.__main__ import main\nmain()\n"
LOADING = """
real = builtins.__import__
def importing(name, *more):
    if name == 'typer':
        strike()
    return real(name, *more)
builtins.__import__ = importing
"""
"""A strike while the modules are loaded."""

STAGES = {
    "the network is read": "import sumo_reactive.lab.simulation as one; before(one, 'read_net', strike)",
    "a temporary file is made": """
real_open = os.open
def opening(path, flags, *more, **others):
    opened = real_open(path, flags, *more, **others)
    if str(path).startswith(os.environ['TMPDIR']):
        os.open = real_open
        strike()
    return opened
os.open = opening
""",
    "SUMO starts": "import libsumo; before(libsumo, 'start', strike)",
    "the compiler asks for a kernel": """
from llvmlite.binding.executionengine import ExecutionEngine
before(ExecutionEngine, '_find_module_ptr', strike)""",
    "the world is built": "import sumo_reactive.lab.trip as one; before(one, 'choose_lanes', strike)",
    "a step is driven": "import libsumo; before(libsumo, 'simulationStep', strike, 150)",
    "SUMO is closed": "import libsumo; before(libsumo, 'close', strike)",
    "the record is written": "import sumo_reactive.lab.recorder as one; before(one, 'write_trajectory', strike)",
}


def ended(code, *arguments, folder):
    """Run the command line after some code; return how it ended."""
    for name in ("tmp", "here"):
        (folder / name).mkdir()
    return sumo_reactive(*arguments, cwd=folder / "here", code=code, more_environment={"TMPDIR": str(folder / "tmp")})


def from_the_start(code, *arguments, folder):
    """Run a module as `python -m` does in a new interpreter; return how it ended."""
    (folder / "struck.py").write_text(code, encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-m", "struck", *map(str, arguments)]
    return subprocess.run(
        command, capture_output=True, encoding="utf-8", timeout=60, cwd=folder, env=environment, check=False
    )


def in_a_script(code, folder):
    """Run a script, which is no module being imported, in a new interpreter; return how it ended."""
    (folder / "script.py").write_text(code, encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, folder / "script.py"]
    return subprocess.run(command, capture_output=True, encoding="utf-8", timeout=60, env=environment, check=False)


def left(folder):
    return [path.name for place in ("tmp", "here") for path in (folder / place).iterdir()]


@pytest.mark.parametrize(
    ("stage", "request_to_stop"),
    [*((stage, "SIGINT") for stage in STAGES), ("a step is driven", "SIGHUP"), ("the world is built", "SIGTERM")],
)
def test_a_request_to_stop_ends_a_run_at_every_stage(tmp_path, stage, request_to_stop):
    code = BEFORE.format(strike=f"os.kill(os.getpid(), signal.{request_to_stop})") + STAGES[stage]
    answer = ended(code, "run", FOUR_WAY, "--out", "out", folder=tmp_path)
    lines = [line for line in answer.stderr.splitlines() if "compiling" not in line]
    assert (answer.returncode, lines) == (130, ["sumo-reactive: interrupted"])
    assert left(tmp_path) == []


@pytest.mark.parametrize("request_to_stop", ["SIGINT", "SIGTERM"])
def test_a_request_to_stop_ends_a_run_while_the_modules_are_loaded(tmp_path, request_to_stop):
    code = BEFORE.format(strike=f"os.kill(os.getpid(), signal.{request_to_stop})") + LOADING + MAIN
    answer = from_the_start(code, "run", FOUR_WAY, "--out", "out", folder=tmp_path)
    assert (answer.returncode, answer.stderr) == (130, "sumo-reactive: interrupted\n")
    assert not (tmp_path / "out").exists()


def test_a_request_to_stop_ends_a_run_that_a_module_drives_as_it_is_imported(tmp_path):
    code = BEFORE.format(strike="os.kill(os.getpid(), signal.SIGINT)") + STAGES["a step is driven"] + MAIN
    imported = f"if __name__ == '__main__':\n    import struck\n{code}"
    answer = from_the_start(imported, "run", FOUR_WAY, folder=tmp_path)
    assert (answer.returncode, answer.stderr) == (130, "sumo-reactive: interrupted\n")


@pytest.mark.parametrize("stage", ["SUMO starts", "a step is driven"])
def test_a_run_that_is_killed_leaves_nothing(tmp_path, stage):
    code = BEFORE.format(strike="os.kill(os.getpid(), signal.SIGKILL)") + STAGES[stage]
    assert ended(code, "run", FOUR_WAY, "--out", "out", folder=tmp_path).returncode == -9
    assert left(tmp_path) == []


def test_an_interrupt_within_what_is_executed_leaves_the_exit_code_alone(tmp_path):
    code = "import os, signal\nfrom sumo_reactive.cli.main import Interrupts\none = Interrupts()\none.listen()\n"
    code += "try:\n    exec('os.kill(os.getpid(), signal.SIGINT)')\nexcept KeyboardInterrupt:\n    one.end()\n    "
    assert from_the_start(f"{code}raise SystemExit(130)\n", folder=tmp_path).returncode == 130


def test_an_interrupt_within_an_import_comes_when_the_module_is_whole(tmp_path):
    """A module in C that imports another prints the interrupt that this one dies of, and goes on without it."""
    module = "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\nlast = 1\n"
    (tmp_path / "struck_module.py").write_text(module, encoding="utf-8")
    code = "import time\nfrom sumo_reactive.cli.main import Interrupts\none = Interrupts()\none.listen()\n"
    code += "import struck_module\nassert struck_module.last and one.requested\n"
    code += "try:\n    time.sleep(100)\nexcept KeyboardInterrupt:\n    one.end()\n    raise SystemExit(130)\n"
    answer = in_a_script(code, tmp_path)
    assert (answer.returncode, answer.stderr) == (130, "")


@pytest.mark.parametrize("number", [5, 9])
def test_an_interrupt_cuts_no_kernel_in_two_and_comes_before_the_next(tmp_path, number):
    code = BEFORE.format(strike="os.kill(os.getpid(), signal.SIGINT)") + f"""
import atexit
from numba.core.codegen import CPUCodeLibrary as one
whole, real = [], one._finalize_final_module
def finished(library):
    real(library)
    whole.append(library)
one._finalize_final_module = finished
before(one, "_finalize_final_module", strike, {number})
atexit.register(lambda: print(len(whole), "whole"))
"""
    answer = from_the_start(code + MAIN, "run", FOUR_WAY, folder=tmp_path)
    assert (answer.returncode, answer.stdout) == (130, f"{number} whole\n")


def test_where_the_compiler_finds_no_place_to_keep_anything_the_run_goes_on(tmp_path):
    code = "from numba.core.caching import CacheImpl\nCacheImpl._locator_classes = []\n"
    assert ended(code, "run", FOUR_WAY, "--quiet", folder=tmp_path).returncode == 0


def test_an_interrupt_that_the_interpreter_swallows_comes_again(tmp_path):
    code = "import os, signal, time, weakref\n"
    code += "from sumo_reactive.cli.main import Interrupts\none = Interrupts()\none.listen()\n"
    code += "gone = {1}\nkept = weakref.ref(gone, lambda _: os.kill(os.getpid(), signal.SIGINT))\ntry:\n    del gone\n"
    code += "    time.sleep(100)\nexcept KeyboardInterrupt:\n    one.end()\n    raise SystemExit(130)\n"
    answer = in_a_script(code, tmp_path)
    assert (answer.returncode, answer.stderr) == (130, "")


@pytest.mark.parametrize("error", ["MemoryError()", "SimulationError('SUMO ended')"])
def test_what_fails_of_an_interrupt_that_was_swallowed_is_interrupted(tmp_path, error):
    strike = "try:\n        os.kill(os.getpid(), signal.SIGINT)\n    except KeyboardInterrupt:\n        "
    code = BEFORE.format(strike=f"{strike}from sumo_reactive.errors import SimulationError; raise {error} from None")
    answer = ended(code + STAGES["SUMO is closed"], "run", FOUR_WAY, "--out", "out", folder=tmp_path)
    assert (answer.returncode, answer.stderr) == (130, "sumo-reactive: interrupted\n")


def test_a_second_request_does_not_cut_the_cleaning_up_short(tmp_path):
    twice = "os.kill(os.getpid(), signal.SIGINT) or os.kill(os.getpid(), signal.SIGTERM)"
    code = BEFORE.format(strike=f"try:\n        {twice}\n    finally:\n        {twice}")
    answer = ended(code + STAGES["the record is written"], "run", FOUR_WAY, "--out", "out", folder=tmp_path)
    assert (answer.returncode, answer.stderr) == (130, "sumo-reactive: interrupted\n")
    assert left(tmp_path) == []


def test_a_process_started_to_ignore_hang_ups_drives_on(tmp_path):
    strike = BEFORE.format(strike="os.kill(os.getpid(), signal.SIGHUP)")
    code = strike + "signal.signal(signal.SIGHUP, signal.SIG_IGN)\n" + STAGES["a step is driven"]
    assert ended(code, "run", FOUR_WAY, "--quiet", folder=tmp_path).returncode == 0


@pytest.mark.parametrize("command", [("compare", "--jobs", 1, "--out", "out"), ("check", "--junit", "verdicts.xml")])
@pytest.mark.parametrize("request_to_stop", ["SIGINT", "SIGTERM"])
def test_a_request_to_stop_ends_what_runs_in_processes(tmp_path, command, request_to_stop):
    stage = "import multiprocessing.connection as one; before(one.Connection, 'send', strike, 2)"
    in_main = f"signal.pthread_kill(__import__('threading').main_thread().ident, signal.{request_to_stop})"
    answer = ended(
        BEFORE.format(strike=in_main) + stage, command[0], FOUR_WAY, *command[1:], folder=tmp_path
    )
    assert (answer.returncode, answer.stderr.splitlines()[-1]) == (130, "sumo-reactive: interrupted")
    assert "Traceback" not in answer.stderr and left(tmp_path) == []


@pytest.mark.parametrize(
    ("strike", "signal"), [("ctypes.string_at(0)", "SIGSEGV"), ("ctypes.CDLL(None).abort()", "SIGABRT")]
)
@pytest.mark.parametrize("stage", ["SUMO starts", "a step is driven"])
def test_sumo_dying_of_a_signal_is_one_line_and_exit_code_3(tmp_path, stage, strike, signal):
    answer = ended(BEFORE.format(strike=strike) + STAGES[stage], "run", FOUR_WAY, "--out", "out", folder=tmp_path)
    assert answer.returncode == 3
    assert answer.stderr.splitlines()[-1].startswith(f"sumo-reactive: SUMO died of {signal}")
    assert left(tmp_path) == []


@pytest.mark.parametrize(
    ("raised", "code", "line"),
    [
        ("MemoryError", 3, "sumo-reactive: out of memory"),
        ("OSError(24, 'Too many open files', '/x')", 2, "sumo-reactive: /x: Too many open files"),
        ("libsumo.TraCIException('no such thing')", 3, "sumo-reactive: SUMO failed at 0.0 s: no such thing"),
        ("RuntimeError('no word of SUMO')", 70, "sumo-reactive: internal error, please report it with the lines above"),
        ("libsumo.FatalTraCIError('gone')", 3, "sumo-reactive: SUMO failed at 0.0 s: gone"),
    ],
)
def test_what_the_machine_or_sumo_lacks_is_no_internal_error(tmp_path, raised, code, line):
    stage = "import libsumo; before(libsumo, 'simulationStep', strike)"
    answer = ended(BEFORE.format(strike=f"import libsumo; raise {raised}") + stage, "run", FOUR_WAY, folder=tmp_path)
    assert answer.returncode == code and answer.stderr.endswith(line + "\n")
    assert answer.stderr.count("\n") == 1 or code == 70


def test_an_end_of_file_that_nobody_expected_is_no_interrupt(tmp_path):
    code = BEFORE.format(strike="raise EOFError") + STAGES["the world is built"]
    answer = ended(code, "run", FOUR_WAY, folder=tmp_path)
    assert answer.returncode == 70 and "interrupted" not in answer.stderr


def test_a_network_cut_off_is_told_in_one_line(tmp_path):
    packed = gzip.compress((NETWORK / "four_way_priority.net.xml").read_bytes())
    (tmp_path / "a.net.xml.gz").write_bytes(packed[: len(packed) // 2])
    config = tmp_path / "a.sumocfg"
    config.write_text('<configuration><net-file value="a.net.xml.gz"/></configuration>', encoding="utf-8")
    answer = ended("", "run", config, folder=tmp_path)
    assert answer.returncode == 2
    assert answer.stderr.endswith("a.net.xml.gz: cannot be read: packed, and cut off before its end\n")
    assert answer.stderr.count("\n") == 1


def test_square_brackets_are_letters(tmp_path):
    routes = (NETWORK / "four_way_priority.rou.xml").read_text(encoding="utf-8").replace('id="ego"', 'id="[bold][/x]"')
    (tmp_path / "a.rou.xml").write_text(routes, encoding="utf-8")
    net = NETWORK / "four_way_priority.net.xml"
    config = tmp_path / "[red]" / "[bold].sumocfg"
    config.parent.mkdir()
    config.write_text(
        f'<configuration><net-file value="{net}"/><route-files value="../a.rou.xml"/></configuration>', encoding="utf-8"
    )
    terminal = "import sys; sys.stdout.isatty = sys.stderr.isatty = lambda: True"
    for several in ((), ("--ego", "west_east.0")):
        folder = tmp_path / str(len(several))
        folder.mkdir()
        answer = ended(terminal, "run", config, "--ego", "[bold][/x]", *several, "--until", 20, folder=folder)
        assert answer.returncode in (0, 1), answer.stderr
        assert "[bold][/x]" in answer.stdout
