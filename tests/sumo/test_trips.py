"""Where a trip ends, as a saved state says it; what SUMO saves is scripted."""

from pathlib import Path

import libsumo
import pytest
from scripted import Domain, script

from sumo_reactive.sumo.vehicle_type import arrival_of


def saved(monkeypatch, *vehicles: str, prefix: str = ""):
    """Have SUMO save a state with these vehicles, its names with a prefix; return the files that it has saved."""
    files = []

    def save(name):
        files.append(Path(name).with_name(prefix + Path(name).name))
        files[-1].write_bytes(("<snapshot>\n" + "\n".join(vehicles) + "\n</snapshot>").encode("latin-1"))

    script(monkeypatch, simulation=Domain(saveState=save))
    return files


@pytest.mark.parametrize(
    ("said", "arrival"),
    [
        ('arrivalPos="40.5" arrivalLane="1"', (40.5, 1)),
        ('arrivalLane="0" arrivalPos="-7.5"', (-7.5, 0)),
        ('arrivalPos="0"', (0.0, None)),
        ('arrivalPos="max" arrivalLane="current"', (None, None)),
        ('arrivalPos="random" arrivalPosRandomized="33.25"', (33.25, None)),
        ('arrivalPos="12" arrivalPosRandomized="33.25"', (12.0, None)),
        ('arrivalPosRandomized="33.25"', (33.25, None)),
        ('departPos="3"', (None, None)),
    ],
)
def test_a_number_is_read_and_what_the_trip_leaves_open_is_none(monkeypatch, said, arrival):
    files = saved(
        monkeypatch,
        '    <vehicle id="another" arrivalPos="1" arrivalLane="3">',
        '    <vehicle id="ego.1" arrivalPos="2" arrivalLane="3">',
        '    <vehicle id="na\xefve" arrivalPos="2">',
        f'    <vehicle id="ego" type="car" {said}>',
        '    <vehicle id="ego" arrivalPos="9" arrivalLane="9">',
    )
    assert arrival_of("ego") == arrival
    assert len(files) == 1 and not files[0].parent.exists()


def test_of_one_whom_the_state_does_not_know_nothing_is_read(monkeypatch):
    saved(monkeypatch, '<vehicle id="another" arrivalPos="1" arrivalLane="3">')
    assert arrival_of("ego") == (None, None)


def test_with_an_output_prefix_the_state_has_another_name(monkeypatch):
    saved(monkeypatch, '<vehicle id="ego" arrivalPos="4">', prefix="mine_")
    assert arrival_of("ego") == (4.0, None)


def test_where_sumo_cannot_save_the_trip_ends_at_the_lanes_end(monkeypatch):
    script(monkeypatch, simulation=Domain(saveState=libsumo.TraCIException("rail signals")))
    assert arrival_of("ego") == (None, None)
