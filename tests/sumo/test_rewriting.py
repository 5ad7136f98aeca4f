"""A file's lines put through a function: all of them or none, and nothing else of the file changes."""

import gzip
import stat

import pytest

from sumo_reactive.sumo.recount import rewrite_lines

TEXT = b'<?xml version="1.0"?>\r\n<a b="\xff\xc3\xa4"/>\n<c/>'
"""Both kinds of line ends, bytes that are no UTF-8, no end of the last line."""


def edited(line: str) -> str:
    return line.replace("<c/>", "<d>ä</d>")


def names_in(folder):
    return [one.name for one in folder.iterdir()]


WANTED = TEXT.replace(b"<c/>", "<d>ä</d>".encode())


@pytest.mark.parametrize("name", ["a.xml", "a.xml.gz", "packed.xml"])
def test_what_is_not_edited_stays_to_the_byte_packed_or_not_whatever_its_name(tmp_path, name):
    file, is_packed = tmp_path / name, name != "a.xml"
    file.write_bytes(gzip.compress(TEXT) if is_packed else TEXT)
    assert rewrite_lines(file, edited) == ""
    found = file.read_bytes()
    assert (gzip.decompress(found) if is_packed else found) == WANTED


def test_each_line_is_edited_once_in_order_with_its_end(tmp_path):
    lines = []
    (tmp_path / "a.xml").write_bytes(TEXT)
    rewrite_lines(tmp_path / "a.xml", lambda line: (lines.append(line), line)[1])
    assert [line[-2:] for line in lines] == ["\r\n", ">\n", "/>"]


@pytest.mark.parametrize("mode", [0o640, 0o604])
def test_the_permissions_stay_and_a_link_stays_one(tmp_path, mode):
    (tmp_path / "there").mkdir()
    file, link = tmp_path / "there" / "a.xml", tmp_path / "link.xml"
    file.write_bytes(TEXT)
    file.chmod(mode)
    link.symlink_to(file)
    assert rewrite_lines(link, edited) == ""
    assert link.is_symlink() and file.read_bytes() == WANTED
    assert stat.S_IMODE(file.stat().st_mode) == mode
    assert names_in(tmp_path / "there") == ["a.xml"]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (None, "no such file"),
        (b"", "not XML"),
        (b"<?xm", "not XML"),
        (b"\x1f", "not XML"),
        (b"a;b\n", "not XML"),
        (gzip.compress(b"a;b\n", mtime=0), "not XML"),
        (gzip.compress(TEXT, mtime=0)[:-3], "Compressed file ended before the end-of-stream marker was reached"),
        (b"\x1f\x8bnonsense", "Unknown compression method"),
    ],
)
def test_what_cannot_be_rewritten_stays_as_it_is_and_the_reason_is_told(tmp_path, content, why):
    file = tmp_path / "a.xml"
    if content is not None:
        file.write_bytes(content)
    assert rewrite_lines(file, edited) == why
    assert [(one.name, one.read_bytes()) for one in tmp_path.iterdir()] == ([] if content is None else [("a.xml", content)])


def test_what_fails_on_the_way_leaves_the_file_and_nothing_beside_it(tmp_path):
    def fail(line):
        raise OSError(28, "No space left on device")

    file = tmp_path / "a.xml"
    file.write_bytes(TEXT)
    assert rewrite_lines(file, fail) == "No space left on device"
    assert file.read_bytes() == TEXT and names_in(tmp_path) == ["a.xml"]


def test_the_new_text_is_made_beside_the_file_under_a_hidden_name(tmp_path):
    """Only there the file can be replaced at once."""
    beside = []
    (tmp_path / "a.xml").write_bytes(TEXT)
    rewrite_lines(tmp_path / "a.xml", lambda line: (beside.extend(names_in(tmp_path)), line)[1])
    hidden = set(beside) - {"a.xml"}
    assert len(hidden) == 1 and hidden.pop().startswith(".a.xml.")
