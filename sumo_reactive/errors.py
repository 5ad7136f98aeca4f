"""The error family: what a user did, what SUMO did, and what a value may not be."""


class ReactiveError(Exception):
    """Base of every error this package raises on purpose; its text is one line naming file and place."""

    exit_code = 2


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

    exit_code = 1


class PlanError(InputError):
    """A route that no lane sequence connects."""


class WindowClosedError(ReactiveError):
    """Somebody has closed SUMO's window while the simulation ran: the run ends as if interrupted (exit code 130)."""

    exit_code = 130


class SimulationError(ReactiveError):
    """SUMO failed while the simulation ran (exit code 3)."""

    exit_code = 3
