"""What programs import from the package itself, and what that costs."""

import subprocess
import sys

import sumo_reactive
from sumo_reactive import Controller, Driver, compare, load_scenario, read_run, run_fleet, run_trial


def test_the_package_offers_what_programs_need():
    offered = (Controller, Driver, compare, load_scenario, read_run, run_fleet, run_trial)
    assert {one.__name__ for one in offered} == set(dir(sumo_reactive)) - {"__version__"}


def test_what_it_does_not_have_is_told():
    try:
        sumo_reactive.drive  # noqa: B018
    except AttributeError as error:
        assert str(error) == "module 'sumo_reactive' has no attribute 'drive'"


def test_importing_it_loads_nothing_that_takes_long():
    heavy = ("numpy", "libsumo", "numba", "pydantic")
    code = f"import sys, sumo_reactive; print([name for name in {heavy} if name in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert answer.stdout.strip() == "[]"
