"""`python -m sumo_reactive` is `sumo-reactive`."""

from sumo_reactive.cli import main

if __name__ == "__main__":
    main()
