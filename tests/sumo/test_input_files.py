"""What SUMO reads for a configuration, whatever names it."""

import gzip
import os
from pathlib import Path

import pytest

from sumo_reactive.sumo.input_files import inputs_of, words_of

CONFIG = '<configuration><net-file value="net.xml"/>{}</configuration>'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "net.xml").write_text("<net/>")
    return tmp_path


def written(folder, more="", **files):
    """Write a configuration that says `more`, and files beside it; return its path."""
    for name, text in files.items():
        path = folder / name.replace("__", "/")
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    (folder / "c.sumocfg").write_text(CONFIG.format(more))
    return folder / "c.sumocfg"


def names(config, words=()):
    return [file.name for file in inputs_of(config, words).files]


def option(name, value):
    return f'<{name} value="{value}"/>'


WAYS = {
    "an option": (option("route-files", "wanted"), {}),
    "an option that nobody lists": (option("anything", "wanted"), {}),
    "a list": (option("additional-files", "net.xml, wanted"), {}),
    "a list with semicolons": (option("additional-files", "net.xml;wanted"), {}),
    "an attribute of another name": ('<input><include href="wanted"/></input>', {}),
    "an include": (option("additional-files", "a"), {"a": '<additional><include href="wanted"/></additional>'}),
    "an include in a folder": (option("additional-files", "sub/a"), {"sub__a": "<a><include href='../wanted'/></a>"}),
    "beside the configuration": (option("additional-files", "sub/a"), {"sub__a": '<a><rerouter file="wanted"/></a>'}),
    "the third link": (
        option("additional-files", "a"),
        {"a": '<a><x sourceFile="b"/></a>', "b": '<b routeFiles="d"/>', "d": '<vType imgFile="wanted"/>'},
    ),
    "an output's name as an input elsewhere": (
        option("additional-files", "a"), {"a": '<a><e1Detector file="wanted"/><rerouter file="wanted"/></a>'},
    ),
    "an entity": (option("additional-files", "a"), {"a": '<!DOCTYPE a [<!ENTITY b SYSTEM "wanted">]><a>&b;</a>'}),
}  # fmt: skip


@pytest.mark.parametrize("way", WAYS)
def test_a_file_counts_whatever_names_it(folder, way):
    more, files = WAYS[way]
    config = written(folder, more, wanted="<one/>", **files)
    assert "wanted" in names(config)
    before = inputs_of(config).digest
    (folder / "wanted").write_text("<two/>")
    assert inputs_of(config).digest != before


def test_a_packed_file_is_looked_into(folder):
    config = written(folder, option("additional-files", "a.gz"), wanted="<one/>")
    (folder / "a.gz").write_bytes(gzip.compress(b'<a><include href="wanted"/></a>'))
    assert "wanted" in names(config)
    (folder / "a.gz").write_bytes((folder / "a.gz").read_bytes()[:-9])
    assert names(config) == ["a.gz", "net.xml"]


def test_a_name_across_the_parts_in_which_a_file_is_read_is_found(folder, monkeypatch):
    monkeypatch.setattr("sumo_reactive.sumo.input_files._CHUNK_BYTES", 7)
    text = '<a><b c="wanted"/><e1Detector file="out"/></a>'
    config = written(folder, option("additional-files", "a"), wanted="<one/>", a=text)
    (folder / "out").write_text("")
    assert names(config) == ["a", "net.xml", "wanted"]


def test_a_variable_is_named_and_followed(folder, monkeypatch):
    config = written(folder, option("additional-files", "${HERE}/x.xml"))
    for name in ("one", "two"):
        (folder / name).mkdir(exist_ok=True)
        (folder / name / "x.xml").write_text(f"<{name}/>")
    monkeypatch.setenv("HERE", "one")
    first = inputs_of(config)
    monkeypatch.setenv("HERE", "two")
    second = inputs_of(config)
    assert "HERE" in first.variables and first.digest != second.digest
    assert [file.parent.name for file in second.files if file.name == "x.xml"] == ["two"]


def test_a_file_that_appears_later_counts_from_then_on(folder):
    config = written(folder, option("additional-files", "later"))
    before = inputs_of(config).digest
    (folder / "later").write_text("<a/>")
    assert inputs_of(config).digest != before


@pytest.mark.parametrize("options", [("--additional-files", "wanted"), ("-a=wanted",), ("-a", "net.xml,wanted")])
def test_an_option_on_the_command_line_names_a_file(folder, options):
    config = written(folder, wanted="<one/>")
    assert "wanted" in names(config, words_of(options))
    assert words_of(("--scale", "2", "--tripinfo-output", "wanted", "--fcd-output=wanted")) == ()


def test_what_sumo_writes_does_not_count(folder):
    detectors = (
        '<a><e1Detector id="x" file="out.xml"/><edgeData file="out.xml"/><timedEvent dest="out.xml"/>'
        '<param value="out.xml" key="device.ssm.file"/></a>'
    )
    more = option("tripinfo-output", "out.xml") + option("additional-files", "a")
    assert names(written(folder, more, **{"a": detectors, "out.xml": "<o/>"})) == ["a", "net.xml"]


def test_a_pipe_a_device_and_a_folder_are_no_files(folder):
    os.mkfifo(folder / "pipe")
    config = written(folder, "".join(option("anything", name) for name in ("pipe", "/dev/zero", "/", "~", "..", "")))
    assert names(config) == ["net.xml"]


def test_files_that_name_each_other_are_read_once(folder):
    config = written(folder, option("additional-files", "a"), a='<a b="c.sumocfg" c="b"/>', b='<b b="a" c="./a"/>')
    assert names(config) == ["a", "net.xml", "b"]


def test_where_a_configuration_lies_does_not_matter(folder, tmp_path_factory):
    config = written(folder, option("additional-files", "a"), a="<a/>")
    other = Path(tmp_path_factory.mktemp("other"))
    (other / "net.xml").write_text("<net/>")
    assert inputs_of(written(other, option("additional-files", "a"), a="<a/>")).digest == inputs_of(config).digest
