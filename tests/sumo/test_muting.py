"""A simulation that writes nothing."""

import sys

import pytest

from sumo_reactive.sumo.muting import mute, prefix_of, with_prefix

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="open files are found by /proc")


def test_what_is_open_under_the_prefix_is_gone_and_may_still_be_written_to(tmp_path):
    prefix = prefix_of(7)
    (tmp_path / "other.xml").write_text("stays")
    with (tmp_path / f"{prefix}out.xml").open("w") as mine, (tmp_path / "mine.xml").open("w") as others:
        mute(prefix)
        mine.write("nowhere")
        others.write("somewhere")
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"other.xml": "stays", "mine.xml": "somewhere"}


def test_two_processes_have_prefixes_of_their_own():
    assert prefix_of(7) != prefix_of(71) and not prefix_of(71).startswith(prefix_of(7))


def test_a_prefix_of_the_users_gives_way():
    assert with_prefix(("--output-prefix", "mine_", "--scale", "2"), ".p.") == ("--output-prefix", ".p.", "--scale", "2")
