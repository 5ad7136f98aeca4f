"""The error family: what a user did, what SUMO did, and what a value may not be; and how a command ends."""

from enum import IntEnum


class ExitCode(IntEnum):
    """What a command tells the shell at its end; the worst of what it ran counts."""

    DONE = 0
    """Nothing is wanting: the ego has arrived without a collision or violation (`run`, `demo`), every expectation is met
    (`check`), every trial has a result (`batch`), both drivers got to an end in every pair (`compare`), every run is
    the same again (`reproduce`)."""
    WANTING = 1
    """A collision, a red light run, a right of way taken, no arrival, a driver or a metric of the user's that failed (`run`,
    `demo`), an expectation that is not met (`check`), a trial without a result (`batch`), a run that did not get to its end
    (`compare`), or is another than it was (`reproduce`)."""
    UNUSABLE = 2
    """Wrong usage or input, or an output that cannot be written: one line names file and place, nothing is left behind."""
    SUMO_FAILED = 3
    """SUMO failed while the simulation ran, or died of a signal, or memory ran out."""
    INTERNAL_FAULT = 70
    """A fault of this program: please report it with the lines above."""
    INTERRUPTED = 130
    """Interrupted, asked to terminate, or SUMO's window closed while the simulation ran: nothing is left behind."""


class ReactiveError(Exception):
    """Base of every error this package raises on purpose; its text is one line naming file and place."""

    exit_code = ExitCode.UNUSABLE


class InputError(ReactiveError):
    """A file, an option or an ego that cannot be used (exit code 2)."""


class NetworkError(InputError):
    """A network file that cannot be read or lacks what driving needs, such as internal lanes."""


class ScenarioError(InputError):
    """A scenario that cannot be run as asked: unknown ego, unknown key, impossible step length."""


class ParameterError(InputError):
    """A value for a parameter of the driver that cannot be: unknown name, not a number, or too small."""


class StoreError(InputError):
    """A store of an experiment that cannot be used or written: of another version, in use by another process, no room."""


class OutputError(ReactiveError):
    """A file or a folder that cannot be written: no room, no permission, an impossible name (exit code 2)."""


class ClusterError(InputError):
    """A scheduler that cannot be reached, or whose workers cannot run this package."""


class DriverError(ReactiveError):
    """A driver of the user's that raised, or answered what no car can do: its trip has failed (exit code 1)."""

    exit_code = ExitCode.WANTING


class PlanError(InputError):
    """A route that no lane sequence connects."""


class WindowClosedError(ReactiveError):
    """Somebody has closed SUMO's window while the simulation ran: the run ends as if interrupted (exit code 130)."""

    exit_code = ExitCode.INTERRUPTED


class SimulationError(ReactiveError):
    """SUMO failed while the simulation ran (exit code 3)."""

    exit_code = ExitCode.SUMO_FAILED
