"""Both readers of networks side by side: the tool tells how many differences there are, and names them."""

from helpers.programs import ROOT, run_tool

CROSSROADS = ROOT / "networks" / "signalised_left_turns" / "signalised_left_turns.net.xml"


def test_an_own_network_is_read_alike():
    answer = run_tool("compare_net_readers", CROSSROADS)
    assert answer.returncode == 0, answer.stderr
    assert "0 differences" in answer.stdout
