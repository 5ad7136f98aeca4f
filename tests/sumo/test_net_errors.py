"""Networks that cannot serve: each error is one line that names the file and the place."""

import gzip
import re

import pytest
from net_recipes import MINIMAL

from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_reader import read_net

WITHOUT_INTERNAL = """<net>
  <edge id="a" from="x" to="y"><lane id="a_0" index="0" speed="9" length="10" shape="0,0 10,0"/></edge>
  <edge id="b" from="y" to="z"><lane id="b_0" index="0" speed="9" length="10" shape="10,0 20,0"/></edge>
  <connection from="a" to="b" fromLane="0" toLane="0" dir="s" state="M"/>
</net>"""


def refused(path, text: bytes | str | None, route=None) -> str:
    """Return the error's text, having checked that it is one line that names the file."""
    if text is not None:
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(NetworkError, match=re.escape(str(path))) as caught:
        net = read_net(path)
        net.build(route)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "no such file"),
        ("", "not XML"),
        ("<net><edge></net>", "line 1"),
        ("<routes/>", "root element is <routes>"),
        ("<net/>", "no edges"),
        (WITHOUT_INTERNAL, "--no-internal-links"),
        ("<net><edge/></net>", "lacks attribute 'id'"),
        (gzip.compress(MINIMAL.encode(), mtime=0)[:200], "cannot be read"),
    ],
)
def test_a_file_that_is_no_usable_network_is_refused(tmp_path, text, says):
    assert says in refused(tmp_path / "some.net.xml", text, ["w"])


def test_a_folder_is_no_network(tmp_path):
    assert "a directory, not a file" in refused(tmp_path, None)


@pytest.mark.parametrize(
    ("route", "says"), [(["nowhere"], "unknown edge 'nowhere'"), ([":j_0"], "':j_0' is inside a junction")]
)
def test_a_route_that_is_not_of_normal_edges_is_refused(tmp_path, route, says):
    assert says in refused(tmp_path / "some.net.xml", MINIMAL, route)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('shape="104,-1.6 200,-1.6"', 'shape="104,abc 200,-1.6"', "lane 'e_0'"),
        ('shape="104,-1.6 200,-1.6"', 'shape=""', "lane 'e_0': shape ''"),
        ('shape="104,-1.6 200,-1.6"', "", "lane 'e_0' lacks attribute 'shape'"),
        ('shape="104,-1.6 200,-1.6"', 'width="-1" shape="104,-1.6 200,-1.6"', "lane e_0"),
        ('via=":j_0_0" dir="s" state="M"', 'via=":j_0_0" dir="s"', "connection 'w_0->e_0' lacks attribute 'state'"),
        ('via=":j_0_0"', 'via=":j_9_0"', "unknown edge ':j_9'"),
        ('linkIndex="3"', 'linkIndex="three"', "connection 's_0->n_0'"),
        ('index="1" response="100"', 'index="1"', "junction 'j' lacks attribute 'response'"),
        ('index="1" response="100"', 'index="one" response="100"', "junction 'j'"),
        ('<junction id="j"', '<junction id="k"', "unknown junction 'j'"),
        ('to="e" fromLane="0" toLane="0"', 'to="e" fromLane="0" toLane="7"', "unknown lane 'e_7'"),
    ],
)
def test_a_malformed_piece_is_named(tmp_path, old, new, says):
    assert old in MINIMAL
    assert says in refused(tmp_path / "some.net.xml", MINIMAL.replace(old, new), ["w", "e"])
