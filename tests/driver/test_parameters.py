"""The driver's parameters: one frozen value, each documented where it stands, read by the driver, and found by name."""

import ast
from dataclasses import FrozenInstanceError, fields, replace
from itertools import pairwise
from pathlib import Path

import pytest

import sumo_reactive
from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.parameters import LEAST, NAMES, USUAL, Parameters
from sumo_reactive.errors import ParameterError

PACKAGE = Path(sumo_reactive.__file__).parent
PLACE = PACKAGE / "driver" / "parameters.py"


def statements() -> list[ast.stmt]:
    """Return what stands in the class, in order."""
    module = ast.parse(PLACE.read_text(encoding="utf-8"))
    return next(one for one in module.body if isinstance(one, ast.ClassDef)).body


def is_parameters(node: ast.expr) -> bool:
    """Whether an expression is the value, by the names that it goes by."""
    return (isinstance(node, ast.Attribute) and node.attr == "parameters") or ast.unparse(node) in ("p", "parameters")


def read() -> set[str]:
    """Return the names of what the package reads of the value."""
    sources = (file for file in PACKAGE.rglob("*.py") if file != PLACE)
    nodes = (node for file in sources for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))))
    return {node.attr for node in nodes if isinstance(node, ast.Attribute) and is_parameters(node.value)}


def test_every_parameter_is_documented_where_it_stands():
    body = statements()
    undocumented = [
        one.target.id
        for one, after in pairwise(body)
        if isinstance(one, ast.AnnAssign)
        and not (isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant) and after.value.value)
    ]
    assert undocumented == []


def test_every_parameter_is_read():
    assert set(NAMES) - read() == {"without"}
    assert "self.without" in PLACE.read_text(encoding="utf-8")


def test_nobody_overwrites_it():
    with pytest.raises(FrozenInstanceError):
        USUAL.stuck_s = 1.0


def test_names_count_in_small_letters_and_in_capitals():
    asked = Parameters.of({"STUCK_S": 5, "gap_before_s": 2.0, "without": 3.0})
    assert asked == replace(USUAL, stuck_s=5.0, gap_before_s=2.0, without=Mechanism(3))
    assert repr(asked.varied) == "{'gap_before_s': 2.0, 'stuck_s': 5.0, 'without': 3}"
    assert Parameters.of(asked.varied) == asked
    assert Parameters.of({"stuck_s": 600}).varied == USUAL.varied == {}


def test_more_values_leave_the_others_as_they_are():
    asked = Parameters(stuck_s=5.0, gap_before_s=2.0).with_values({"STUCK_S": USUAL.stuck_s, "progress_m": 1.0})
    assert asked == Parameters(gap_before_s=2.0, progress_m=1.0)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"STUCK": 1}, "unknown parameter 'STUCK'; near it: stuck_s"),
        ({"varied": 1}, "unknown parameter 'varied'"),
        ({"stuck_s": "1"}, "parameter 'stuck_s': '1' is not a finite number"),
        ({"STUCK_S": float("nan")}, "parameter 'stuck_s': nan is not a finite number"),
        ({"stuck_s": True}, "parameter 'stuck_s': True is not a finite number"),
        ({"stuck_s": -1}, "parameter 'stuck_s': -1.0 is less than 0"),
        ({"comfort_jerk": 0}, "parameter 'comfort_jerk': 0.0 is less than 0.1"),
        ({"stuck_s": 1, "STUCK_S": 2}, "parameter 'stuck_s' is named twice"),
        ({"without": 1.5}, "parameter 'without': 1.5 is not a mechanism's number"),
        ({"without": 99}, "parameter 'without': 99 is not a mechanism's number"),
    ],
)
def test_what_cannot_be_is_told(values, said):
    with pytest.raises(ParameterError) as raised:
        Parameters.of(values)
    assert said in str(raised.value)


@pytest.mark.parametrize("value", [-1.0, float("inf"), float("nan")])
def test_it_is_checked_whoever_makes_it(value):
    with pytest.raises(ParameterError, match=r"parameter 'gap_before_s': .* is less than 0, or not finite"):
        Parameters(gap_before_s=value)


def test_the_least_values_are_those_of_parameters():
    kinds = {field.name: field.type for field in fields(Parameters)}
    assert all(kinds[name] == "float" and 0.0 < least < getattr(USUAL, name) for name, least in LEAST.items())


def test_only_the_mechanism_that_is_left_out_is_missing():
    without = Parameters(without=Mechanism.TIMES)
    assert [one for one in Mechanism if not without.has(one)] == [Mechanism.TIMES]
    assert all(USUAL.has(one) for one in Mechanism if one)
