"""The digests of runs: what they take notice of, where they say that two runs part, and a small list for real."""

from __future__ import annotations

import json
from typing import Any

import pytest
from helpers.programs import ROOT, run_tool
from helpers.recordings import step
from helpers.tools import tool

from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Reason
from sumo_reactive.driver.nouns.record import StepRecord

CONFIG = "four_way_priority/four_way_priority.sumocfg"


digests = tool("digests")


YIELDS = Decision(
    behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="a|b", cause="foe", figures=(("arrival_s", 2.0),)
)


def at(k: int, **changes: Any) -> StepRecord:
    """The k-th step of a drive that begins at 100 s and yields to `foe` from 120 s on."""
    decisions = (YIELDS,) if k >= 200 else ()
    return step(k, **({"time": round(100.0 + 0.1 * k, 6), "y": 0.0, "decisions": decisions} | changes))


def drive(changed: int = -1, count: int = 400, **changes: Any) -> Any:
    """The digests of a run, some fields of one step changed."""
    return digests.digests_of(True, [at(k, **(changes if k == changed else {})) for k in range(count)])


def test_equal_runs_have_equal_digests_whatever_the_clock_and_the_last_bits_say():
    assert digests.parting(drive(), drive()) == ""
    assert digests.parting(drive(), drive(7, control_us=99.0, x=7.0 + 1e-9, y=-1e-12)) == ""
    assert digests.parting(drive(7, heading=3.141592653589793), drive(7, heading=-3.141592653589793)) == ""


@pytest.mark.parametrize("field", digests.FIELDS)
def test_a_millionth_in_any_column_parts_two_runs_in_its_ten_seconds(field):
    values = [getattr(at(257), field) + k * 2e-6 for k in (1, 2, 3, 4, 5)]
    told = [digests.parting(drive(), drive(257, **{field: value})) for value in values]
    column = digests.COLUMNS[field]
    assert all(one.startswith("differs: ") and "in the 10 s from 120.00 s for sure" in one for one in told)
    assert any(f"at 125.70 s in {column} (" in one for one in told), told


def test_a_run_that_ends_earlier_parts_where_it_ends():
    assert "from 139.00 s on, where one ends" in digests.parting(drive(), drive(count=390))
    assert "arrived at 139.90 s, 2 decisions; now arrived at 138.90 s, 2 decisions" in digests.parting(
        drive(), drive(count=390)
    )


def test_another_departure_or_step_is_told():
    later = digests.digests_of(True, [at(k) for k in range(1, 401)])
    assert "first step at 100.0 s, a step 0.1 s; now first step at 100.1 s" in digests.parting(drive(), later)


@pytest.mark.parametrize(
    "other",
    [
        Decision(behaviour=Behaviour.STOPPING, reason=Reason.YIELD_TO, region="a|b", cause="foe"),
        Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.EXIT_BLOCKED, region="a|b", cause="foe"),
        Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="a|c", cause="foe"),
        Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="a|b", cause="friend"),
    ],
)
def test_another_word_in_a_decision_parts_two_runs_and_its_figures_do_not(other):
    def decided(decision: Decision) -> Any:
        return digests.digests_of(True, [at(k, decisions=(decision,) if k >= 200 else ()) for k in range(400)])

    assert digests.parting(drive(), decided(other)) == "differs: decision 2 of 2"
    assert digests.parting(
        drive(), decided(Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="a|b", cause="foe"))
    ) == ""


def test_a_run_that_fails_as_before_is_no_difference_and_one_that_fails_now_is():
    failed = digests._nothing("unknown ego")
    assert digests.parting(failed, dict(failed)) == ""
    assert digests.parting(drive(), failed) == "differs: arrived at 139.90 s, 2 decisions; now failed: unknown ego"
    assert digests.parting_from_all((), failed) == "differs: not in the file"


def test_a_list_of_trips_is_written_and_compared(tmp_path):
    trips, file = tmp_path / "trips.csv", tmp_path / "digests.json"
    rows = ("scenario,config,ego,step_length_s", f"cross,{CONFIG},ego,0.1", f"ghost,{CONFIG},nobody,")
    trips.write_text("\n".join(rows), encoding="utf-8")
    arguments = ("--trips", ROOT / "networks", trips, "--file", file)
    written = run_tool("digests", *arguments, "--seed", "42", "7", "--write")
    assert written.returncode == 1, written.stderr
    assert written.stdout.splitlines()[-1] == "4 runs, 2 failed"
    stored = json.loads(file.read_text(encoding="utf-8"))
    assert list(stored) == [f"{name} default {seed}" for name in ("cross ego", "ghost nobody") for seed in (42, 7)]
    assert stored["cross ego default 42"][0]["told"].startswith("arrived at 45.")
    compared = run_tool("digests", *arguments)
    assert (compared.returncode, compared.stdout.splitlines()[-1]) == (0, "2 runs, 0 differ"), compared.stdout
    stored["cross ego default 42"] = stored["cross ego default 7"]
    file.write_text(json.dumps(stored), encoding="utf-8")
    differs = run_tool("digests", *arguments, "--only", "cross")
    assert differs.returncode == 1
    assert differs.stdout.startswith("cross ego default 42: differs: at ")
    assert run_tool("digests", *arguments, "--only", "cross", "--also").returncode == 0
    both = json.loads(file.read_text(encoding="utf-8"))
    assert [len(both[f"cross ego default {seed}"]) for seed in (42, 7)] == [2, 1]
    assert run_tool("digests", *arguments, "--only", "cross").stdout.endswith("1 runs, 0 differ\n")


def test_a_scenario_of_this_repository_drives_and_decides_as_checked_in():
    answer = run_tool("digests", "--only", "city_grid default 42")
    assert answer.stdout.splitlines()[-1] == "1 runs, 0 differ", answer.stdout
    assert answer.returncode == 0, answer.stderr


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--only", "moon"], "no run whose name holds 'moon'"),
        (["--file", "none.json"], "none.json: cannot be read: No such file"),
        (["--trips", ".", "none.csv", "--file", "none.json"], "none.csv: cannot be read: No such file"),
        (["--trips", ".", "t.csv"], "--trips needs --file"),
    ],
)
def test_wrong_input_ends_with_exit_code_2_and_one_line(monkeypatch, capsys, arguments, complaint):
    monkeypatch.setattr("sys.argv", ["digests.py", *arguments])
    with pytest.raises(SystemExit) as end:
        digests.main()
    told = capsys.readouterr()
    assert (end.value.code, told.out) == (2, "")
    assert complaint in told.err.splitlines()[-1]
