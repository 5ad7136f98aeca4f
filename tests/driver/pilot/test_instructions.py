"""What each symbolic instruction changes in the executor (F&L 1991, §3.2)."""

import pytest

from sumo_reactive.driver.nouns.decision import Instruction
from sumo_reactive.driver.pilot.instructions import PAPER_TUNINGS, TUNINGS

TABLES = pytest.mark.parametrize("table", [TUNINGS, PAPER_TUNINGS], ids=["default", "paper"])


@TABLES
def test_every_instruction_has_a_tuning(table):
    assert set(table) == set(Instruction)


@TABLES
def test_all_weights_are_positive(table):
    for tuning in table.values():
        w = tuning.weights
        assert min(w.valley, w.shadow, w.velocity) > 0.0


@TABLES
def test_overtaking_weakens_the_attraction_of_c_and_nothing_else_that_drives_on_does(table):
    usual, overtaking = table[Instruction.FOLLOW_CURVE].weights, table[Instruction.OVERTAKE].weights
    assert overtaking.valley < usual.valley
    for instruction in (Instruction.APPROACH, Instruction.STOP, Instruction.CROSS, Instruction.RETURN):
        assert table[instruction].weights == usual


@TABLES
def test_overtaking_gives_the_others_shadow_more_weight(table):
    assert table[Instruction.OVERTAKE].weights.shadow > table[Instruction.FOLLOW_CURVE].weights.shadow


@TABLES
def test_overtaking_lets_the_gap_behind_x_close_and_falling_back_brakes_harder(table):
    assert table[Instruction.OVERTAKE].profile.headway < table[Instruction.FOLLOW_CURVE].profile.headway
    assert table[Instruction.FALL_BACK].profile.deceleration > table[Instruction.FOLLOW_CURVE].profile.deceleration


def test_only_the_escape_searches_more_commands_and_the_paper_never_does():
    assert [instruction for instruction, tuning in TUNINGS.items() if tuning.wide_grid] == [Instruction.WIDEN]
    assert not any(tuning.wide_grid for tuning in PAPER_TUNINGS.values())
