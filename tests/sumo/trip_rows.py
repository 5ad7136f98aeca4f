"""Outputs of trips, as SUMO writes them."""

from sumo_reactive.sumo.recount import Driven

ROW = (
    '    <tripinfo id="{id}" depart="5.00" arrival="35.00" duration="{duration}" routeLength="{length}" '
    'waitingTime="{waiting}" stopTime="{stop}" timeLoss="{loss}" vType="car" vaporized=""/>\n'
)
PLAIN = {"duration": "30.00", "length": "900.00", "waiting": "14.00", "stop": "0.00", "loss": "16.50"}
TIMES = {"duration": "00:00:30", "length": "900.00", "waiting": "00:00:14", "stop": "00:00:00", "loss": "00:01:16.50"}
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n\n'
MEANS = (
    HEAD + '<statistics>\n    <vehicles loaded="4"/>\n    <vehicleTripStatistics count="4" routeLength="500.00" '
    'speed="10.00" duration="40.00" waitingTime="8.00" timeLoss="9.00"/>\n</statistics>\n'
)
EGO = Driven(duration=30.0, distance=300.004, stopped=0.0)


def trips_of(*rows):
    return f"{HEAD}<tripinfos>\n{''.join(rows)}</tripinfos>\n"


def written(path, text):
    path.write_text(text, encoding="utf-8")
    return path
