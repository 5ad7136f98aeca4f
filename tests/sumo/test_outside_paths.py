"""Paths that lead out of a folder, in files of SUMO's and on its command line."""

import gzip

import pytest

from sumo_reactive.sumo.outside_paths import leads_out, path_outside


@pytest.mark.parametrize(
    ("value", "is_outside"),
    [
        ("a.xml", False), ("net/a.xml", False), ("../beside/a.xml", False), ("a.xml,b/c.xml", False), ("1.5", False),
        ("http://sumo.dlr.de/xsd/a.xsd", False), ("", False), ("Main..Street", False), ("../../a.xml", True),
        ("b/../../../a.xml", True), ("..\\..\\a.xml", True), ("/a.xml", True), ("\\\\host\\a.xml", True), ("~/a.xml", True),
        ("C:\\a.xml", True), ("c:/a.xml", True), ("${HOME}", True), ("a.xml, /b.xml", True), ("a.xml;../../b.xml", True),
    ],
)  # fmt: skip
def test_what_leads_out_of_a_folder(tmp_path, value, is_outside):
    assert leads_out(value, tmp_path / "root" / "day", tmp_path / "root") == is_outside


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('<additional><edgeData id="a" file="out.xml"/></additional>', ""),
        ('<additional><!-- don\'t --><edgeData id="a" file="/out.xml"/></additional>', "/out.xml"),
        ("<additional><edgeData file='&#47;out.xml'/></additional>", "/out.xml"),
        ("<configuration><net-file> /a.net.xml </net-file></configuration>", "/a.net.xml"),
        ('<configuration><tripinfo-output value="/t.xml"/></configuration>', ""),
        ('<configuration><tripinfo>/t.xml</tripinfo></configuration>', "/t.xml"),
        ('<configuration><save-state.prefix value="/t"/></configuration>', "/t"),
        ('<a><b file="/one.xml"/><b file="/other.xml"/>', "/one.xml"),
        ('<!DOCTYPE a SYSTEM "b.dtd"><a/>', "a document type of its own"),
        ("no XML: /a", ""),
        ("", ""),
    ],
)  # fmt: skip
@pytest.mark.parametrize("is_packed", [False, True], ids=["plain", "packed"])
def test_what_leads_out_in_a_file(tmp_path, text, found, is_packed):
    file = tmp_path / "a.xml"
    file.write_bytes(gzip.compress(text.encode()) if is_packed else text.encode())
    assert path_outside(file, tmp_path) == found
