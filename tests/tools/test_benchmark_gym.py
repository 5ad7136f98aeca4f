"""The benchmark of the environment: a row each, with the vehicles that it is about, and the page holds the whole table."""

import re

from helpers.programs import ROOT, run_tool

PAGE = ROOT / "docs" / "gym.md"
ROW = re.compile(r"^\| ([^|]+) \| (\d+) \| ([\d.]+) \| (\d+) \| (\d+) \|$", re.MULTILINE)


def rows_of(text):
    """Return the rows of a table: name, vehicles, length of a step, steps/s, simulated s/s."""
    return [(name, int(many), float(step), int(rate), int(speed)) for name, many, step, rate, speed in ROW.findall(text)]


def test_the_page_has_our_environment_beside_highway_envs_with_about_fifty_vehicles_each():
    rows = rows_of(PAGE.read_text(encoding="utf-8"))
    assert [name.partition(",")[0] for name, *_ in rows] == ["SumoReactive-v0"] * 2 + ["SUMO alone"] + ["highway-env"] * 2
    assert all(40 <= vehicles <= 60 for name, vehicles, *_ in rows if name != "SUMO alone")


def test_the_table_is_printed_and_written_with_commit_and_machine(tmp_path):
    copy = tmp_path / "gym.md"
    copy.write_text(PAGE.read_text(encoding="utf-8"), encoding="utf-8")
    answer = run_tool("benchmark_gym", "--steps", 20, "--write", "a machine of the tests", "--page", copy)
    assert answer.returncode == 0, answer.stderr
    text, printed = copy.read_text(encoding="utf-8"), rows_of(answer.stdout)
    assert rows_of(text) == printed
    assert re.search(r"Commit \w+, [\d-]+, a machine of the tests; `python tools/benchmark_gym.py`:", text)
    shown = [row[:1] + row[2:3] for row in rows_of(PAGE.read_text(encoding="utf-8"))]
    found = [row[:1] + row[2:3] for row in printed]
    assert found == shown or (found == shown[:3] and "highway-env is not installed" in answer.stdout)
