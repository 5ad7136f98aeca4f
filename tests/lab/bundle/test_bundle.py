"""Bundles: what a record was made from, in one file; driven again the same comes, and nobody's bundle leads elsewhere."""

import hashlib
import json
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path
from zipfile import ZipFile

import numpy
import pytest
from helpers.programs import sumo_reactive
from helpers.still import STILL

from sumo_reactive.errors import InputError, OutputError, ScenarioError
from sumo_reactive.lab.bundle.manifest import MANIFEST
from sumo_reactive.lab.bundle.packing import write_bundle
from sumo_reactive.lab.bundle.reproduction import drive_again
from sumo_reactive.lab.comparison.comparison import compare
from sumo_reactive.lab.comparison.record import write
from sumo_reactive.lab.drivers.choice import DriverChoice
from sumo_reactive.lab.recorder import SUMMARY, Recorder
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial

ROOT = Path(__file__).parents[3]
NETWORK = ROOT / "networks" / "four_way_priority"
HORIZON_S = 3.0

COMMAND = "sumo-reactive run inputs/day/a.sumocfg"
ADDITIONAL = "inputs/day/more.add.xml"


def named(command):
    """Return an edit that gives the run another command."""
    return lambda manifest, files: manifest["runs"][0].update(command=command)


def moved_into_a_file(manifest, files):
    """Let an input lie in another as if that were a folder."""
    one = manifest["inputs"][-1]
    files["inputs/day/a.sumocfg/x"] = files.pop(one["name"])
    one["name"] = "inputs/day/a.sumocfg/x"


def written_to(place):
    """Return an edit that makes the detector write somewhere else."""
    return replaced(ADDITIONAL, lambda text: text.replace("loops.xml", place))


@pytest.fixture
def city(tmp_path):
    """A scenario whose network lies in another folder than its configuration, with a detector and an output."""
    folder = tmp_path / "city"
    (folder / "net").mkdir(parents=True)
    (folder / "day").mkdir()
    name = NETWORK.name
    shutil.copy(NETWORK / f"{name}.net.xml", folder / "net")
    shutil.copy(NETWORK / f"{name}.rou.xml", folder / "day")
    lane = next(line.split('id="')[1].split('"')[0] for line in (NETWORK / f"{name}.net.xml").read_text().splitlines()
                if "<lane " in line and 'id=":' not in line)  # fmt: skip
    detector = f'<additional><inductionLoop id="a" lane="{lane}" pos="1" period="10" file="loops.xml"/></additional>'
    (folder / "day" / "more.add.xml").write_text(detector, encoding="utf-8")
    (folder / "day" / "a.sumocfg").write_text(
        f'<configuration><net-file value="../net/{name}.net.xml"/><route-files value="{name}.rou.xml"/>'
        f'<additional-files value="more.add.xml"/><summary-output value="{tmp_path / "summary.xml"}"/></configuration>',
        encoding="utf-8",
    )
    return folder / "day" / "a.sumocfg"


@pytest.fixture
def record(city, tmp_path):
    """A trip of three seconds, with an option that names a file, and an output that does not matter."""
    options = ("--additional-files", str(city.parent / "more.add.xml"), "--tripinfo-output", str(tmp_path / "trips.xml"))
    scenario = replace(load_scenario(city), ego="ego", seed=7, horizon_s=HORIZON_S, sumo_options=options)
    recorder = Recorder(tmp_path / "record")
    recorder.write(run_trial(scenario, observer=recorder.see))
    return tmp_path / "record"


def manifest_in(bundle):
    with ZipFile(bundle) as archive:
        return json.loads(archive.read(MANIFEST))


def changed(bundle, edit=lambda manifest, files: None):
    """Write a bundle anew after `edit` has changed its manifest or files by name."""
    with ZipFile(bundle) as archive:
        files = {name: archive.read(name) for name in archive.namelist() if name != MANIFEST}
        manifest = json.loads(archive.read(MANIFEST))
    edit(manifest, files)
    with ZipFile(bundle, "w") as archive:
        archive.writestr(MANIFEST, json.dumps(manifest))
        for name, content in files.items():
            archive.writestr(name, content)
    return bundle


def replaced(name, content):
    """Return an edit that puts other content into an input, with the digest that belongs to it."""

    def edit(manifest, files):
        files[name] = content(files[name].decode()).encode()
        (one,) = (one for one in manifest["inputs"] if one["name"] == name)
        one.update(sha256=hashlib.sha256(files[name]).hexdigest(), bytes=len(files[name]))

    return edit


def test_a_run_is_driven_again_from_its_bundle_alone_and_is_the_same(record, city, tmp_path):
    manifest = write_bundle(record, tmp_path / "b.zip")
    shutil.rmtree(city.parents[1])
    (tmp_path / "summary.xml").unlink(missing_ok=True)
    found = drive_again(tmp_path / "b.zip")
    assert [one.verdict for one in found.runs] == ["the same to the last bit"]
    assert found.changed == () and manifest.seeds == [7]
    names = {"inputs/day/a.sumocfg", "inputs/day/more.add.xml", f"inputs/day/{NETWORK.name}.rou.xml",
             f"inputs/net/{NETWORK.name}.net.xml"}  # fmt: skip
    assert {one.name for one in manifest.inputs} == names
    (run,) = manifest.runs
    assert run.command.startswith("sumo-reactive run inputs/day/a.sumocfg --ego ego --seed 7 --horizon 3 ")
    assert run.command.endswith(" -- --additional-files inputs/day/more.add.xml")
    assert not (tmp_path / "summary.xml").exists()
    with ZipFile(tmp_path / "b.zip") as archive:
        assert archive.read(f"record/{SUMMARY}") == (record / SUMMARY).read_bytes()


def test_the_same_record_makes_the_same_bundle(record, tmp_path):
    for name in ("one.zip", "other.zip"):
        write_bundle(record, tmp_path / name)
        os.utime(record / SUMMARY, (0, 10**9))
    assert (tmp_path / "one.zip").read_bytes() == (tmp_path / "other.zip").read_bytes()


def test_another_trip_is_told_with_what_is_of_another_version(record, tmp_path):
    write_bundle(record, tmp_path / "b.zip")

    def older(manifest, files):
        manifest["runs"][0]["trajectory"] = "0" * 64
        manifest["versions"][0]["numpy"] = "1.0"

    answer = sumo_reactive("reproduce", changed(tmp_path / "b.zip", older), "--jobs", 1)
    run, numpy_then, many = answer.stdout.splitlines()
    assert answer.returncode == 1 and run.startswith("another trip: sumo-reactive run inputs/")
    assert numpy_then == f"numpy: 1.0 then, {numpy.__version__} now" and many == "0 of 1 run the same to the last bit"


def test_digests_alone_need_the_same_files(record, city, tmp_path):
    bundle = tmp_path / "b.zip"
    write_bundle(record, bundle, has_inputs=False)
    with ZipFile(bundle) as archive:
        assert not [name for name in archive.namelist() if name.startswith("inputs/")]
    with pytest.raises(ScenarioError, match="name the folder of its inputs with --inputs"):
        drive_again(bundle)
    assert drive_again(bundle, inputs=city.parents[1]).runs[0].is_same
    with (city.parent / "more.add.xml").open("a", encoding="utf-8") as file:
        file.write("\n")
    with pytest.raises(ScenarioError, match=r"more\.add\.xml: not the file that was driven with"):
        drive_again(bundle, inputs=city.parents[1])
    with pytest.raises(ScenarioError, match="cannot be read"):
        drive_again(bundle, inputs=tmp_path)


def test_both_runs_of_a_comparison_are_driven_again(city, tmp_path):
    scenario = replace(load_scenario(city), ego="ego")
    (comparison,) = compare([scenario], horizon_s=HORIZON_S, jobs=1, wall_limit_s=60.0)
    write(comparison, tmp_path / "compared")
    manifest = write_bundle(tmp_path / "compared", tmp_path / "b.zip")
    assert ["--driver sumo" in run.command for run in manifest.runs] == [False, True]
    found = drive_again(tmp_path / "b.zip")
    assert [one.is_same for one in found.runs] == [True, True]


def test_the_trials_of_a_store_are_driven_again_shares_of_egos_among_them(city, tmp_path):
    more = {"e": 'drivers = ["reactive", "sumo"]\n[parameters]\nstuck_s = [50.0]\n[options]\nscale = [1.5]\n',
            "shares": "[egos]\nshare = [0.5]\n"}  # fmt: skip
    for name, rest in more.items():
        head = f'[experiment]\nscenarios = ["{city}"]\nseeds = [3]\nuntil_s = 40.0\n'
        (tmp_path / f"{name}.toml").write_text(head + rest, encoding="utf-8")
        assert sumo_reactive("batch", f"{name}.toml", "--workers", 1, cwd=tmp_path).returncode == 0
        told = sumo_reactive("bundle", f"{name}.duckdb", "--out", f"{name}.zip", cwd=tmp_path)
        assert told.stdout == f"{name}.zip: {2 - (name == 'shares')} run{'s' * (name == 'e')}, 4 inputs of 0.0 MB\n"
        again = sumo_reactive("reproduce", f"{name}.zip", "--quiet", cwd=tmp_path)
        assert (again.returncode, again.stdout.count("the same to the last bit")) == (0, 1), again.stdout
        assert "sources" in manifest_in(tmp_path / f"{name}.zip")["versions"][0]


def test_a_driver_of_the_users_drives_only_where_it_is_named(city, tmp_path, monkeypatch):
    (tmp_path / "still.py").write_text(STILL, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    driver = DriverChoice("still:Still", (), tmp_path)
    recorder = Recorder(tmp_path / "record")
    scenario = replace(load_scenario(city), ego="ego", horizon_s=HORIZON_S, driver=driver)
    recorder.write(run_trial(scenario, observer=recorder.see))
    write_bundle(tmp_path / "record", tmp_path / "b.zip")
    with pytest.raises(ScenarioError, match="was driven by 'still:Still': name it with --driver"):
        drive_again(tmp_path / "b.zip")
    assert drive_again(tmp_path / "b.zip", drivers=["still:Still"]).runs[0].is_same


def test_inputs_that_lie_elsewhere_by_an_absolute_path_are_told_when_the_bundle_is_made(record, city, tmp_path):
    name = f"{NETWORK.name}.net.xml"
    city.write_text(city.read_text().replace(f"../net/{name}", str(city.parents[1] / "net" / name)), encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"outside the bundle|leads out of the bundle"):
        write_bundle(record, tmp_path / "b.zip")
    assert not (tmp_path / "b.zip").exists()


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (lambda manifest, files: manifest.update(version=99), "of version 99, and this release reads 1"),
        (lambda manifest, files: manifest.update(runs=[]), "key 'runs'"),
        (lambda manifest, files: manifest["inputs"][0].update(name="inputs/../../x"), "no name of a file below 'inputs'"),
        (lambda manifest, files: manifest["inputs"][0].update(name="/etc/x"), "no name of a file below 'inputs'"),
        (lambda manifest, files: manifest["inputs"][0].update(name="record/x"), "no name of a file below 'inputs'"),
        (lambda manifest, files: manifest["inputs"].append(manifest["inputs"][0]), "two inputs have one name"),
        (lambda manifest, files: manifest["inputs"][0].update(bytes=10**12), "key 'inputs.0.bytes'"),
        (lambda manifest, files: manifest["inputs"][0].update(sha256="0" * 64), "not the file that was driven with"),
        (lambda manifest, files: manifest["inputs"][0].update(bytes=10), "not the file that was driven with"),
        (lambda manifest, files: files.pop("inputs/day/a.sumocfg"), "lacks 'inputs/day/a.sumocfg'"),
        (moved_into_a_file, "cannot be written"),
        (named(f"{COMMAND} '"), "not a run of a configuration in the bundle"),
        (named("rm -rf ."), "not a run of a configuration in the bundle"),
        (named("sumo-reactive run /etc/passwd"), "not a run of a configuration in the bundle"),
        (named(f"{COMMAND} --gui"), "not the command of a run"),
        (named(f"{COMMAND} -- --tripinfo-output t.xml"), "SUMO option 'tripinfo-output' is none that a bundle may give"),
        (named(f"{COMMAND} -- --output-prefix=/etc/"), "leads out of the bundle"),
        (named(f"{COMMAND} --driver os:system"), "was driven by 'os:system': name it with --driver"),
        (written_to("/etc/loops.xml"), "'/etc/loops.xml' leads out of the bundle"),
        (written_to("x/../../../loops.xml"), "leads out of the bundle"),
        (written_to("${HOME}/loops.xml"), "leads out of the bundle"),
        (replaced(ADDITIONAL, lambda text: f"<!-- don't -->{text.replace('loops.xml', '~/l.xml')}"), "'~/l.xml' leads out"),
        (replaced(ADDITIONAL, lambda text: f'<!DOCTYPE a [<!ENTITY b "/c">]>{text}'), "a document type of its own"),
    ],
)  # fmt: skip
def test_a_bundle_that_leads_elsewhere_or_is_damaged_is_refused(record, tmp_path, edit, says):
    write_bundle(record, tmp_path / "b.zip")
    with pytest.raises((ScenarioError, OutputError), match=re.escape(says)):
        drive_again(changed(tmp_path / "b.zip", edit))


def test_what_is_no_archive_is_refused(tmp_path):
    (tmp_path / "text.zip").write_text("no archive", encoding="utf-8")
    with ZipFile(tmp_path / "empty.zip", "w"):
        pass
    os.mkfifo(tmp_path / "pipe.zip")
    for name, says in {"text": "not a bundle", "empty": "no manifest", "pipe": "a pipe", "none": "no such file"}.items():
        with pytest.raises(ScenarioError, match=says):
            drive_again(tmp_path / f"{name}.zip")


def test_a_record_whose_digest_is_none_makes_no_bundle(record, tmp_path):
    summary = json.loads((record / SUMMARY).read_text(encoding="utf-8"))
    (record / SUMMARY).write_text(json.dumps(summary | {"trajectory": "none"}), encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"record: cannot be in a bundle: .*'none'"):
        write_bundle(record, tmp_path / "b.zip")


def test_what_is_no_record_of_runs_makes_no_bundle(record, city, tmp_path):
    summary = json.loads((record / SUMMARY).read_text(encoding="utf-8"))
    del summary["command"]
    (record / SUMMARY).write_text(json.dumps(summary), encoding="utf-8")
    wanting = (record, "key 'command' is missing"), (tmp_path / "none", "no such file"), (city, "not the store of an")
    for path, says in wanting:
        with pytest.raises(InputError, match=says):
            write_bundle(path, tmp_path / "b.zip")
    assert not (tmp_path / "b.zip").exists()
