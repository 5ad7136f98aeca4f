"""The pages of reference: they are what the code says, nothing is left out, and what they say of reading a file is so."""

import re
import shutil

import duckdb
import pytest
import typer
from helpers.programs import ROOT, run_tool
from helpers.recordings import made_record, step

from sumo_reactive.cli.app import app
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction, Occupancy, Reason
from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.driver.parameters import NAMES
from sumo_reactive.errors import ExitCode, ReactiveError
from sumo_reactive.lab.batch.experiment import EgoKeys, ExperimentFile, ExperimentKeys, SampleKeys
from sumo_reactive.lab.batch.store import Store
from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.lab.columns import COLUMNS
from sumo_reactive.lab.comparison.comparison import Comparison
from sumo_reactive.lab.comparison.record import data_of
from sumo_reactive.lab.metric_names import EVERY, unit_of_parameter
from sumo_reactive.lab.metrics.safety.pairs import PairLog
from sumo_reactive.lab.metrics.safety.series import encounter_columns
from sumo_reactive.lab.recorder import FILES, fleet_summary
from sumo_reactive.lab.result import FleetResult
from sumo_reactive.lab.scenario import Expectation, Limit, RuleKeys, ScenarioKeys

FOLDER = ROOT / "docs" / "reference"
COMMANDS = typer.main.get_command(app).commands


def page(name):
    """Return the text of a page."""
    return (FOLDER / f"{name}.md").read_text(encoding="utf-8")


def section(text, heading):
    """Return what stands below a heading, up to the next one."""
    (found,) = re.findall(rf"^##+ {re.escape(heading)}\n(.*?)(?=^##|\Z)", text, re.DOTALL | re.MULTILINE)
    return found


def firsts(text):
    """Return the first cells of all rows, with the names in them."""
    return [cell.strip("` ") for cell in re.findall(r"^\| ([^|]+) \|", text, re.MULTILINE)]


def test_the_pages_are_what_the_code_says():
    answer = run_tool("reference_pages", "--check")
    assert (answer.returncode, answer.stdout) == (0, "up to date\n"), answer.stderr


def test_a_page_that_is_out_of_date_is_written_anew(tmp_path):
    copy = tmp_path / "reference"
    shutil.copytree(FOLDER, copy)
    (copy / "metrics.md").write_text("# Metrics\n", encoding="utf-8")
    assert run_tool("reference_pages", "--check", "--folder", copy).stdout == "out of date: metrics.md\n"
    assert run_tool("reference_pages", "--folder", copy).stdout == "written: metrics.md\n"
    assert (copy / "metrics.md").read_text(encoding="utf-8") == page("metrics")


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_a_command_is_there_with_every_option_its_meaning_and_an_example(name):
    told, command = section(page("commands"), name), COMMANDS[name]
    assert f"`sumo-reactive {name} " in told
    for option in command.params:
        names = option.opts if option.param_type_name == "option" else []
        assert all(f"`{one}`" in told for one in names)
        assert option.help in told


def test_every_exit_code_that_a_command_may_end_with_is_there():
    codes = {one.exit_code for one in (ReactiveError, *ReactiveError.__subclasses__())}
    assert codes < set(ExitCode)
    assert [int(code) for code in firsts(page("exit_codes"))[2:]] == list(ExitCode)


def test_every_parameter_is_there_with_its_unit():
    told = page("parameters")
    for name in NAMES:
        unit = re.escape(unit_of_parameter(name))
        assert re.search(rf"^\| `{name}` \| [-\d.]+ \| {unit} \| [\d.]+ \| \S", told, re.MULTILINE), name


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("stuck_s", "s"), ("clearance_m", "m"), ("comfort_deceleration", "m/s²"), ("max_acceleration_in_plan", "m/s²"),
        ("max_lateral_jerk", "m/s³"), ("off_nominal_speed", "m/s"), ("slower_by", "m/s"), ("max_steering_rate", "rad/s"),
        ("look_ahead_growth", "s²/m"), ("rolling_share", ""), ("pressing_gain", ""),
    ],
)  # fmt: skip
def test_the_unit_of_a_parameter_is_told_by_the_end_of_its_name(name, unit):
    assert (name in NAMES, unit_of_parameter(name)) == (True, unit)


def test_a_unit_in_the_words_on_a_parameter_is_the_one_in_its_column():
    rows = re.findall(r"^\| `\w+` \| [^|]+ \| ([^|]*) \| [^|]+ \| (.*) \|$", page("parameters"), re.MULTILINE)
    stated = [(unit, found[1]) for unit, told in rows if (found := re.search(r", (1/m|rad/s|m/s³|m/s|s)(?=[.: (])", told))]
    assert len(stated) >= 8
    assert {pair for pair in stated if pair[0] != pair[1]} == {("s²/m", "s")}  # "s per m/s"


@pytest.mark.parametrize(
    ("heading", "model"),
    [
        ("`[scenario]`", ScenarioKeys), ("`[egos] of a scenario`", RuleKeys), ("`[expect]`", Expectation),
        ("`[expect.metrics] NAME = { … }`", Limit),
        ("`[experiment]`", ExperimentKeys), ("`[egos]`", EgoKeys), ("`[samples]`", SampleKeys),
        ("All tables", ExperimentFile),
    ],
)  # fmt: skip
def test_every_key_of_a_file_is_there_with_its_meaning(heading, model):
    told = section(page("file_keys"), heading)
    assert re.findall(r"^\| `(\w+)` \| [^|]+ \|[^|]*\| \S", told, re.MULTILINE) == list(model.model_fields)


def test_every_metric_is_there():
    assert set(firsts(page("metrics"))) >= set(EVERY)


def test_every_word_of_the_pilot_is_there():
    words = {one.value for kind in (Behaviour, Instruction, Reason, EventKind, Occupancy) for one in kind}
    assert words <= set(firsts(page("reasons")))


def test_every_file_and_column_is_there():
    text = page("files")
    assert set(firsts(section(text, "The record of a run"))) >= set(FILES)
    assert firsts(section(text, "`trajectory.parquet`"))[2:] == list(COLUMNS.values())
    assert firsts(section(text, "`encounters.parquet`"))[2:] == list(encounter_columns(PairLog(), 5.0, 2.0))
    nobody = FleetResult(results=(), refused=(), on_their_way=frozenset(), until=0.0, step_us=0.0, wall_s=0.0)
    assert firsts(section(text, "`fleet.json`"))[2:] == list(fleet_summary(nobody, str))
    assert firsts(section(text, "`comparison.json`"))[2:] == list(data_of(Comparison((), 600.0)))


def test_every_column_of_a_store_is_there_with_its_type(tmp_path):
    with Store(tmp_path / "s.duckdb"):
        pass
    query = "SELECT table_name, column_name, data_type FROM duckdb_columns() WHERE NOT internal"
    with Results(tmp_path / "s.duckdb") as store:
        columns = store.rows(query)
    assert len(columns) > 30
    for name, column, kind in columns:
        assert f"| `{column}` | {kind} | " in section(page("files"), f"`{name}`")


def test_a_record_and_a_store_are_read_in_the_line_that_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made_record(tmp_path / "DIR", [step(k) for k in range(5)])
    with Store(tmp_path / "STORE.duckdb"):
        pass
    lines = re.findall(r"`(duckdb\.[^`]+)`", page("files"))
    assert len(lines) == 3
    rows = [len(eval(line, {"duckdb": duckdb}).fetchall()) for line in lines]
    assert rows == [5, 1, 0]


def test_every_link_of_the_pages_leads_to_a_page():
    for file in FOLDER.glob("*.md"):
        for target in re.findall(r"\]\(([^)#]+)", file.read_text(encoding="utf-8")):
            assert (FOLDER / target).is_file(), (file.name, target)
