"""Paired differences: their mean, and an interval wherever there is one."""

from __future__ import annotations

import numpy as np
import pytest

from sumo_reactive.lab.comparison.statistics import effects_among, interval_of, paired_difference


def test_a_difference_is_the_second_minus_the_first_over_the_same_things():
    found = paired_difference([(10.0, 12.0), (20.0, 21.0), (30.0, 36.0)])
    assert found is not None
    assert (found.n, found.first, found.second, found.difference) == (3, 20.0, 23.0, 3.0)
    assert found.interval is not None
    assert 1.0 <= found.interval.low < 3.0 < found.interval.high <= 6.0


def test_one_pair_has_a_difference_but_no_interval_and_nothing_has_neither():
    found = paired_difference([(1.0, 3.0)])
    assert found is not None
    assert (found.n, found.difference, found.interval) == (1, 2.0, None)
    assert paired_difference([]) is None


def test_equal_differences_have_an_interval_of_no_width_where_bca_is_not_defined():
    interval = interval_of([2.0, 2.0, 2.0])
    assert interval is not None
    assert (interval.low, interval.high, interval.method) == (2.0, 2.0, "percentile")
    assert not interval.holds_zero


def test_the_same_differences_give_the_same_interval_again():
    values = [0.3, -0.1, 0.8, 0.2, 0.5]
    assert interval_of(values) == interval_of(values)


def test_the_interval_holds_the_mean_of_the_population_about_as_often_as_it_says():
    random, trials = np.random.default_rng(1), 200
    found = [interval_of(random.normal(1.0, 2.0, 30).tolist()) for _ in range(trials)]
    hits = sum(one is not None and one.low <= 1.0 <= one.high for one in found)
    assert hits / trials == pytest.approx(0.95, abs=0.04)
    assert {one.method for one in found if one} == {"BCa"}


def test_the_size_of_an_effect_is_the_mean_difference_over_its_standard_deviation():
    effect = effects_among({"t": [(0.0, 1.0), (0.0, 2.0), (0.0, 3.0)]})["t"]
    assert effect.size == pytest.approx(2.0)
    assert effect.p == pytest.approx(2 / 8)  # of the eight ways to flip three signs two are as far from zero


def test_many_metrics_are_corrected_together_and_one_alone_is_not():
    sure = [(0.0, 1.0 + 0.01 * k) for k in range(12)]
    none = [(0.0, (-1.0) ** k) for k in range(12)]
    alone, among = effects_among({"a": sure})["a"], effects_among({"a": sure, "b": none, "c": none})
    assert alone.corrected == alone.p == pytest.approx(2 / 2**12)
    assert among["a"].p == alone.p < among["a"].corrected
    assert among["a"].is_shown and not among["b"].is_shown
    assert among["b"].p == pytest.approx(1.0)


def test_fewer_than_ten_pairs_show_nothing_beyond_doubt():
    assert effects_among({"a": [(0.0, 1.0 + 0.01 * k) for k in range(9)]})["a"].corrected < 0.05
    assert not effects_among({"a": [(0.0, 1.0 + 0.01 * k) for k in range(9)]})["a"].is_shown


@pytest.mark.parametrize(("pairs", "p"), [([(1.0, 3.0)], None), ([(1.0, 1.0)] * 3, 1.0), ([(0.1, 0.4), (0.2, 0.5)], 0.5)])
def test_differences_that_are_all_equal_have_no_effect_size(pairs, p):
    effect = effects_among({"a": pairs})["a"]
    assert effect.size is None and effect.p == p


def test_a_metric_without_a_pair_has_no_effect():
    assert effects_among({"a": []}) == {}
