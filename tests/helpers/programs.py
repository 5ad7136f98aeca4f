"""The project's programs, run as a user runs them: the command line and those of `tools/`."""

from __future__ import annotations

import json
import os
import re
import selectors
import signal
import socket
import subprocess
import sys
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import psutil

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ROOT / "tools"
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
"""Libraries that make threads when they are loaded cannot use them in a fork."""


def sumo_reactive(*arguments, cwd=None, code="", timeout=280, more_environment=None):
    """Run the command line after some code in a process of its own; return how it ended, with what it said.

    The process is forked from one that has loaded all modules: what happens while they are loaded is not seen.
    """
    return run_program("sumo_reactive", *arguments, cwd=cwd, code=code, timeout=timeout, more_environment=more_environment)


def compile_kernels():
    """Have the kernels compiled and kept, which takes long, once on a machine, and is no part of what is tested."""
    from sumo_reactive.driver.kernel_folder import is_cached

    if not is_cached():
        assert sumo_reactive("run", ROOT / "scenarios" / "four_way_priority.toml", "-q").returncode == 0


def started_anew(*arguments, cwd=None, timeout=280):
    """Run the command line as a shell does, from the interpreter's start; return how it ended, with what it said."""
    command = [sys.executable, "-m", "sumo_reactive", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=timeout, cwd=cwd, check=False)


def run_tool(name, *arguments, folder=TOOLS, code="", timeout=280):
    """Run a program of `tools/`, or its copy in `folder`, as the command line; return how it ended, with what it said."""
    return run_program(folder / f"{name}.py", *arguments, code=code, timeout=timeout)


def numbers_in(line):
    """Return the numbers of a line, in order."""
    return [float(word) for word in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?![\w.])", line)]


def run_program(program, *arguments, cwd=None, code="", timeout=280, more_environment=None):
    """Run a file or a module in a forked process, after some code; return how it ended, with what it said."""
    order = {
        "program": str(program), "arguments": [*map(str, arguments)], "folder": str(cwd or Path.cwd()), "code": code,
        "environment": os.environ | (more_environment or {}),
    }  # fmt: skip
    server = _server()
    pipes = [os.pipe(), os.pipe()]
    socket.send_fds(server, [json.dumps(order).encode()], [into for _, into in pipes])
    for _, into in pipes:
        os.close(into)
    process = int(server.recv(64))
    try:
        said = _heard([out for out, _ in pipes], timeout)
    except TimeoutError:
        os.kill(process, signal.SIGKILL)
        server.recv(64)
        raise
    finally:
        for out, _ in pipes:
            os.close(out)
    return subprocess.CompletedProcess([order["program"], *order["arguments"]], int(server.recv(64)), *said)


@cache
def _server():
    """Start the process that forks; it ends with this one."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    number, scenario = theirs.fileno(), ROOT / "scenarios" / "four_way_priority.toml"
    command = [sys.executable, "-P", str(Path(__file__).parent / "forking.py"), str(number), str(scenario)]
    quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL}
    subprocess.Popen(command, pass_fds=[number], env=os.environ | ONE_THREAD, **quiet)
    theirs.close()
    return ours


def _heard(ends, timeout):
    """Return what comes out of some pipes until all are closed; a TimeoutError if that takes too long (s) without a word."""
    heard = dict.fromkeys(ends, b"")
    with selectors.DefaultSelector() as waiting:
        for end in ends:
            waiting.register(end, selectors.EVENT_READ)
        while waiting.get_map():
            ready = waiting.select(timeout)
            if not ready:
                raise TimeoutError(f"nothing said for {timeout} s")
            for key, _ in ready:
                data = os.read(key.fd, 2**16)
                heard[key.fd] += data
                if not data:
                    waiting.unregister(key.fd)
    return [data.decode("utf-8") for data in heard.values()]


@contextmanager
def started(*arguments, cwd):
    """Start a command; end it and all that it has started, whatever happens."""
    process = subprocess.Popen(
        [sys.executable, "-m", *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=cwd
    )
    try:
        yield process
    finally:
        family = descendants(process) if process.poll() is None else []
        process.kill()
        for one in family:
            one.kill()
        process.wait()
        process.stdout.close()


def descendants(process):
    """Return the processes that a process has started, and those that these have."""
    return psutil.Process(process.pid).children(recursive=True)
