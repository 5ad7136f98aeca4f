"""The kernels are compiled ahead, by two processes, for exactly the arguments that a run gives them."""

import os
import subprocess
import sys
from collections import Counter

from helpers.programs import ROOT

from sumo_reactive.lab import compiling
from sumo_reactive.lab.compiling import COMPILERS, compile_ahead, kernels_of

AHEAD = """
import os, sys
from pathlib import Path
from sumo_reactive.cli.main import main
from sumo_reactive.lab import compiling
made = compiling.compile_ahead
def ahead():
    made()
    Path("ahead").write_text("\\n".join(os.listdir(compiling.CACHE_FOLDER)))
compiling.compile_ahead = ahead
sys.argv = ["sumo-reactive", "run", {scenario!r}, "-q"]
sys.exit(main())
"""
"""A run that notes what was compiled ahead."""


def kept(cache):
    """Return how many kinds of arguments each kernel in a cache was compiled for."""
    return Counter(file.name.rpartition("-")[0] for file in cache.glob("sumo_reactive/*/*-*"))


def test_a_run_needs_no_kernel_anew_that_was_compiled_ahead(tmp_path):
    program = AHEAD.format(scenario=str(ROOT / "scenarios" / "figure4.toml"))
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-c", program]
    answer = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert answer.returncode == 0 and "compiling the kernels once" in answer.stderr
    ahead = Counter(line.rpartition("-")[0] for line in (tmp_path / "ahead").read_text().splitlines())
    found = kept(tmp_path)
    roots = {f"{one.py_func.__module__}.{one.py_func.__qualname__}" for part in range(COMPILERS) for one in kernels_of(part)}
    assert {name: found[name] for name in roots} == dict.fromkeys(roots, 1)
    assert roots <= set(ahead) and len([name for name in found if name not in ahead]) < 10 < len(ahead)


def test_where_no_process_can_be_started_the_first_call_compiles(monkeypatch, tmp_path):
    def none(*_, **__):
        raise OSError("no process")

    monkeypatch.setattr(compiling.subprocess, "Popen", none)
    monkeypatch.setattr(compiling, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(compiling, "is_cached", lambda: False)
    compile_ahead()
    assert not list(tmp_path.iterdir())
