"""Other values for parameters, from the environment of a process."""

import json
import os
import subprocess
import sys

import pytest

from sumo_reactive.driver.overrides import VARIABLE, apply_overrides
from sumo_reactive.errors import ParameterError

CONSTANTS = {"STUCK_S": 600.0, "MAX_TRIALS": 100, "NAME": "text", "json": json}


def applied(monkeypatch, text):
    monkeypatch.setenv(VARIABLE, text)
    parameters = dict(CONSTANTS)
    apply_overrides(parameters)
    return parameters


def test_numbers_take_the_place_of_numbers_and_keep_their_kind(monkeypatch):
    found = applied(monkeypatch, '{"STUCK_S": 5, "MAX_TRIALS": 7.0}')
    assert repr((found["STUCK_S"], found["MAX_TRIALS"])) == "(5.0, 7)"
    assert applied(monkeypatch, "") == CONSTANTS


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "not JSON"),
        ("[1]", "not a JSON object"),
        ('{"STUCK": 1}', "unknown parameter 'STUCK'; near it: STUCK_S"),
        ('{"NAME": 1}', "unknown parameter 'NAME'"),
        ('{"json": 1}', "unknown parameter 'json'"),
        ('{"STUCK_S": "1"}', "not a finite number"),
        ('{"STUCK_S": NaN}', "not a finite number"),
        ('{"STUCK_S": true}', "not a finite number"),
        ('{"MAX_TRIALS": 1.5}', "not a whole number"),
    ],
)
def test_what_cannot_be_is_told(monkeypatch, text, said):
    with pytest.raises(ParameterError) as raised:
        applied(monkeypatch, text)
    assert said in str(raised.value)


def cache_folder(**overrides):
    code = "from sumo_reactive.driver.compilation import CACHE_FOLDER; print(CACHE_FOLDER)"
    environment = os.environ | {VARIABLE: json.dumps(overrides)}
    return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True).stdout


def test_kernels_are_compiled_anew_only_for_what_they_read():
    assert cache_folder(STUCK_S=1.0) == cache_folder()
    assert cache_folder(VALLEY_ATTRACTION=1.0) != cache_folder()
