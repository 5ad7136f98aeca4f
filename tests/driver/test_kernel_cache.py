"""Kernels on disk: what is damaged or cannot be kept is compiled again, in one line."""

import ast
import pickle
import shutil
from pathlib import Path

import pytest
from helpers.programs import run_program

import sumo_reactive
from sumo_reactive.driver.kernel_cache import KernelCache
from sumo_reactive.driver.kernel_folder import CALLBACK_FILES, KERNEL_ROOMS, READ_ROOMS

CODE = """
from pathlib import Path
import resource, sys
import numba
from sumo_reactive.driver.kernel_cache import KernelCache

def inner(x):
    return 2.0 * x

def outer(x):
    return doubled(x) + 1.0

doubled, found = numba.njit(inner), numba.njit(outer)
for function in (doubled, found):
    function._cache = KernelCache(function.py_func, Path(sys.argv[1]), lambda: None)
if len(sys.argv) > 2:
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
print(found(20.5), sum(found.stats.cache_hits.values()))
"""


def called(folder, *more):
    """Call a kernel in a new process: its value, how often it came from the disk, what was said."""
    program = folder.with_name("calls.py")
    program.write_text(CODE, encoding="utf-8")
    answer = run_program(program, folder, *more)
    program.unlink()
    answer.check_returncode()
    return *answer.stdout.split(), answer.stderr


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with two kernels."""
    folder = tmp_path_factory.mktemp("made") / "kernels"
    folder.mkdir(mode=0o700)
    assert called(folder) == ("42.0", "0", "")
    assert len(list(folder.iterdir())) == 2
    return folder


@pytest.fixture
def kept(made, tmp_path):
    """A copy of the folder with two kernels."""
    return shutil.copytree(made, tmp_path / "kernels")


def test_a_kernel_comes_from_the_disk(kept):
    assert called(kept) == ("42.0", "1", "")


def halved(content):
    return content[: len(content) // 2]


def turned(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


class Planted:
    """What would run if it were loaded."""

    def __reduce__(self):
        return exec, ("raise SystemExit('loaded')",)


@pytest.mark.parametrize(
    "damage", [lambda _: b"", lambda _: b"text", halved, turned, lambda _: pickle.dumps(Planted())],
    ids=["empty", "text", "cut off", "one bit", "another pickle"],
)  # fmt: skip
def test_a_damaged_kernel_is_compiled_again_and_one_line_says_so(kept, damage):
    for file in kept.iterdir():
        file.write_bytes(damage(file.read_bytes()))
    assert called(kept) == ("42.0", "0", f"{kept}: damaged kernels are compiled again\n")
    assert called(kept) == ("42.0", "1", "")


def test_a_folder_that_others_can_write_to_is_neither_read_nor_written(kept):
    kept.chmod(0o777)
    (removed, *_) = kept.iterdir()
    removed.unlink()
    assert called(kept) == ("42.0", "0", "")
    assert not removed.exists()


def test_a_folder_that_is_gone_is_not_made_again(tmp_path):
    assert called(tmp_path / "gone") == ("42.0", "0", "")
    assert list(tmp_path.iterdir()) == []


def test_without_room_kernels_are_not_kept_and_the_run_goes_on(tmp_path):
    folder = tmp_path / "kernels"
    folder.mkdir(mode=0o700)
    value, hits, said = called(folder, "no room")
    assert (value, hits) == ("42.0", "0")
    assert all("compiled kernels are not kept: " in line and "File too large" in line for line in said.splitlines())
    assert said and list(folder.iterdir()) == []


def test_other_kinds_of_arguments_have_a_file_of_their_own(tmp_path):
    tmp_path.chmod(0o700)
    caches = (KernelCache(one, tmp_path, lambda: None) for one in (halved, turned))
    files = {cache._file(kinds, Codegen()) for cache in caches for kinds in ("f", "i")}
    assert len(files) == 4


class Codegen:
    """The code generator of some machine."""

    def magic_tuple(self):
        return "x86_64", "some processor", ""


def test_every_room_with_a_kernel_is_in_the_name_of_the_folder():
    package = Path(sumo_reactive.__file__).parent
    holding = {file.parent for file in package.rglob("*.py") if "\n@kernel\n" in file.read_text(encoding="utf-8")}
    assert {folder.relative_to(package).as_posix() for folder in holding} == set(KERNEL_ROOMS)


def test_every_file_with_a_function_that_other_languages_call_is_in_the_name_of_the_folder():
    package = Path(sumo_reactive.__file__).parent
    holding = [file for file in package.rglob("*.py") if " = callback(" in file.read_text(encoding="utf-8")]
    assert {file.relative_to(package).as_posix() for file in holding} == set(CALLBACK_FILES)


def read_by_kernels(file):
    """Return the modules from which a file takes constants that its kernels name."""
    module = ast.parse(file.read_text(encoding="utf-8"))
    kernels = [
        node
        for node in module.body
        if isinstance(node, ast.FunctionDef) and any(ast.unparse(one) == "kernel" for one in node.decorator_list)
    ]
    named = {part.id for one in kernels for part in ast.walk(one) if isinstance(part, ast.Name) and part.id.isupper()}
    imports = [node for node in module.body if isinstance(node, ast.ImportFrom)]
    return {node.module for node in imports if named & {alias.asname or alias.name for alias in node.names}}


def test_every_room_with_a_constant_that_a_kernel_reads_is_in_the_name_of_the_folder():
    package = Path(sumo_reactive.__file__).parent
    read = {name for room in KERNEL_ROOMS for file in (package / room).glob("*.py") for name in read_by_kernels(file)}
    rooms = {"/".join(name.split(".")[1:-1]) for name in read}
    assert rooms <= {*KERNEL_ROOMS, *READ_ROOMS} and set(READ_ROOMS) <= rooms
