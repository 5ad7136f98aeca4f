"""What stands on a command line and in files of vehicles, case by case."""

import libsumo
import pytest
from scripted import Domain, script

from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.config import canonical, given_options, is_true, paths_beside, read_config, seconds_of
from sumo_reactive.sumo.outputs import Contact, read_contacts, read_teleports, read_trips, trip_of
from sumo_reactive.sumo.vehicle_type import HAS_DEVICE, PROBABILITY, Equipment


@pytest.mark.parametrize(
    ("words", "given"),
    [
        ([], {}),
        (["--seed", "3"], {"seed": "3"}),
        (["--seed=3"], {"seed": "3"}),
        (["--seed=", "3"], {"seed": ""}),
        (["--route-files=a=b", "x"], {"route-files": "a=b"}),
        (["-e", "3", "-b", "2"], {"end": "3", "begin": "2"}),
        (["-e=3"], {"end": "3"}),
        (["-vW", "x"], {"verbose": "x", "no-warnings": "x"}),
        (["--vW"], {"vW": ""}),
        (["-tripinfo", "x"], {"tripinfo-output": "x"}),
        (["--srand", "1", "--seed", "2"], {"seed": "2"}),
        (["x", "y", "--verbose"], {"verbose": ""}),
        (["--verbose", "--seed", "7"], {"verbose": "--seed", "seed": "7"}),
    ],
)
def test_each_option_of_a_command_line_is_known_by_its_full_name_with_its_value(words, given):
    assert given_options(words) == given


@pytest.mark.parametrize(("name", "full"), [("n", "net-file"), ("seed", "seed"), ("?", "help"), ("odd", "odd")])
def test_a_synonym_stands_for_its_option(name, full):
    assert canonical(name) == full


@pytest.mark.parametrize("text", ["true", "1", "YES", " on ", "x", "T"])
def test_yes_has_many_words(text):
    assert is_true(text)


@pytest.mark.parametrize("text", ["false", "0", "no", "off", "", "-", "f", "XX"])
def test_all_else_is_no(text):
    assert not is_true(text)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [(" 5 ", 5.0), ("-1", -1.0), ("1:2:3", 3723.0), ("2:1:2:3.5", 176523.5), ("0:0:61", 61.0), ("1e3", 1000.0)],
)
def test_a_time_is_in_seconds_or_in_days_hours_minutes_and_seconds(text, seconds):
    assert seconds_of(text) == seconds


@pytest.mark.parametrize("text", ["", "a", "1:2", "1:2:3:4:5", "nan", "inf", "1:inf:0", "1::2"])
def test_what_is_no_time_is_none(text):
    with pytest.raises(ValueError, match=r".*"):
        seconds_of(text)


@pytest.mark.parametrize(
    ("value", "names"),
    [("", ()), ("a", ("a",)), (" a , b,,", ("a", "b")), ("/a,${OF}/b", ("/a", "here/b")), ("sub/../a", ("sub/../a",))],
)
def test_paths_lie_beside_the_configuration(tmp_path, monkeypatch, value, names):
    monkeypatch.setenv("OF", "here")
    monkeypatch.chdir(tmp_path)
    for config in (tmp_path / "a.sumocfg", (tmp_path / "a.sumocfg").relative_to(tmp_path)):
        assert paths_beside(config, value) == tuple(tmp_path / name for name in names)


def config_of(folder, routes="<routes/>", more="", name="r.rou.xml"):
    """A configuration with a file of routes."""
    (folder / "n.net.xml").touch()
    (folder / name).write_text(routes, encoding="utf-8")
    inner = f'<net-file value="n.net.xml"/><route-files value="{name}"/>{more}'
    (folder / "a.sumocfg").write_text(f"<configuration>{inner}</configuration>", encoding="utf-8")
    return read_config(folder / "a.sumocfg")


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        ('<mesosim value="yes"/>', "option 'mesosim': a mesoscopic simulation has no lanes to drive on"),
        ('<step-length value="0"/>', "option 'step-length': impossible step length '0'"),
        ('<step-length value="-0.5"/>', "option 'step-length': impossible step length '-0.5'"),
        ('<end value=" later "/>', "option 'end': 'later' is not a time"),
    ],
)
def test_what_cannot_be_run_is_told_whole(tmp_path, more, complaint):
    with pytest.raises(ScenarioError) as told:
        config_of(tmp_path, more=more)
    assert str(told.value) == f"{tmp_path / 'a.sumocfg'}: {complaint}"


@pytest.mark.parametrize(("said", "end"), [("", None), ("0", 0.0), ("-0.5", None), ("0.5", 0.5), (" 1:0:0 ", 3600.0)])
def test_an_end_below_zero_is_none(tmp_path, said, end):
    config = config_of(tmp_path, more=f'<end value="{said}"/><begin value=""/><step-length value=" "/>')
    assert (config.end_s, config.begin_s, config.step_length_s) == (end, 0.0, 1.0)


def equipped(tmp_path, monkeypatch, routes, types=None):
    """Who is equipped, by files and what SUMO says of types; every vehicle is of type t."""
    known = {("t", HAS_DEVICE): "", ("t", PROBABILITY): ""} | (types or {})
    script(monkeypatch, vehicle=Domain(getTypeID="t"), vehicletype=Domain(getParameter=known))
    return Equipment(config_of(tmp_path, f"<routes>{routes}</routes>"))


NO_SHARE = "not a number within 0 and 1"


def param(value, key=HAS_DEVICE):
    return f'<param key="other" value="no"/><param key="{key}" value="{value}"/>'


@pytest.mark.parametrize(
    ("routes", "shares"),
    [
        (f'<flow id="f.a">{param("yes")}</flow>', {"f.a.7": 1.0, "f.a": 1.0, "f.7": None, "f.a.7.1": None}),
        (f'<trip id="a">{param("-")}</trip><vehicle id="b">{param("X")}</vehicle>', {"a": 0.0, "b": 1.0, "c": None}),
        (f'<trip id="a">{param("F")}</trip><trip id="b">{param("Off")}</trip>', {"a": 0.0, "b": 0.0}),
        (f'<vehicle id="a">{param(1, PROBABILITY)}</vehicle>', {"a": 1.0, "b": None}),
        (f'<vehicle id="a">{param(0, PROBABILITY)}</vehicle>', {"a": 0.0, "a.1": 0.0}),
        (f'<person id="a">{param("yes")}</person><vehicle id="b"/>', {"a": None, "b": None}),
        (f'<flow id="f">{param("no")}</flow><vehicle id="f.1">{param("on")}</vehicle>', {"f.1": 1.0, "f.2": 0.0}),
        (f'<vehicle id="a">{param(" ")}{param(" 0.5 ", PROBABILITY)}</vehicle>', {"a": 0.5}),
        (f'<vehicle id="a"><stop>{param("yes")}</stop></vehicle>', {"a": None}),
    ],
)
def test_each_vehicle_has_what_is_said_of_it_or_of_its_flow(tmp_path, monkeypatch, routes, shares):
    equipment = equipped(tmp_path, monkeypatch, routes)
    assert {name: equipment.share(name) for name in shares} == shares


def test_a_type_is_asked_once_and_only_where_any_file_speaks_of_equipment(tmp_path, monkeypatch):
    one = f'<vehicle id="a">{param("no")}</vehicle>'
    equipment = equipped(tmp_path, monkeypatch, one, {("t", PROBABILITY): "0.25"})
    assert [equipment.share(name) for name in "abb"] == [0.0, 0.25, 0.25]
    libsumo.vehicletype.answers.clear()
    assert equipment.share("c") == 0.25
    assert equipped(tmp_path, monkeypatch, '<vehicle id="a"/>', {("t", HAS_DEVICE): "yes"}).share("a") is None
    wrong = equipped(tmp_path, monkeypatch, one, {("t", PROBABILITY): "2"})
    with pytest.raises(ScenarioError, match=rf"^vType 't': {PROBABILITY} is '2', {NO_SHARE}$"):
        wrong.share("b")


@pytest.mark.parametrize(
    ("routes", "complaint"),
    [
        (f'<trip id="a">{param("maybe")}</trip>', f": trip 'a': {HAS_DEVICE} is 'maybe', neither true nor false"),
        (f'<flow id="a">{param("x", PROBABILITY)}</flow>', f": flow 'a': {PROBABILITY} is 'x', {NO_SHARE}"),
        (f'<flow id="a">{param("-0.1", PROBABILITY)}</flow>', f": flow 'a': {PROBABILITY} is '-0.1', {NO_SHARE}"),
        (f'<flow id="a">{param("1.1", PROBABILITY)}</flow>', f": flow 'a': {PROBABILITY} is '1.1', {NO_SHARE}"),
        (f'\n<flow id="{HAS_DEVICE}">\n', ":3: not XML: mismatched tag at column 2"),
    ],
)  # fmt: skip
def test_what_files_say_wrongly_is_told_whole(tmp_path, monkeypatch, routes, complaint):
    with pytest.raises(ScenarioError) as told:
        equipped(tmp_path, monkeypatch, routes)
    assert str(told.value) == f"{tmp_path / 'r.rou.xml'}{complaint}"


def test_what_an_element_leaves_out_is_nothing(tmp_path):
    (tmp_path / "t.xml").write_text(
        '<t><tripinfo depart="0" waitingCount="3"/><tripinfo id="b" depart="0.5" arrival="0"/></t>'
    )
    first, second = read_trips(tmp_path / "t.xml")
    assert first == ("", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3, 0.0, False, 0.0, 0.0, 0.0)
    assert (second.departure, second.arrival) == (0.5, 0.0)
    assert trip_of(tmp_path / "t.xml", "b") == second and trip_of(tmp_path / "t.xml", "c") is None
    (tmp_path / "c.xml").write_text('<c><collision/><collision time="0.5" victim="v"/></c>')
    first_contact, second_contact = read_contacts(tmp_path / "c.xml")
    assert first_contact.time != first_contact.time and first_contact[1:] == ("", "")
    assert second_contact == Contact(0.5, "", "v")
    (tmp_path / "s.xml").write_text('<s><teleports/><teleports total="2"/><teleports total="3"/></s>')
    assert read_teleports(tmp_path / "s.xml") == 5
