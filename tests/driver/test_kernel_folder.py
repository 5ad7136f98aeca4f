"""Compiled kernels come from a folder that nobody else can write to, or from none."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sumo_reactive.driver import kernel_folder
from sumo_reactive.driver.kernel_folder import FOLDER_VARIABLE, kernel_root, own_folder
from sumo_reactive.files import is_own

NOBODY = 65534
CODE = "from sumo_reactive.driver.kernel_folder import CACHE_FOLDER; print(CACHE_FOLDER)"


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """A folder for temporary files as every machine has it; nothing made here outlives the test or is shared."""
    place = tmp_path / "temporary"
    place.mkdir()
    place.chmod(0o1777)
    monkeypatch.setattr("tempfile.tempdir", str(place))
    monkeypatch.setattr(kernel_folder.atexit, "register", lambda function: None)
    monkeypatch.setenv(FOLDER_VARIABLE, "")
    return place


def open_to(folder, mode):
    folder.mkdir()
    folder.chmod(mode)
    return folder


def test_the_users_cache_is_made_for_the_user_alone(tmp_path):
    root = kernel_root({"XDG_CACHE_HOME": str(tmp_path / "new" / "cache")})
    assert root == tmp_path / "new" / "cache" / "sumo_reactive"
    assert [place.stat().st_mode & 0o777 for place in (root, root.parent, root.parent.parent)] == [0o700] * 3


@pytest.mark.parametrize("mode", [0o777, 0o775, 0o757])
def test_a_cache_that_others_can_write_to_is_not_used(tmp_path, temporary, mode):
    cache = open_to(tmp_path / "cache", mode)
    root = kernel_root({"XDG_CACHE_HOME": str(cache)})
    assert root.parent == temporary and root.name != "sumo_reactive" and is_own(root)
    assert list(cache.iterdir()) == []


def test_a_cache_below_a_folder_that_others_can_write_to_is_not_used(tmp_path):
    below = open_to(tmp_path / "open", 0o777) / "cache"
    below.mkdir(mode=0o700)
    assert own_folder(below) is None
    (tmp_path / "open").chmod(0o1777)
    assert own_folder(below) == below


def test_in_a_folder_for_all_only_what_is_below_it_is_safe(tmp_path):
    assert own_folder(open_to(tmp_path / "cache", 0o1777)) is None


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder away")
@pytest.mark.parametrize("given_away", ["cache", "cache/sumo_reactive"])
def test_a_folder_of_somebody_else_is_not_used(tmp_path, temporary, given_away):
    (tmp_path / "cache" / "sumo_reactive").mkdir(parents=True)
    os.chown(tmp_path / given_away, NOBODY, NOBODY)
    assert kernel_root({"XDG_CACHE_HOME": str(tmp_path / "cache")}).parent == temporary


def test_a_planted_link_to_a_folder_for_all_is_not_used(tmp_path):
    (tmp_path / "link").symlink_to(open_to(tmp_path / "open", 0o777))
    assert own_folder(tmp_path / "link") is None


def test_a_file_in_place_of_the_cache_is_not_used(tmp_path, temporary):
    (tmp_path / "cache").touch()
    assert kernel_root({"XDG_CACHE_HOME": str(tmp_path / "cache")}).parent == temporary


def test_no_folder_is_used_where_even_that_for_temporary_files_is_not_safe(tmp_path, temporary):
    temporary.chmod(0o777)
    assert kernel_root({"XDG_CACHE_HOME": str(open_to(tmp_path / "cache", 0o777))}) is None
    assert FOLDER_VARIABLE not in os.environ or not os.environ[FOLDER_VARIABLE]


def test_a_private_folder_is_shared_with_the_processes_that_one_starts(tmp_path, temporary):
    unsafe = {"XDG_CACHE_HOME": str(open_to(tmp_path / "cache", 0o777))}
    root = kernel_root(unsafe)
    shared = {FOLDER_VARIABLE: os.environ[FOLDER_VARIABLE]}
    assert kernel_root(unsafe | shared) == root
    root.chmod(0o770)
    assert kernel_root(unsafe | shared) != root
    root.rmdir()
    assert kernel_root(unsafe | shared) != root and not root.exists()


def with_cache(folder, temporary, code=CODE):
    environment = os.environ | {"XDG_CACHE_HOME": str(folder), "TMPDIR": str(temporary)}
    return subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=120, check=True
    )


def test_a_private_folder_ends_with_the_process_also_when_it_starts_another_program_in_its_place(tmp_path, temporary):
    cache = open_to(tmp_path / "cache", 0o777)
    answer = with_cache(cache, temporary)
    assert Path(answer.stdout.strip()).parent.parent == temporary
    assert list(temporary.iterdir()) == []
    again = f"import os, sys; {CODE}; sys.stdout.flush(); os.execv(sys.executable, [sys.executable, '-c', {CODE!r}])"
    one, two = with_cache(cache, temporary, again).stdout.splitlines()
    assert one == two
    assert list(temporary.iterdir()) == []
