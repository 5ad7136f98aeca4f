"""Every tool of the folder is run by a test of its own, which looks at what it says."""

import re
from pathlib import Path

import pytest
from helpers.programs import TOOLS

HERE = Path(__file__).parent


@pytest.mark.parametrize("name", sorted(path.stem for path in TOOLS.glob("*.py")))
def test_every_tool_is_run_by_a_test_that_looks_at_its_output(name):
    path = HERE / f"test_{name}.py"
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    assert re.search(rf"""run_tool\(\s*"{name}"|["']{name}\.py["'].*sys\.executable""", text, re.DOTALL)
    assert "stdout" in text
