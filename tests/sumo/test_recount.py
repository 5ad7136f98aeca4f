"""What SUMO counts amiss of an ego, put right in files as SUMO writes them."""

import gzip

import pytest
from trip_rows import EGO, MEANS, PLAIN, ROW, TIMES, trips_of, written

from sumo_reactive.sumo.recount import Recount, TripFiles, put_right


def test_the_way_of_an_ego_is_the_one_it_drove_and_no_other_byte_changes(tmp_path):
    rows = [ROW.format(id=name, **PLAIN) for name in ("a", "ego", "ego.1")]
    trips = written(tmp_path / "t.xml", trips_of(*rows))
    found = put_right(TripFiles(trips, None), {"ego": EGO})
    assert found == (Recount("t.xml", "ego", "routeLength", "900.00", "300.00"),)
    assert trips.read_text() == trips_of(rows[0], rows[1].replace("900.00", "300.00"), rows[2])
    assert [one.name for one in tmp_path.iterdir()] == ["t.xml"]


def test_time_at_a_stop_of_the_route_is_neither_waiting_nor_lost(tmp_path):
    trips = written(tmp_path / "t.xml", trips_of(ROW.format(id="ego", **PLAIN)))
    found = put_right(TripFiles(trips, None), {"ego": EGO._replace(stopped=10.0)})
    used = {one.attribute: (one.sumo, one.used) for one in found}
    assert used["waitingTime"] == ("14.00", "4.00") and used["stopTime"] == ("0.00", "10.00")
    assert used["timeLoss"] == ("16.50", "6.50")
    assert 'waitingTime="4.00" stopTime="10.00" timeLoss="6.50"' in trips.read_text()


def test_times_in_hours_and_minutes_stay_so(tmp_path):
    trips = written(tmp_path / "t.xml", trips_of(ROW.format(id="ego", **TIMES)))
    put_right(TripFiles(trips, None), {"ego": EGO._replace(stopped=10.0)})
    assert 'waitingTime="00:00:04" stopTime="00:00:10" timeLoss="00:01:06.50"' in trips.read_text()


def test_a_compressed_output_stays_compressed(tmp_path):
    trips = tmp_path / "t.xml.gz"
    trips.write_bytes(gzip.compress(trips_of(ROW.format(id="ego", **PLAIN)).encode()))
    put_right(TripFiles(trips, None), {"ego": EGO})
    assert 'routeLength="300.00"' in gzip.decompress(trips.read_bytes()).decode()


def test_an_id_that_xml_writes_otherwise_is_found(tmp_path):
    trips = written(tmp_path / "t.xml", trips_of(ROW.format(id="a&amp;&quot;b&quot;", **PLAIN)))
    assert put_right(TripFiles(trips, None), {'a&"b"': EGO})[0].used == "300.00"


def test_the_means_over_all_trips_move_with_the_egos_row(tmp_path):
    trips = written(tmp_path / "t.xml", trips_of(ROW.format(id="ego", **PLAIN)))
    means = written(tmp_path / "s.xml", MEANS)
    put_right(TripFiles(trips, means), {"ego": EGO._replace(stopped=10.0)})
    told = means.read_text()  # 600 m and 20 m/s less among four, 10 s less
    assert 'count="4" routeLength="350.00" speed="5.00" duration="40.00" waitingTime="5.50" timeLoss="6.50"' in told
    assert 'loaded="4"' in told


def test_means_without_any_row_that_tells_are_left_and_named(tmp_path):
    means = written(tmp_path / "s.xml", MEANS)
    (found,) = put_right(TripFiles(None, means), {"ego": EGO})
    assert found.sumo == "500.00" and found.used.startswith("left as counted: no tripinfo-output")
    assert means.read_text() == MEANS


def test_an_ego_that_sumo_has_driven_on_is_left_and_named(tmp_path):
    text = trips_of(ROW.format(id="ego", **PLAIN))
    trips = written(tmp_path / "t.xml", text)
    (found,) = put_right(TripFiles(trips, None), {"ego": EGO._replace(duration=20.0)})
    assert found == Recount("t.xml", "ego", "routeLength", "900.00", "left as counted: SUMO's own driver drove on")
    assert trips.read_text() == text


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("t.csv", b"tripinfo_id;tripinfo_routeLength\nego;900.00\n", "not XML"),
        ("t.parquet", b"PAR1\xff\x00", "not XML"),
        (
            "t.xml.gz",
            gzip.compress(trips_of(ROW.format(id="ego", **PLAIN)).encode(), mtime=0)[:-20],
            "Compressed file ended",
        ),
    ],
)
def test_a_file_that_cannot_be_put_right_is_left_and_named(tmp_path, name, content, why):
    trips = tmp_path / name
    trips.write_bytes(content)
    (found,) = put_right(TripFiles(trips, None), {"ego": EGO})
    assert found.used.startswith(f"left as counted: {why}")
    assert trips.read_bytes() == content
    assert [one.name for one in tmp_path.iterdir()] == [name]


def test_an_output_that_is_no_file_is_named(tmp_path):
    (found,) = put_right(TripFiles(tmp_path / "stdout", None), {"ego": EGO})
    assert found.used == "left as counted: no such file"
