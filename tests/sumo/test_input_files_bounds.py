"""Which value in a file, and which word of a command line, names a file that SUMO reads, case by case."""

import hashlib
from pathlib import Path

import pytest

from sumo_reactive.sumo import input_files
from sumo_reactive.sumo.input_files import inputs_of, words_of


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to be in, with a network, a folder `sub` and a file `wanted`; HOME and A are known."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    monkeypatch.setenv("A", "wan")
    (tmp_path / "sub").mkdir()
    for name in ("net.xml", "wanted", "sub/inner", "two words", "a&b"):
        (tmp_path / name).write_text(f"<{name[:1]}/>")
    return tmp_path


def named_by(folder, inner: str, words=(), place="sub/more.xml") -> list[str]:
    """What is found besides a configuration's network, and a file of it that holds `inner` as an element."""
    (folder / place).write_text(f"<a>{inner}</a>")
    config = folder / "c.sumocfg"
    config.write_text(f'<configuration><net-file value="net.xml"/><x value="{place}"/></configuration>')
    files = inputs_of(Path("c.sumocfg"), words).files
    assert all(file.is_absolute() for file in files)
    return [str(file.resolve().relative_to(folder)) for file in files if file.name not in ("net.xml", "more.xml")]


@pytest.mark.parametrize(
    ("value", "found"),
    [
        ("wanted", ["wanted"]),
        (" wanted ", []),  # padded alone it is no file's name
        ("wanted ,nowhere", ["wanted"]),
        ("nowhere; wanted", ["wanted"]),
        ("inner,wanted", ["sub/inner", "wanted"]),
        ("inner wanted", []),
        ("two words", ["two words"]),
        ("a&amp;b", ["a&b"]),
        ("./wanted", ["wanted"]),
        ("../wanted", ["wanted"]),
        ("sub/inner", ["sub/inner"]),
        ("inner", ["sub/inner"]),
        ("${A}ted", ["wanted"]),
        ("${NOBODY}wanted", ["wanted"]),
        ("~/wanted", ["wanted"]),
        ("nowhere", []),
        ("sub", []),
        ("", []),
        (",;", []),
    ],
)
def test_a_value_names_a_file_beside_its_own_or_the_configuration(folder, value, found):
    assert named_by(folder, f'<b any="{value}"/>') == found
    assert named_by(folder, f"<b any='{value}'/>") == found


def test_an_absolute_path_names_its_file(folder):
    assert named_by(folder, f'<b any="{folder / "sub" / "inner"}"/>') == ["sub/inner"]


@pytest.mark.parametrize(
    ("element", "is_read"),
    [
        ('<e1Detector file="wanted"/>', False),
        ('<e1Detectors file="wanted"/>', True),
        ("<calibrator id='1' output='wanted'>", False),
        ('<vTypeProbe file="wanted"/>', False),
        ('<param key="device.ssm.file" value="wanted"/>', False),
        ('<param value="wanted" key = "file"/>', False),
        ('<param key="other" value="wanted"/>', True),
        ('<param value="wanted"/>', True),
        ('<tripinfo-output value="wanted"/>', False),
        ('<tripinfo value="wanted"/>', False),
        ('<route-files value="wanted"/>', True),
        ('<e1Detector file="wanted"/><b file="wanted"/>', True),
        ('<b file="wanted"/><e1Detector file="wanted"/>', True),
        ('<e1Detector file="wanted"/><edgeData file="wanted"/>', False),
        ('<!-- "wanted" -->', True),
    ],
)
def test_what_stands_only_where_sumo_writes_is_not_read(folder, element, is_read):
    assert named_by(folder, element) == (["wanted"] if is_read else [])


@pytest.mark.parametrize("size", [1, 2, 3, 5, 16, 1000])
def test_however_a_file_is_cut_as_it_is_read_all_names_are_found_and_its_digest_is_the_same(folder, monkeypatch, size):
    inner = '<b x="wanted"/><e1Detector file="inner"/><c y="${A}ted" z="two words"/>'
    whole = inputs_of(folder / "c.sumocfg") if named_by(folder, inner) else None
    monkeypatch.setattr(input_files, "_CHUNK_BYTES", size)
    assert named_by(folder, inner) == ["wanted", "two words"]
    assert inputs_of(folder / "c.sumocfg") == whole


def test_the_digest_is_that_of_all_files_but_the_configuration_in_their_order(folder):
    assert named_by(folder, '<b any="wanted"/>', place="more.xml") == ["wanted"]
    found = inputs_of(folder / "c.sumocfg")
    assert [file.name for file in found.files] == ["more.xml", "net.xml", "wanted"]
    parts = b"".join(hashlib.sha256(file.read_bytes()).digest() for file in found.files)
    assert found.digest == hashlib.sha256(parts).hexdigest()
    (folder / "c.sumocfg").write_text((folder / "c.sumocfg").read_text() + "\n")
    assert inputs_of(folder / "c.sumocfg") == found


def test_variables_are_named_in_order_wherever_they_stand(folder):
    named_by(folder, '<b any="${Z}/x ${B}"/>')
    config = folder / "c.sumocfg"
    assert inputs_of(config).variables == ("B", "PHEMLIGHT_PATH", "Z")
    assert inputs_of(config, ("${C}", "x${D}")).variables == ("B", "C", "D", "PHEMLIGHT_PATH", "Z")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("-a", "wanted"), ("wanted",)),
        (("wanted",), ("wanted",)),
        (("-a=wanted",), ("wanted",)),
        (("--x=${Y}",), ("${Y}",)),
        (("--x=a=b", "${Y}/z"), ("${Y}/z",)),
        (("x=wanted",), ()),
        (("a=${Y}",), ("a=${Y}",)),
        (("--tripinfo", "wanted"), ()),
        (("--tripinfo-output=wanted", "wanted"), ("wanted",)),
        (("--fcd-output", "${Y}"), ()),
        (("--fcd-output", "x", "-r", "wanted,x"), ("wanted,x",)),
        (("--seed", "3"), ()),
    ],
)
def test_a_word_matters_that_names_a_file_to_read_or_a_variable(folder, options, words):
    assert words_of(options) == words


def test_words_are_paths_from_where_the_program_runs(folder, monkeypatch):
    named_by(folder, "")
    monkeypatch.chdir(folder / "sub")
    files = [file.name for file in inputs_of(folder / "c.sumocfg", ("inner", "wanted")).files]
    assert files == ["net.xml", "more.xml", "inner"]
