"""Writing: whole or not at all, past planted links, and one line where it cannot be done."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from sumo_reactive.errors import OutputError
from sumo_reactive.writing import require_writable, whole_file, whole_folder, write_whole


def names(folder):
    """Return what a folder holds, hidden names too."""
    return sorted(path.name for path in folder.iterdir())


def filled(folder, replaced=(), **files):
    with whole_folder(folder, "last.json", replaced) as partial:
        for name, text in {"last.json": "{}", **files}.items():
            path = partial / name
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")


def test_a_file_and_the_folders_above_it_are_made(tmp_path):
    write_whole(tmp_path / "deep" / "er" / "ümlaut.txt", "CO₂")
    assert (tmp_path / "deep" / "er" / "ümlaut.txt").read_bytes() == "CO₂".encode()
    assert names(tmp_path / "deep" / "er") == ["ümlaut.txt"]


def test_what_is_written_has_the_permissions_of_any_new_file_and_folder(tmp_path):
    before = os.umask(0o027)
    try:
        write_whole(tmp_path / "file", "")
        filled(tmp_path / "folder")
    finally:
        os.umask(before)
    modes = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("file", "folder", "folder/last.json")]
    assert modes == [0o640, 0o750, 0o640]


def test_a_planted_link_is_replaced_and_not_followed(tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("mine", encoding="utf-8")
    (tmp_path / "out.xml").symlink_to(victim)
    write_whole(tmp_path / "out.xml", "new")
    assert (victim.read_text(encoding="utf-8"), (tmp_path / "out.xml").read_text(encoding="utf-8")) == ("mine", "new")
    assert not (tmp_path / "out.xml").is_symlink()


def test_links_in_a_folder_are_replaced_and_not_followed(tmp_path):
    victim, out = tmp_path / "victim", tmp_path / "out"
    victim.mkdir()
    (victim / "last.json").write_text("mine", encoding="utf-8")
    (victim / "steps").write_text("mine", encoding="utf-8")
    out.mkdir()
    (out / "last.json").symlink_to(victim / "last.json")
    (out / "ego").symlink_to(victim)
    filled(out, [Path("ego/last.json")], **{"ego/steps": "new"})
    assert [path.read_text(encoding="utf-8") for path in sorted(victim.iterdir())] == ["mine", "mine"]
    assert not any(path.is_symlink() for path in out.rglob("*"))
    assert (out / "ego" / "steps").read_text(encoding="utf-8") == "new"


def test_a_folder_that_is_a_link_is_refused(tmp_path):
    (tmp_path / "victim").mkdir()
    (tmp_path / "out").symlink_to(tmp_path / "victim")
    with pytest.raises(OutputError, match="a link; name the folder"):
        require_writable(tmp_path / "out", is_folder=True)
    with pytest.raises(OutputError, match="a link; name the folder"):
        filled(tmp_path / "out")
    assert names(tmp_path / "victim") == []


def test_until_the_end_nothing_stands_under_a_name_that_can_be_guessed(tmp_path):
    seen = []
    for _ in range(2):
        with whole_file(tmp_path / "file") as partial:
            seen.append(partial.parent)
            assert names(tmp_path) == [partial.parent.name]
            assert stat.S_IMODE(partial.parent.stat().st_mode) == 0o700
            partial.write_text("", encoding="utf-8")
        (tmp_path / "file").unlink()
    assert seen[0] != seen[1]


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt(), TypeError()])
def test_an_error_within_leaves_what_was_there_and_nothing_else(tmp_path, error):
    write_whole(tmp_path / "file", "old")
    filled(tmp_path / "folder", steps="old")
    expected = OutputError if isinstance(error, OSError) else type(error)
    for target, writer in (("file", whole_file), ("new/file", whole_file), ("folder", None), ("new/folder", None)):
        with pytest.raises(expected), (writer or (lambda path: whole_folder(path, "last.json")))(tmp_path / target):
            raise error
    assert names(tmp_path) == ["file", "folder"]
    assert (tmp_path / "file").read_text(encoding="utf-8") == "old"
    assert names(tmp_path / "folder") == ["last.json", "steps"]


def test_a_folder_that_is_there_keeps_all_but_what_is_replaced(tmp_path):
    out = tmp_path / "out"
    filled(out, **{"steps": "old", "ego/steps": "old", "kept/steps": "old"})
    (out / "kept" / "notes").touch()
    (out / "tripinfo.xml").touch()
    gone = map(Path, ("steps", "ego/steps", "kept/steps", "never/there"))
    filled(out, gone, other="new")
    assert names(out) == ["kept", "last.json", "other", "tripinfo.xml"]
    assert names(out / "kept") == ["notes"]


def test_the_last_file_comes_last(tmp_path, monkeypatch):
    out = tmp_path / "out"
    filled(out, steps="old")
    replace, moved = Path.replace, []

    def noted(path, target):
        moved.append(path.name)
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", noted)
    filled(out, steps="new", way="new", **{"z/steps": "new"})
    assert moved[-1] == "last.json" and len(moved) == 4


@pytest.mark.parametrize("length", [300, 5000])
def test_a_name_that_is_too_long_is_one_line(tmp_path, length):
    for path in (tmp_path / ("x" * length), tmp_path / "new" / ("x" * length)):
        for write in (require_writable, filled, lambda one: write_whole(one, "")):
            with pytest.raises(OutputError, match="cannot be written: ") as raised:
                write(path)
            assert "\n" not in str(raised.value)
    assert names(tmp_path) == []


def test_the_longest_possible_name_is_written(tmp_path):
    require_writable(tmp_path / ("x" * 255))
    write_whole(tmp_path / ("x" * 255), "")
    filled(tmp_path / ("y" * 255))
    assert len(names(tmp_path)) == 2


def test_a_pipe_and_a_device_are_refused_and_stay(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(os.devnull)
    for path in (tmp_path / "pipe", tmp_path / "link", Path(os.devnull)):
        with pytest.raises(OutputError, match="a pipe or a device"):
            require_writable(path)
        with pytest.raises(OutputError, match="a pipe or a device"):
            write_whole(path, "")
    assert names(tmp_path) == ["link", "pipe"]


def test_a_folder_is_no_file_and_a_file_no_folder(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="a folder, not a file"):
        require_writable(tmp_path)
    with pytest.raises(OutputError, match="a file, not a folder"):
        require_writable(tmp_path / "file", is_folder=True)


def test_below_a_file_nothing_can_be_made(tmp_path):
    (tmp_path / "file").touch()
    for write in (require_writable, filled, lambda path: write_whole(path, "")):
        with pytest.raises(OutputError, match="cannot be written: "):
            write(tmp_path / "file" / "out")


FULL = """
import resource, sys
from pathlib import Path
from sumo_reactive.errors import OutputError
from sumo_reactive.writing import whole_folder, write_whole
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    write_whole(Path(sys.argv[1]) / "file", "x" * 2000)
except OutputError as error:
    print(error)
try:
    with whole_folder(Path(sys.argv[1]) / "folder", "last") as partial:
        (partial / "last").write_text("x" * 2000)
except OutputError as error:
    print(error)
"""


def test_no_room_is_one_line_and_leaves_nothing(tmp_path):
    command = [sys.executable, "-c", FULL, str(tmp_path)]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    told = [f"{tmp_path / name}: cannot be written: File too large" for name in ("file", "folder")]
    assert answer.stdout.splitlines() == told
    assert names(tmp_path) == []
