"""What a session makes of SUMO's ways to fail and to end; SUMO is scripted, so that none of it harms this process."""

import os
from pathlib import Path

import libsumo
import pytest
from scripted import Domain, script

from sumo_reactive.errors import ScenarioError, SimulationError
from sumo_reactive.sumo.session import Session


def starting(monkeypatch, says: bytes = b"", fails: Exception | None = None, is_loaded: bool = True, time: object = 3.0):
    """Script how SUMO starts: what it writes to standard error, how it fails; return what it is started with."""
    started = []

    def start(arguments):
        started.append(arguments)
        os.write(2, says)
        if fails is not None:
            raise fails

    monkeypatch.setattr(libsumo, "start", start)
    monkeypatch.setattr(libsumo, "isLoaded", lambda: is_loaded)
    monkeypatch.setattr(libsumo, "close", lambda: started.append("closed"))
    script(monkeypatch, simulation=Domain(getTime=time))
    return started


@pytest.mark.parametrize(
    ("says", "fails", "is_loaded", "reason"),
    [
        (b"Warning: odd\n  Error: the reason \nError: another\n", libsumo.TraCIException("x"), True, "the reason"),
        (
            b"Quitting (on error).\n",
            libsumo.TraCIException(" In  file\n a.xml\tat line 3\n"),
            True,
            "In file a.xml at line 3",
        ),
        (b"", libsumo.FatalTraCIError("fatal"), True, "fatal"),
        (b"", RuntimeError(""), True, "RuntimeError"),
        (b"Error: first \n", None, False, "first"),
        (b"No Error: here\n", None, False, "it ends before it loads"),
    ],
)
def test_a_start_that_fails_is_told_with_sumos_first_error(monkeypatch, capsys, says, fails, is_loaded, reason):
    starting(monkeypatch, says, fails, is_loaded)
    with pytest.raises(ScenarioError) as told, Session(["-c", "a"]):
        pass
    assert str(told.value) == f"SUMO rejects the scenario: {reason}"
    assert capsys.readouterr().err == ""


def test_what_sumo_says_as_it_starts_goes_to_standard_error_when_it_has_started(monkeypatch, capfd):
    started = starting(monkeypatch, b"Warning: stra\xdfe\n")
    with Session(["-c", "a"]):
        os.write(2, b"after")
        assert started == [["sumo", "-c", "a"]]
    assert started[1:] == ["closed"]
    assert sorted(capfd.readouterr().err.partition("after")) == ["", "Warning: stra\N{REPLACEMENT CHARACTER}e\n", "after"]


def test_standard_error_is_left_as_it_was_and_no_descriptor_is_left(monkeypatch):
    starting(monkeypatch)
    before, free = os.fstat(2), os.dup(2)
    os.close(free)
    with Session([]):
        pass
    after = os.dup(2)
    os.close(after)
    assert os.path.samestat(os.fstat(2), before) and after == free


FROM_SUMO = compile(
    "raise RuntimeError('\\n  the network is gone \\n more')", str(Path(libsumo.__file__).parent / "x.py"), "exec"
)
FROM_ELSEWHERE = compile("raise RuntimeError('mine')", __file__, "exec")


class OwnError(RuntimeError):
    """An error of this program's."""


@pytest.mark.parametrize(
    ("time", "at"), [(3.0, " at 3.0 s"), (12.345, " at 12.3 s"), (libsumo.TraCIException("not loaded"), "")]
)
def test_an_error_of_sumos_is_told_in_its_first_line_with_the_time_if_that_is_known(monkeypatch, time, at):
    starting(monkeypatch, time=time)
    with pytest.raises(SimulationError) as told, Session([]):
        exec(FROM_SUMO, {})
    assert str(told.value) == f"SUMO failed{at}: the network is gone"
    assert type(told.value.__cause__) is RuntimeError


@pytest.mark.parametrize(
    ("error", "line"),
    [(libsumo.TraCIException(""), "TraCIException"), (libsumo.FatalTraCIError("\n b \n"), "b")],
)
def test_sumos_own_kinds_of_error_are_told_wherever_they_are_raised(monkeypatch, error, line):
    starting(monkeypatch)
    with pytest.raises(SimulationError, match=rf"^SUMO failed at 3\.0 s: {line}$"), Session([]):
        raise error


@pytest.mark.parametrize("error", [OwnError("x"), ValueError("x"), KeyboardInterrupt()])
def test_no_other_error_is_laid_to_sumo(monkeypatch, error):
    starting(monkeypatch)
    with pytest.raises(type(error)) as raised, Session([]):
        raise error
    assert raised.value is error
    with pytest.raises(RuntimeError, match="mine"), Session([]):
        exec(FROM_ELSEWHERE, {})


def test_a_close_that_fails_hides_nothing(monkeypatch):
    starting(monkeypatch)

    def fail():
        raise libsumo.FatalTraCIError("closed")

    monkeypatch.setattr(libsumo, "close", fail)
    with pytest.raises(KeyError), Session([]):
        raise KeyError("x")


@pytest.mark.parametrize(
    ("end", "time", "left", "is_over", "is_past"),
    [
        (-1.0, 9.0, 1, False, False),
        (-1.0, 9.0, 0, True, False),
        (10.0, 9.0, 1, False, False),
        (10.0, 10.0, 1, True, False),
        (10.0, 10.5, 1, True, True),
        (0.0, 0.0, 1, True, False),
        (0.0, 0.5, 2, True, True),
        (0.5, 0.7, 2, True, True),
    ],
)
def test_a_scenario_is_over_at_its_end_and_past_it_behind(monkeypatch, end, time, left, is_over, is_past):
    script(monkeypatch, simulation=Domain(getEndTime=end, getTime=time, getMinExpectedNumber=left))
    assert (Session([]).is_over(), Session([]).is_past_end()) == (is_over, is_past)


def run_of(monkeypatch, *departed: tuple[str, ...], loaded=(), pending=(), people=()):
    """A session of one step a second, in each of which these depart; what is loaded is so in the first step alone."""
    now = [0]
    monkeypatch.setattr(libsumo, "simulationStep", lambda: now.__setitem__(0, now[0] + 1))
    script(
        monkeypatch,
        simulation=Domain(
            getTime=lambda: float(now[0]), getEndTime=-1.0, getMinExpectedNumber=1,
            getDepartedIDList=lambda: (*departed, *[()] * 9)[now[0] - 1],
            getLoadedIDList=lambda: loaded if now[0] == 1 else (),
            getPendingVehicles=lambda: pending, getDepartedPersonIDList=lambda: people,
        ),
    )  # fmt: skip
    return Session([])


def test_the_first_of_several_who_is_wanted_is_found_and_the_run_stands_there(monkeypatch):
    session, told = run_of(monkeypatch, ("a",), (), ("b", "c", "d")), []
    assert session.wait_for(lambda name: name in "cd", 9.0, lambda *what: told.append(what)) == "c"
    assert (session.time, told) == (3.0, [(1.0, "waiting for the ego to depart"), (2.0, "waiting for the ego to depart")])


@pytest.mark.parametrize(("until", "found", "time"), [(2.0, "", 2.0), (3.0, "c", 3.0), (2.5, "c", 3.0)])
def test_nobody_is_waited_for_longer_than_asked(monkeypatch, until, found, time):
    session = run_of(monkeypatch, (), (), ("c",))
    assert (session.wait_for(lambda name: True, until, None), session.time) == (found, time)


@pytest.mark.parametrize(("until", "time"), [(3.0, 3.0), (2.5, 3.0), (0.0, 0.0)])
def test_a_run_is_played_out_until_the_time_asked_for(monkeypatch, until, time):
    session, told = run_of(monkeypatch), []
    session.play_out(until, lambda *what: told.append(what))
    assert session.time == time and told == [(float(k), "playing out") for k in range(1, int(time) + 1)]


NEVER, UNKNOWN = (
    "ego 'x' never departs before 2.0 s, where the run ends",
    "unknown ego 'x': no such vehicle until 2.0 s, where the run ends",
)


@pytest.mark.parametrize(
    ("said", "why"),
    [({"loaded": ("y", "x")}, NEVER), ({"pending": ("x",)}, NEVER), ({"loaded": ("y",), "pending": ("z",)}, UNKNOWN)],
)
def test_who_was_loaded_or_waits_to_depart_is_known(monkeypatch, said, why):
    session = run_of(monkeypatch, **said)
    assert session.wait_for(lambda name: False, 2.0, None, "x") == ""
    assert session.why_not("x") == why


def test_another_pedestrian_is_no_reason_to_end(monkeypatch):
    session = run_of(monkeypatch, (), ("x",), people=("y",))
    assert session.wait_for(lambda name: True, 5.0, None, "x") == "x"


def test_stand_ins_have_not_departed_as_far_as_anybody_is_told(monkeypatch):
    session = run_of(monkeypatch, ("reactive.ghost.a.1", "b", "c"))
    session.step()
    assert session.departed == ("b", "c")
