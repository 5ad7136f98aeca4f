"""The page of measures: its tables are what the code says, SUMO's own device agrees, and its examples run."""

import re
import shutil
import subprocess
import sys
import tomllib

from helpers.programs import ROOT, run_tool, sumo_reactive

from sumo_reactive.lab.metric_names import METRICS

PAGE = ROOT / "docs" / "measures.md"
TEXT = PAGE.read_text(encoding="utf-8")
ROW = re.compile(r"\| (\w+) \| (M?DRAC|TTC) \| (\d+) \| (\d+) % \| (\d+) % \| \d+ \|")


def blocks(language):
    """Return the code blocks of a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)


def test_the_tables_are_what_the_code_and_sumo_say():
    answer = run_tool("measures_page", "--check")
    assert (answer.returncode, answer.stdout.strip()) == (0, "up to date"), answer.stdout + answer.stderr


def test_a_table_that_is_out_of_date_is_found_and_written_anew(tmp_path):
    copy = tmp_path / "measures.md"
    copy.write_text(TEXT.replace("| `max_drac_m_s2` | m/s² |", "| `max_drac_m_s2` | g |"), encoding="utf-8")
    answer = run_tool("measures_page", "--check", "--page", copy)
    assert (answer.returncode, answer.stdout) == (1, "out of date: measures\n")
    answer = run_tool("measures_page", "--page", copy)
    assert (answer.returncode, answer.stdout) == (0, "written: measures\n")
    assert copy.read_text(encoding="utf-8") == TEXT


def test_sumos_device_and_ours_agree_where_they_define_the_same():
    """On straight lanes to the digits that SUMO writes; in bends, which it measures along the lane, within a few percent."""
    rows = [(name, measure, *map(int, numbers)) for name, measure, *numbers in ROW.findall(TEXT)]
    assert {measure for _, measure, *_ in rows} == {"TTC", "DRAC", "MDRAC"} and len(rows) == 15
    assert sum(values for _, _, values, *_ in rows) > 1000
    assert all(within == 100 for name, _, _, _, within in rows if name != "roundabout")
    assert all(within >= 85 for name, _, _, _, within in rows if name == "roundabout")
    assert all(equal == 100 for name, _, _, equal, _ in rows if name in ("right_before_left", "city_grid"))


def test_every_measure_that_is_not_shown_unasked_is_on_the_page():
    elsewhere = {"arrived", "violations", "min_time_to_collision_at_s"}
    hidden = {key for key, metric in METRICS.items() if not metric.is_shown and not key.startswith("events_")}
    assert {key for key in hidden - elsewhere if f"`{key}`" not in TEXT} == set()


def test_the_example_of_an_own_metric_is_checked_as_printed(tmp_path):
    module, scenario = blocks("python")[1], blocks("toml")[0]
    folder = tmp_path / "scenarios"
    folder.mkdir()
    shutil.copytree(ROOT / "networks" / "four_way_priority", tmp_path / "networks" / "four_way_priority")
    (folder / "my_metrics.py").write_text(module, encoding="utf-8")
    (folder / "mine.toml").write_text(scenario, encoding="utf-8")
    answer = sumo_reactive("check", folder / "mine.toml")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    (folder / "mine.toml").write_text(scenario.replace("200.0", "0.001"), encoding="utf-8")
    assert "jerk_at_stops_m_s3 is " in sumo_reactive("check", folder / "mine.toml").stdout


def test_the_example_of_the_series_reads_a_recorded_run(tmp_path):
    answer = sumo_reactive("run", ROOT / "scenarios" / "four_way_priority.toml", "--out", "runs/crossing", cwd=tmp_path)
    assert answer.returncode == 0, answer.stderr
    command = [sys.executable, "-c", blocks("python")[0]]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=True).stdout
    assert "max(drac_m_s2)" in said


def test_the_example_of_an_entry_point_is_a_table_of_a_project():
    (name,) = tomllib.loads(blocks("toml")[1])["project"]["entry-points"]
    assert name == "sumo_reactive.metrics"
