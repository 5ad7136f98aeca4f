"""The door for files from outside: what is no file of bounded size is told in one line."""

import gzip
import os
import random
import socket

import pytest

from sumo_reactive.errors import NetworkError, ScenarioError
from sumo_reactive.files import content_of, is_there, require_file, text_of

TEXT = random.Random(7).randbytes(5000)


@pytest.mark.parametrize("data", [b"", b"plain", gzip.compress(TEXT), gzip.compress(TEXT) + gzip.compress(TEXT)])
def test_a_file_is_read_packed_or_not(tmp_path, data):
    (tmp_path / "a").write_bytes(data)
    assert content_of(tmp_path / "a") == (gzip.decompress(data) if data.startswith(b"\x1f\x8b") else data)


@pytest.mark.parametrize("length", [2, 5, 12, 400, 4000, -1])
def test_a_packed_file_that_is_cut_off_is_told_so(tmp_path, length):
    (tmp_path / "a.gz").write_bytes(gzip.compress(TEXT)[:length])
    with pytest.raises(NetworkError, match=r"a\.gz: cannot be read: .*cut off"):
        content_of(tmp_path / "a.gz", NetworkError)


@pytest.mark.parametrize("at", [3, 500, -3])
def test_a_packed_file_that_is_damaged_is_told_so(tmp_path, at):
    data = bytearray(gzip.compress(TEXT))
    data[at] ^= 0xFF
    (tmp_path / "a.gz").write_bytes(data)
    with pytest.raises(ScenarioError, match=r"a\.gz: cannot be read"):
        content_of(tmp_path / "a.gz")


def test_a_small_packed_file_that_unpacks_into_much_is_not_unpacked(tmp_path):
    (tmp_path / "a.gz").write_bytes(gzip.compress(bytes(10_000_000)))
    with pytest.raises(ScenarioError, match="more than 1 MB"):
        content_of(tmp_path / "a.gz", most=10**6)


def test_what_is_no_file_is_named_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with socket.socket(socket.AF_UNIX) as door:
        door.bind(str(tmp_path / "socket"))
        for path, says in (
            (tmp_path / "pipe", "a pipe, not a file"),
            (tmp_path, "a directory, not a file"),
            (tmp_path.joinpath("/dev/zero"), "a device, not a file"),
            (tmp_path / "loop", "cannot be read: Too many levels of symbolic links"),
            (tmp_path / ("x" * 300), "cannot be read: File name too long"),
            (tmp_path / "a\0b", "cannot be read: .*null byte"),
        ):
            for door_of in (content_of, require_file):
                with pytest.raises(ScenarioError, match=says):
                    door_of(path)
        with pytest.raises(ScenarioError, match="a socket, not a file"):
            require_file(tmp_path / "socket")
        with pytest.raises(ScenarioError, match="cannot be read"):
            content_of(tmp_path / "socket")


def test_a_name_that_cannot_be_names_nothing(tmp_path):
    assert is_there(tmp_path)
    assert not any(is_there(tmp_path / name) for name in ("x", "x" * 300, "a\0b"))
    require_file(tmp_path / "x")


def test_what_is_no_utf8_is_no_text(tmp_path):
    (tmp_path / "a").write_bytes(b"abc\xff")
    with pytest.raises(ScenarioError, match="not UTF-8 at byte 3"):
        text_of(tmp_path / "a")
