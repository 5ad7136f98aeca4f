"""What is told of a fault in native code; the handler as plain Python, with nothing to end."""

import ctypes
import signal

import pytest

from sumo_reactive.sumo import crash


@pytest.fixture
def written(monkeypatch):
    """What the handler writes, by descriptor, and with which code it ends; `closed`: where nothing can be written."""
    said = {"closed": set(), "texts": [], "codes": []}

    def write(descriptor, address, size):
        if descriptor in said["closed"]:
            return -1
        said["texts"].append((descriptor, ctypes.string_at(int(address), int(size)).decode()))
        return int(size)

    monkeypatch.setattr(crash, "_write", write)
    monkeypatch.setattr(crash, "_exit", said["codes"].append)
    return said


@pytest.mark.parametrize("number", crash.DEADLY)
def test_a_deadly_signal_is_told_in_one_whole_line_that_names_it(written, number):
    crash._told(int(number))
    ((descriptor, line),) = written["texts"]
    assert descriptor > 2 and line.startswith(f"sumo-reactive: SUMO died of {signal.Signals(number).name}: ")
    assert line.endswith("nothing is written\n") and line.count("\n") == 1
    assert written["codes"] == [crash.EXIT_CODE]


def test_where_the_copy_of_standard_error_is_closed_the_line_goes_to_standard_error(written):
    crash._told(int(signal.SIGSEGV))
    ((copy, line),) = written["texts"]
    written["closed"].add(copy)
    crash._told(int(signal.SIGSEGV))
    assert written["texts"][1:] == [(2, line)]
