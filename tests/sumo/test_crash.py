"""What is told of a fault in native code; the handler as plain Python, with nothing to end."""

import ctypes
import signal
import subprocess
import sys

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
@pytest.mark.parametrize(
    ("told", "words", "code"),
    [(crash._told, ": a fault of SUMO's", 3), (crash._told_with_window, ", as it may when its window is closed", 130)],
)
def test_a_deadly_signal_is_told_in_one_whole_line_that_names_it(written, number, told, words, code):
    told(int(number))
    ((descriptor, line),) = written["texts"]
    assert descriptor > 2 and line.startswith(f"sumo-reactive: SUMO died of {signal.Signals(number).name}{words}")
    assert line.endswith("nothing is written\n") and line.count("\n") == 1
    assert written["codes"] == [code]


@pytest.mark.parametrize("told", [crash._told, crash._told_with_window])
def test_where_the_copy_of_standard_error_is_closed_the_line_goes_to_standard_error(written, told):
    told(int(signal.SIGSEGV))
    ((copy, line),) = written["texts"]
    written["closed"].add(copy)
    told(int(signal.SIGSEGV))
    assert written["texts"][1:] == [(2, line)]


@pytest.mark.parametrize(
    ("has_window", "code", "words"), [(True, 130, "when its window is closed"), (False, 3, "a fault of SUMO's")]
)
def test_a_fault_ends_the_process_as_one_of_a_window_where_there_is_one(has_window, code, words):
    died = f"import ctypes; from sumo_reactive.sumo.crash import crashes_told\nwith crashes_told(has_window={has_window}): "
    command = [sys.executable, "-c", died + "ctypes.string_at(0)"]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=200, check=False)
    assert (answer.returncode, answer.stdout, answer.stderr.count("\n")) == (code, "", 1)
    assert answer.stderr.startswith("sumo-reactive: SUMO died of SIGSEGV") and words in answer.stderr
