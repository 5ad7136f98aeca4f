"""The lists of SUMO's options, held against the template that SUMO itself writes."""

import subprocess
import xml.etree.ElementTree as ElementTree

import pytest
from sumolib import checkBinary
from sumolib.options import readOptions

from sumo_reactive.sumo.config import GUI_ONLY, INPUT_FILES, LEFT_OUT, OUTPUT_FILES, SYNONYMS

BESIDE_THE_CONFIGURATION = {"device.ssm.file", "device.toc.file"}
"""Of type STR, yet SUMO resolves them like files."""
ONLY_WITH_3D = {"osg-terrain", "osg-view"}
"""Known to a sumo-gui that was built with OpenSceneGraph."""


@pytest.fixture(scope="module")
def template(tmp_path_factory):
    path = tmp_path_factory.mktemp("sumo") / "template.xml"
    subprocess.run([checkBinary("sumo"), "--save-template", str(path)], check=True, timeout=60)
    return path


def test_every_option_that_holds_a_file_is_known_as_read_or_written(template):
    files = {option.name for option in readOptions(str(template)) if option.type == "FILE"}
    assert not INPUT_FILES & OUTPUT_FILES
    assert files - LEFT_OUT - {"configuration-file"} == (INPUT_FILES | OUTPUT_FILES) - BESIDE_THE_CONFIGURATION


def test_the_options_that_only_a_window_needs_are_sumos(template):
    (group,) = ElementTree.parse(template).getroot().iterfind("gui_only")
    assert {option.tag for option in group} == GUI_ONLY - ONLY_WITH_3D


def test_every_synonym_of_an_option_that_is_read_here_is_known(template):
    options = [option for group in ElementTree.parse(template).getroot() for option in group]
    synonyms = {name: option.tag for option in options for name in option.get("synonymes", "").split()}
    read = INPUT_FILES | OUTPUT_FILES | LEFT_OUT | set(SYNONYMS.values())
    assert {name: option for name, option in synonyms.items() if option in read} == SYNONYMS
