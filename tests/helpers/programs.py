"""The programs of `tools/`, run as a user runs them."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ROOT / "tools"


def run_tool(name, *arguments, folder=TOOLS, timeout=280):
    """Run a program of `tools/`, or its copy in `folder`; return how it ended, with what it said."""
    command = [sys.executable, str(folder / f"{name}.py"), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=timeout, check=False)


def numbers_in(line):
    """Return the numbers of a line, in order."""
    return [float(word) for word in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?![\w.])", line)]
