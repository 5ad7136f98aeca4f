"""Experiment files: what is wrong is told with file, line and key, before anything runs."""

from pathlib import Path

import pytest

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.experiment import SHARE_METRICS, load_experiment
from sumo_reactive.lab.drivers.choice import REACTIVE, SUMO
from sumo_reactive.lab.metric_names import NETWORK
from sumo_reactive.lab.scenario import load_scenario_file

ROOT = Path(__file__).parents[2]
FOUR_WAY = f"{ROOT}/scenarios/four_way_priority.toml"
HEAD = f'[experiment]\nscenarios = ["{FOUR_WAY}"]\n'
SHARED = HEAD + "[egos]\nshare = [0.5]\n"
CITY = f"{ROOT}/scenarios/city_grid.toml"


def written(folder, text):
    file = folder / "e.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_what_is_left_out_comes_from_the_scenario(tmp_path):
    experiment = load_experiment(written(tmp_path, HEAD))
    (choice,) = experiment.choices
    assert (choice.seeds, choice.egos, choice.scenario.ego) == (load_scenario_file(Path(FOUR_WAY)).seeds, (), "ego")
    assert experiment.store == tmp_path / "e.duckdb"
    assert experiment.drivers == (REACTIVE, SUMO)


def test_values_alone_are_grids_of_one(tmp_path):
    text = HEAD + "[parameters]\nSTUCK_S = 5.0\nPROGRESS_M = [1.0, 2]\n[options]\nscale = 1.5\n"
    experiment = load_experiment(written(tmp_path, text))
    assert experiment.grid == {"stuck_s": [5.0], "progress_m": [1.0, 2.0]}
    assert experiment.options == {"scale": [1.5]}


def test_the_examples_of_this_repository_are_read():
    assert len(load_experiment(ROOT / "experiments" / "grid.toml").choices) == 2
    assert load_experiment(ROOT / "experiments" / "shares.toml").egos.share


def test_shares_have_metrics_of_their_own(tmp_path):
    experiment = load_experiment(written(tmp_path, HEAD + "[egos]\nshare = [0, 0.5]\n"))
    assert experiment.keys.metrics == list(SHARE_METRICS)
    assert set(SHARE_METRICS) <= set(NETWORK)


def test_a_group_and_a_cut_are_of_the_networks_that_have_their_roads(tmp_path):
    head = f'[experiment]\nscenarios = ["{FOUR_WAY}", "{CITY}"]\n[egos]\nshare = [0.5]\n'
    file = head + '[network]\ninterval_s = 30\ngroups = { main = ["A1B1", "B1C1"] }\ncuts = { west = ["from_west"] }\n'
    experiment = load_experiment(written(tmp_path, file))
    four_way, city = (choice.counted for choice in experiment.choices)
    assert (four_way.groups, four_way.cuts) == ((), (("west", ("from_west",)),))
    assert (city.groups, city.cuts) == ((("main", ("A1B1", "B1C1")),), ())
    assert four_way.interval_s == city.interval_s == 30.0
    assert experiment.keys.metrics[-1] == "cut_west_per_h"


def test_a_network_that_has_a_part_of_a_group_is_told(tmp_path):
    text = f'[experiment]\nscenarios = ["{FOUR_WAY}", "{CITY}"]\n[egos]\nshare = [0.5]\n'
    with pytest.raises(ScenarioError, match=r":6: .*has a part of these roads only, not 'A1B1'"):
        load_experiment(written(tmp_path, text + '[network.cuts]\nboth = ["from_west", "A1B1"]\n'))


def test_a_cut_may_be_named_among_the_metrics(tmp_path):
    text = HEAD + 'metrics = ["cut_west_per_h"]\n[egos]\nshare = [0.5]\n[network]\ncuts = { west = ["from_west"] }\n'
    assert load_experiment(written(tmp_path, text)).keys.metrics == ["cut_west_per_h"]


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("", 0, "missing key 'experiment'"),
        (HEAD + "[egos]\nshare = [0.1, 1.5]\n", 4, "key 'egos.share.1'"),
        (HEAD + "[egos]\nshare = []\n", 4, "key 'egos.share'"),
        (HEAD + 'drivers = ["sumo"]\n[egos]\nshare = [0.1]\n', 3, "who is no ego has SUMO's own driver"),
        (HEAD + "horizon_s = 9.0\n[egos]\nshare = [0.1]\n", 3, "all runs end at one time: 'until_s'"),
        (HEAD + "[egos]\nshare = [0.1]\ndrawn = 3\n", 4, "there are 'drawn' already"),
        (HEAD + '[egos]\ntypes = ["bus"]\ndrawn = 3\n', 4, "key 'egos.types': there are 'drawn' already"),
        (HEAD + "[egos]\nregion = [0.0, 1.0]\n", 4, "key 'egos.region'"),
        (HEAD + 'metrics = ["duration_s"]\n[egos]\nshare = [0.1]\n', 3, "'duration_s' is a metric of a trip"),
        (HEAD + 'metrics = ["network_arrived"]\n', 3, "'network_arrived' is a metric of a network"),
        (HEAD + "[network]\ninterval_s = 9.0\n", 3, "[egos] share = […]"),
        (SHARED + "[network]\ninterval_s = 0.0\n", 6, "key 'network.interval_s'"),
        (SHARED + '[network.groups]\nmain = ["from_north", "from_souht"]\n', 6, "'from_souht'; near it: from_south"),
        (SHARED + "[network]\ninterval_s = inf\n", 6, "key 'network.interval_s'"),
        (SHARED + '[network.groups]\nmain = []\n', 6, "key 'network.groups.main'"),
        (SHARED + '[network.cuts]\n"a b" = ["from_west"]\n', 6, "small letters, digits and _"),
        (SHARED + '[network]\ncuts = { here = ["from_west", "from_west"] }\n', 6, "an edge is named twice"),
        ("[experiment]\nscenarios = []\n", 2, "key 'experiment.scenarios'"),
        (HEAD + "seedz = [1]\n", 3, "unknown key 'experiment.seedz'; near it: seeds"),
        (HEAD + "seeds = [1, 2, 1]\n", 3, "named twice"),
        (HEAD + 'seeds = ["1"]\n', 3, "key 'experiment.seeds.0'"),
        (HEAD + 'drivers = ["human"]\n', 3, "key 'experiment.drivers.0'"),
        (HEAD + 'metrics = [\n  "arrived",\n  "durations",\n]\n', 3, "unknown metric 'durations'; near it: duration_s"),
        ('[experiment]\n\nscenarios = ["nowhere.toml"]\n', 3, "nowhere.toml: no such file"),
        (HEAD + "\n[parameters]\nSTUCK = 1.0\n", 5, "unknown parameter 'STUCK'; near it: stuck_s"),
        (HEAD + "\n[parameters]\nSTUCK_S = []\n", 5, "no value"),
        (HEAD + "\n[parameters]\nSTUCK_S = [true]\n", 5, "STUCK_S"),
        (HEAD + "\n[parameters]\nwithout = 1.5\n", 5, "not a mechanism's number"),
        (HEAD + "\n[parameters]\nSTUCK_S = 1.0\nstuck_s = 2.0\n", 6, "parameter 'stuck_s' is named twice"),
        (
            HEAD + "[parameters]\nstuck_s = 1.0\n[samples]\ncount = 2\n[samples.parameters]\nstuck_s = [1.0, 2.0]\n",
            8,
            "there is a grid of it already",
        ),
        (HEAD + "[egos]\nnames = []\n", 4, "names nobody"),
        (HEAD + '[egos]\nnames = ["a"]\ndrawn = 3\n', 5, "there are 'names' already"),
        (HEAD + '[egos.names]\n"other.toml" = ["a"]\n', 4, "no scenario of this experiment"),
        (HEAD + "[samples]\ncount = 0\nparameters = {STUCK_S = [1.0, 2.0]}\n", 4, "key 'samples.count'"),
        (HEAD + "[samples]\ncount = 2\n[samples.parameters]\nSTUCK_S = [2.0, 1.0]\n", 6, "not a range [low, high]"),
        (HEAD + '[options]\ntripinfo-output = "t.xml"\n', 4, "an output that every trial would write to"),
        (HEAD + "[options]\nseed = 3\n", 4, "'seeds'"),
        (HEAD + "[experiment]\n", 3, "not TOML"),
    ],
)
def test_a_problem_is_told_with_its_line_and_key(tmp_path, text, line, said):
    file = written(tmp_path, text)
    with pytest.raises(ScenarioError) as raised:
        load_experiment(file)
    assert str(raised.value).startswith(f"{file}:{line}: " if line else f"{file}: ")
    assert said in str(raised.value)
