"""`python -m sumo_reactive` is `sumo-reactive`."""

import os
import signal

from sumo_reactive.errors import ExitCode


def main() -> None:
    """Run the command line; an interrupt while its modules are loaded, or when all is done, is one line, too."""
    for name in ("SIGINT", "SIGTERM"):
        if signal.getsignal(getattr(signal, name)) is not signal.SIG_IGN:
            signal.signal(getattr(signal, name), _leave)
    from sumo_reactive.cli import main as run

    run()


def _leave(*_: object) -> None:
    os.write(2, b"sumo-reactive: interrupted\n")
    os._exit(ExitCode.INTERRUPTED)


if __name__ == "__main__":
    main()
