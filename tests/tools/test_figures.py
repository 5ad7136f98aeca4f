"""The figures: the two that need no run are drawn, and look as those in the README do."""

import numpy as np
import pytest
from helpers.programs import ROOT, run_tool
from matplotlib.image import imread

ALIKE = 0.25
"""Share of the ink that may differ: another release of matplotlib draws letters a pixel aside."""


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    folder = tmp_path_factory.mktemp("images")
    answer = run_tool("figures", "model", "shadow", "--out", folder)
    assert answer.returncode == 0, answer.stderr
    names = ["figure2_model.png", "figure3_shadow.png"]
    assert answer.stdout.splitlines() == [str(folder / name) for name in names]
    return folder


@pytest.mark.parametrize("name", ["figure2_model.png", "figure3_shadow.png"])
def test_a_figure_looks_like_the_one_in_the_readme(drawn, name):
    fresh, kept = imread(drawn / name), imread(ROOT / "docs" / "images" / name)
    assert fresh.shape == kept.shape
    ink = float(np.abs(kept - kept.max()).mean())
    assert float(np.abs(fresh - kept).mean()) < ALIKE * ink


def test_a_figure_that_is_not_there_is_named(tmp_path):
    answer = run_tool("figures", "atlantis", "--out", tmp_path)
    assert (answer.returncode, answer.stdout, list(tmp_path.iterdir())) == (2, "", [])
    assert "no figure named atlantis; there are model, shadow, valley, figure4" in answer.stderr
