"""The house's own rules: linter, types, layers, docstrings, nothing that holds on one machine only."""

from __future__ import annotations

import ast
import gzip
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "sumo_reactive"
TOOLS = ROOT / "tools"
MOST_LINES, MOST_PARAMETERS = 40, 6
"""What is yet to be mended; nothing may be added."""

MACHINE_PATH = re.compile(r"(?<![\w.~])/(?:home|root|tmp|work|mnt|var|Users)/\w")
"""The beginnings of paths that exist on one machine only."""


def complaints_of(program: str, *arguments: str) -> str:
    """Run a program of this environment in the project's folder; return what it says if it fails."""
    command = [str(Path(sys.executable).parent / program), *arguments]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, encoding="utf-8", timeout=300, check=False)
    return "" if answer.returncode == 0 else answer.stdout + answer.stderr


def tracked_files() -> list[Path]:
    """Return the files of the repository, also those that are new and not ignored."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a clone")
    listing = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listing, cwd=ROOT, capture_output=True, text=True, encoding="utf-8", timeout=60, check=True)
    files = [ROOT / name for name in names.stdout.split("\0") if name]
    return [file for file in files if file.is_file()]


def text_of(file: Path) -> str:
    """Return what a file holds, unpacked if it is compressed."""
    data = file.read_bytes()
    return (gzip.decompress(data) if file.suffix == ".gz" else data).decode("utf-8", errors="replace")


def undocumented(file: Path) -> Iterator[str]:
    """Yield the public modules, classes and functions of a file that have no docstring."""
    module = ast.parse(file.read_text(encoding="utf-8"))
    if ast.get_docstring(module) is None:
        yield f"{file.relative_to(ROOT)}: module"
    for node in _public(module):
        if ast.get_docstring(node) is None:
            yield f"{file.relative_to(ROOT)}:{node.lineno}: {node.name}"


def functions_of(file: Path) -> Iterator[ast.FunctionDef]:
    """Yield every function of a file but compiled kernels, also those inside of others."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef) and not any("kernel" in ast.unparse(one) for one in node.decorator_list):
            yield node


def parameters_of(function: ast.FunctionDef) -> int:
    """Return how many parameters a caller has to think of; those of a command are its options, which nobody calls."""
    if any("app.command" in ast.unparse(decorator) for decorator in function.decorator_list):
        return 0
    told = function.args
    names = [one.arg for one in (*told.posonlyargs, *told.args, *told.kwonlyargs)]
    return len(names) - (names[:1] in (["self"], ["cls"]))


def names_of(file: Path) -> Iterator[str]:
    """Yield the public names that a module defines: classes, functions, constants, types.

    Every program has a `main`, and every file of a behaviour its `RULE`.
    """
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            names = [node.name]
        else:
            targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
            names = [one.id for target in targets if target for one in ast.walk(target) if isinstance(one, ast.Name)]
        yield from (name for name in names if not name.startswith("_") and name not in ("main", "RULE"))


def _public(parent: ast.Module | ast.ClassDef) -> Iterator[ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef]:
    for node in parent.body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from _public(node)


def test_the_linter_has_no_complaint():
    assert complaints_of("ruff", "check", "--no-cache", ".") == ""


def test_every_type_is_stated_and_right():
    assert complaints_of("mypy", "--strict") == ""


def test_every_room_uses_only_what_is_below_it():
    assert complaints_of("lint-imports") == ""


def test_every_public_name_has_a_docstring():
    sources = [*PACKAGE.rglob("*.py"), *TOOLS.glob("*.py")]
    assert [complaint for source in sources for complaint in undocumented(source)] == []


def test_no_file_holds_a_path_of_one_machine():
    found = [(file.relative_to(ROOT), match[0]) for file in tracked_files() if (match := MACHINE_PATH.search(text_of(file)))]
    assert found == []


def test_a_function_fits_a_screen():
    found = [(one.name, one.end_lineno - one.lineno + 1) for file in PACKAGE.rglob("*.py") for one in functions_of(file)]
    assert {name for name, lines in found if lines > MOST_LINES} == set()


def test_a_function_takes_no_more_than_a_reader_can_hold():
    found = [(one.name, parameters_of(one)) for file in PACKAGE.rglob("*.py") for one in functions_of(file)]
    assert {name for name, parameters in found if parameters > MOST_PARAMETERS} == set()


def test_a_public_name_means_one_thing_in_the_package():
    places: dict[str, list[str]] = {}
    for file in PACKAGE.rglob("*.py"):
        for name in set(names_of(file)):
            places.setdefault(name, []).append(str(file.relative_to(PACKAGE)))
    assert {name: found for name, found in places.items() if len(found) > 1} == {}
