"""What programs import from the package itself, and what that costs."""

import dataclasses
import importlib
import inspect
import os
import pkgutil
import subprocess
import sys
import tomllib
import typing
import venv
from pathlib import Path

import sumo_reactive
from sumo_reactive import Controller, Driver, compare, load_scenario, read_run, run_fleet, run_trial

ROOT = Path(__file__).resolve().parents[1]


def test_the_package_offers_what_programs_need():
    offered = (Controller, Driver, compare, load_scenario, read_run, run_fleet, run_trial)
    assert {one.__name__ for one in offered} == set(dir(sumo_reactive)) - {"__version__"}


def reached():
    """Return the classes that the signatures of the package's public names lead to, and theirs in turn."""
    names = {}
    for module in pkgutil.walk_packages(sumo_reactive.__path__, "sumo_reactive."):
        if not module.name.endswith("__main__"):
            names |= {k: v for k, v in vars(importlib.import_module(module.name)).items() if inspect.isclass(v)}
    found, left = set(), [getattr(sumo_reactive, name) for name in set(dir(sumo_reactive)) - {"__version__"}]
    while left:
        one = left.pop()
        if one not in found:
            found.add(one)
            own = [one, *(getattr(it, "fget", None) or getattr(it, "func", it) for it in vars(one).values())]
            signed = (it for it in own if it is one or inspect.isfunction(it))
            left += (it for hint in signed for it in classes_in(typing.get_type_hints(hint, localns=names).values()))
    return {one for one in found if inspect.isclass(one)}


def classes_in(hints):
    """Yield the package's own classes in type hints."""
    for hint in hints:
        if inspect.isclass(hint) and hint.__module__.startswith("sumo_reactive."):
            yield hint
        yield from classes_in(hint if isinstance(hint, list | tuple) else typing.get_args(hint))


def test_what_has_more_than_four_fields_is_made_by_keywords_alone():
    values = [one for one in reached() if dataclasses.is_dataclass(one)]
    given = {one.__name__: [field.kw_only for field in dataclasses.fields(one) if field.init] for one in values}
    assert len(given) > 50
    assert {name for name, by_keyword in given.items() if len(by_keyword) > 4 and not all(by_keyword)} == set()


USE = """from pathlib import Path

from sumo_reactive import compare, load_scenario, run_trial

scenario = load_scenario(Path("a.toml"))
reveal_type(run_trial(scenario).verdict)
reveal_type(compare([scenario], horizon_s=1.0, jobs=1, wall_limit_s=1.0))
run_trial("a.toml")
"""


def test_a_program_elsewhere_is_checked_against_the_types_of_an_editable_install(tmp_path):
    """It leaves a path in the environment, as `package-dir` asks for; a finder, the default, tells type checkers nothing."""
    config = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert config["tool"]["setuptools"]["package-dir"] == {"": "."}
    venv.create(tmp_path / "env", symlinks=True)
    (packages,) = (tmp_path / "env").glob("lib/python3.*/site-packages")
    (packages / "__editable__.sumo_reactive.pth").write_text(f"{ROOT}\n", encoding="utf-8")
    (tmp_path / "use.py").write_text(USE, encoding="utf-8")
    options = ["--strict", "--cache-dir", ".cache", "--python-executable", "env/bin/python", "--follow-imports", "silent"]
    command = [sys.executable, "-m", "mypy", *options, "use.py"]
    bare = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "MYPYPATH")}
    told = subprocess.run(command, cwd=tmp_path, env=bare, capture_output=True, text=True, timeout=240, check=False).stdout
    assert 'use.py:6: note: Revealed type is "str"' in told
    assert 'use.py:7: note: Revealed type is "list[sumo_reactive.lab.comparison.comparison.Comparison]"' in told
    assert 'use.py:8: error: Argument 1 to "run_trial" has incompatible type "str"; expected "Scenario"' in told


def test_what_it_does_not_have_is_told():
    try:
        sumo_reactive.drive  # noqa: B018
    except AttributeError as error:
        assert str(error) == "module 'sumo_reactive' has no attribute 'drive'"


def test_importing_it_loads_nothing_that_takes_long():
    heavy = ("numpy", "libsumo", "numba", "pydantic")
    code = f"import sys, sumo_reactive; print([name for name in {heavy} if name in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert answer.stdout.strip() == "[]"
