"""Who is equipped with this driver, by what route files and vehicle types say."""

import gzip

import pytest
from net_recipes import CROSS_NODES, converted, cross_edges
from simulations import running, simulated, vehicle

from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.vehicle_type import Equipment


def said(**values: object) -> str:
    """Parameters of a vehicle or type: `has`, `share`."""
    keys = {"has": "has.reactive.device", "share": "device.reactive.probability"}
    return "".join(f'<param key="{keys[name]}" value="{value}"/>' for name, value in values.items())


@pytest.fixture(scope="module")
def net(tmp_path_factory):
    return converted(tmp_path_factory.mktemp("net"), CROSS_NODES.format(kind="priority"), cross_edges(), "--no-turnarounds")


def shares(net, folder, content: str, more: str = "", packed: bool = False) -> dict[str, float | None]:
    """The share of each vehicle in a simulation of `content` and an additional file."""
    routes = folder / ("r.rou.xml.gz" if packed else "r.rou.xml")
    data = f"<routes>{content}</routes>".encode()
    routes.write_bytes(gzip.compress(data) if packed else data)
    (folder / "m.add.xml").write_text(f"<additional>{more}</additional>", encoding="utf-8")
    files = (
        f'<net-file value="{net}"/><route-files value="{routes.name}"/><additional-files value="m.add.xml, gone.add.xml"/>'
    )
    (folder / "c.sumocfg").write_text(f"<configuration>{files}</configuration>", encoding="utf-8")
    equipment = Equipment(read_config(folder / "c.sumocfg"))
    names = ("a", "b", "c", "f.0")
    with running(net, folder, content, "-a", str(folder / "m.add.xml")):
        simulated()
        return {name: equipment.share(name) for name in names if f'id="{name.removesuffix(".0")}"' in content}


def test_nothing_said_is_nothing(net, tmp_path):
    assert shares(net, tmp_path, vehicle("a", "wc ce")) == {"a": None}


def test_a_vehicle_says_for_itself_and_only_for_itself(net, tmp_path):
    cars = vehicle("a", "wc ce", said(has="true")) + vehicle("b", "ec cw", said(has="no")) + vehicle("c", "nc cs")
    assert shares(net, tmp_path, cars) == {"a": 1.0, "b": 0.0, "c": None}


def test_a_share_is_read_as_it_is_said(net, tmp_path):
    assert shares(net, tmp_path, vehicle("a", "wc ce", said(share=" 0.25 "))) == {"a": 0.25}
    assert shares(net, tmp_path, vehicle("a", "wc ce", said(share=0) + said(has="on"))) == {"a": 1.0}
    assert shares(net, tmp_path, vehicle("a", "wc ce", said(share=1))) == {"a": 1.0}


def test_a_type_says_it_for_its_vehicles_and_a_vehicle_wins(net, tmp_path):
    kind = f'<vType id="t">{said(share=0.5)}</vType>'
    cars = vehicle("a", "wc ce", type="t") + vehicle("b", "ec cw", said(has="false"), type="t") + vehicle("c", "nc cs")
    assert shares(net, tmp_path, kind + cars) == {"a": 0.5, "b": 0.0, "c": None}


def test_a_flow_says_it_for_all_its_vehicles(net, tmp_path):
    flow = f'<flow id="f" begin="0" end="1" number="1" from="wc" to="ce">{said(has="true")}</flow>'
    assert shares(net, tmp_path, flow) == {"f.0": 1.0}


def test_packed_and_additional_files_are_read_too(net, tmp_path):
    assert shares(net, tmp_path, vehicle("a", "wc ce", said(has="true")), packed=True) == {"a": 1.0}
    kind = f'<vType id="t">{said(share=0.5)}</vType>'
    assert shares(net, tmp_path, vehicle("a", "wc ce", type="t"), kind) == {"a": 0.5}


@pytest.mark.parametrize(
    ("inner", "complaint"),
    [
        (said(has="maybe"), "r.rou.xml: vehicle 'a': has.reactive.device is 'maybe', neither true nor false"),
        (said(share="half"), "r.rou.xml: vehicle 'a': device.reactive.probability is 'half', not a number within 0 and 1"),
        (said(share="1.5"), "is '1.5', not a number within 0 and 1"),
        (said(share="-0.5"), "is '-0.5', not a number within 0 and 1"),
    ],
)
def test_what_is_neither_is_told_with_file_and_vehicle(net, tmp_path, inner, complaint):
    with pytest.raises(ScenarioError) as told:
        shares(net, tmp_path, vehicle("a", "wc ce", inner))
    assert str(told.value).endswith(complaint)


def test_a_type_that_says_something_impossible_is_named(net, tmp_path):
    with pytest.raises(ScenarioError, match=r"vType 't': has.reactive.device is 'perhaps'"):
        shares(net, tmp_path, f'<vType id="t">{said(has="perhaps")}</vType>' + vehicle("a", "wc ce", type="t"))


def test_a_file_that_is_no_xml_is_told_with_its_line(net, tmp_path):
    (tmp_path / "bad.rou.xml").write_text("<routes>\n<vehicle has.reactive.device\n</routes>", encoding="utf-8")
    (tmp_path / "c.sumocfg").write_text(
        f'<configuration><net-file value="{net}"/><route-files value="bad.rou.xml"/></configuration>', encoding="utf-8"
    )
    with pytest.raises(ScenarioError, match=r"bad\.rou\.xml:3: not XML: not well-formed"):
        Equipment(read_config(tmp_path / "c.sumocfg"))
