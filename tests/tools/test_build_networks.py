"""The builder of networks: what is out of date is found, built, and then up to date."""

import shutil

import pytest
from helpers.programs import ROOT, TOOLS, run_tool

NAME = "right_before_left"


@pytest.fixture
def tools(tmp_path):
    """A copy of the tool with one network."""
    shutil.copytree(ROOT / "networks" / NAME, tmp_path / "networks" / NAME)
    (tmp_path / "tools").mkdir()
    shutil.copy(TOOLS / "build_networks.py", tmp_path / "tools")
    return tmp_path / "tools"


def test_a_network_whose_source_has_changed_is_out_of_date_until_it_is_built(tools):
    nodes = tools.parent / "networks" / NAME / f"{NAME}.nod.xml"
    built = nodes.with_name(f"{NAME}.net.xml")
    assert run_tool("build_networks", "--check", folder=tools).stdout.split() == [NAME, "up", "to", "date"]
    changed = nodes.read_text(encoding="utf-8").replace('type="right_before_left"', 'type="priority"')
    nodes.write_text(changed, encoding="utf-8")
    answer = run_tool("build_networks", "--check", folder=tools)
    assert answer.returncode == 1
    assert answer.stdout.split() == [NAME, "out", "of", "date:", built.name]
    assert 'type="right_before_left"' in built.read_text(encoding="utf-8")
    answer = run_tool("build_networks", folder=tools)
    assert (answer.returncode, answer.stdout.split()) == (0, [NAME, "built:", built.name])
    assert 'type="right_before_left"' not in built.read_text(encoding="utf-8")
    assert run_tool("build_networks", "--check", folder=tools).returncode == 0


def test_a_network_without_sources_is_named(tools):
    nodes = tools.parent / "networks" / NAME / f"{NAME}.nod.xml"
    nodes.unlink()
    answer = run_tool("build_networks", folder=tools)
    assert (answer.returncode, answer.stdout) == (2, "")
    assert answer.stderr == f"build_networks: networks/{NAME}/{nodes.name} is missing\n"
