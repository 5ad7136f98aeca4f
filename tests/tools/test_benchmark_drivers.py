"""The benchmark of the drivers' protocol: a row a driver, in which whole, plain and own fit together."""

import pytest
from helpers.programs import numbers_in, run_tool

ROWS = (
    "in process, reads nothing", "in process, reads everything", "out of process, answers at once",
    "pass_on.py, with its work",
)  # fmt: skip


@pytest.fixture(scope="module")
def lines():
    answer = run_tool("benchmark_drivers", "--steps", 40)
    assert (answer.returncode, answer.stderr) == (0, "")
    return answer.stdout.splitlines()


@pytest.mark.parametrize("name", ROWS)
def test_each_driver_has_a_row_in_which_the_own_cost_is_the_whole_less_the_plain_loops(lines, name):
    (found,) = (numbers_in(line.strip().removeprefix(name)) for line in lines if line.strip().startswith(name))
    steps, users, *clocks, _ = found
    assert steps == 40 and users > 0
    for whole, plain, own in (clocks[:3], clocks[3:]):
        assert whole > 0.0 and plain > 0.0
        assert own == pytest.approx(whole - plain, abs=0.11)
