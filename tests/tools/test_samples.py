"""The samples of the pages are what the code says: each is made again, and the tool finds and mends what is out of date."""

import importlib.util
import re
import shutil
import sys

import pytest
from helpers.programs import ROOT, TOOLS, run_tool

from sumo_reactive.lab.metric_names import METRICS, OTHERS

PAGES = {page: page.read_text(encoding="utf-8") for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))}
ELSEWHERE = ("steps", "equality", "measures", "observation")
"""Samples that other tools write, or none."""
CHECK_S = 500.0


@pytest.fixture(scope="module")
def tool():
    sys.path.insert(0, str(TOOLS))
    try:
        spec = importlib.util.spec_from_file_location("samples", TOOLS / "samples.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(TOOLS))
    return module


def test_every_sample_of_the_pages_is_what_the_code_says():
    answer = run_tool("samples", "--check", timeout=CHECK_S)
    assert (answer.returncode, answer.stdout.strip()) == (0, "up to date"), answer.stdout + answer.stderr


@pytest.mark.parametrize(
    ("one", "other", "alike"),
    [
        ("a  1.95 [1.778, 2.219]", "a 1.951 [1.779, 2.219]", True), ("-3.35", "-3.36", True), ("────", "───", True),
        ("-8.45", "-8.47", True),
        ("1.95", "1.98", False), ("1.951", "1.954", False), ("12 runs", "13 runs", False), ("3 of 3", "3 of 3 of", False),
        ("veh_1.5", "car_1.5", False), ("-3.35", "+3.35", False),
    ],
)  # fmt: skip
def test_two_samples_are_alike_but_for_widths_and_two_in_the_last_digit(tool, one, other, alike):
    assert tool.is_alike(one, other) is alike


def test_every_place_for_a_sample_has_its_maker_and_every_block_of_text_its_place(tool):
    text = "".join(PAGES.values())
    found = [name for name in re.findall(r"<!-- sample: (\w+) -->", text) if name not in ELSEWHERE]
    assert sorted(found) == sorted([*tool.SAMPLES, "timings"])
    by_hand = re.sub(r"<!-- sample: .*?<!-- /sample -->", "", text, flags=re.DOTALL)
    assert [block for block in re.findall(r"```text\n(.*?)```", by_hand, re.DOTALL) if re.search(r"\d\.\d", block)] == []


def test_the_tables_name_every_metric(tool):
    told = tool.sample_in("".join(PAGES.values()), "metrics")
    for metric in (*(one for key, one in METRICS.items() if not key.startswith("events_")), *OTHERS.values()):
        assert f"| `{metric.key}` | {metric.label} | {metric.unit} | {metric.meaning} |" in told


def test_timings_stand_apart_with_commit_date_and_machine(tool):
    told = tool.sample_in("".join(PAGES.values()), "timings")
    assert re.match(r"Commit [0-9a-f]{7,}, \d{4}-\d\d-\d\d, .+\.\n", told)
    others = [tool.sample_in("".join(PAGES.values()), name) for name in tool.SAMPLES]
    assert [text for text in others if re.search(r"\d µs|real-time", text)] == []


def test_a_sample_that_is_out_of_date_is_found_and_written_anew(tmp_path):
    shutil.copy(ROOT / "README.md", tmp_path / "README.md")
    shutil.copytree(ROOT / "docs", tmp_path / "docs")
    copy = tmp_path / "docs" / "metrics.md"
    kept = copy.read_text(encoding="utf-8")
    copy.write_text(kept.replace("| `duration_s` | duration |", "| `duration_s` | how long |"), encoding="utf-8")
    answer = run_tool("samples", "metrics", "--check", "--pages", tmp_path)
    assert answer.returncode == 1
    assert "\n-| `duration_s` | how long |" in answer.stdout and "\n+| `duration_s` | duration |" in answer.stdout
    assert answer.stdout.endswith("out of date: metrics\n")
    answer = run_tool("samples", "metrics", "--pages", tmp_path)
    assert (answer.returncode, answer.stdout) == (0, "written: metrics\n")
    assert copy.read_text(encoding="utf-8") == kept


def test_a_sample_without_a_place_or_a_maker_is_named(tmp_path):
    (tmp_path / "README.md").write_text("nothing", encoding="utf-8")
    answer = run_tool("samples", "metrics", "--pages", tmp_path)
    assert (answer.returncode, answer.stderr) == (2, "samples: no place for the sample metrics\n")
    answer = run_tool("samples", "atlantis")
    assert answer.returncode == 2
    assert "no sample named atlantis" in answer.stderr
