"""What programs need of the package, for type checkers; `__init__.py` loads it when it is first asked for."""

from sumo_reactive.driver.controller import Controller as Controller
from sumo_reactive.lab.comparison.comparison import compare as compare
from sumo_reactive.lab.drivers.protocol import Driver as Driver
from sumo_reactive.lab.fleet import run_fleet as run_fleet
from sumo_reactive.lab.scenario import load_scenario as load_scenario
from sumo_reactive.lab.simulation import run_trial as run_trial
from sumo_reactive.show.recording import read_run as read_run

__version__: str
