#!/usr/bin/env python3
"""Write docs/api/: a page for each public name of the package, and for each noun that its signature speaks of.

    python tools/api_pages.py [--check] [--folder FOLDER]

Everything is from the source: signatures as they are written there, docstrings, the lines below fields. Each page has its
line in mkdocs.yml. Exit codes: 0 written or up to date, 1 out of date, 2 wrong usage.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import textwrap
import typing
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import sumo_reactive
from sumo_reactive.sumo.launch import OptionOverride
from sumo_reactive.sumo.recount import Recount

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "api"

LONGEST = 100
"""Characters of a signature in one line."""

CHECKED_ALONE = {one.__name__: one for one in (OptionOverride, Recount)}
"""What a module imports for its type checker alone."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


def main() -> None:
    """Write or compare the pages."""
    write_or_compare(pages, FOLDER, __doc__ or "")


def write_or_compare(make: Callable[[], dict[str, str]], folder: Path, told: str) -> None:
    """Do what a command line asks that is `told` of: have the pages made, write them to a folder or compare them; exit."""
    parser = argparse.ArgumentParser(description=told, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if a page is out of date")
    parser.add_argument("--folder", type=Path, default=folder, help=f"default {folder.relative_to(ROOT)}")
    asked = parser.parse_args()
    asked.folder.mkdir(exist_ok=True)
    fresh = make()
    there = {page.name: page.read_text(encoding="utf-8") for page in asked.folder.glob("*.md")}
    stale = sorted(name for name in fresh.keys() | there.keys() if fresh.get(name) != there.get(name))
    for name in () if asked.check else stale:
        if name in fresh:
            (asked.folder / name).write_text(fresh[name], encoding="utf-8")
        else:
            (asked.folder / name).unlink()
    print(f"{'out of date' if asked.check else 'written'}: {', '.join(stale)}" if stale else "up to date")
    raise SystemExit(int(asked.check and bool(stale)))


def pages() -> dict[str, str]:
    """Return each page by the name of its file."""
    names = sorted(set(dir(sumo_reactive)) - {"__version__"})
    public = [getattr(sumo_reactive, name) for name in names]
    spoken_of = {noun.__name__: noun for one in public for noun in nouns_of(one)}
    shown = {one.__name__: one for one in public} | spoken_of
    index = ["# The API\n", "What `sumo_reactive` itself offers:\n", *(f"- [{name}]({name}.md)" for name in names)]
    index += ["\nWhat these speak of:\n", *(f"- [{name}]({name}.md)" for name in sorted(spoken_of.keys() - set(names)))]
    found = {f"{name}.md": page(one, shown.keys(), is_public=name in names) for name, one in shown.items()}
    return {"index.md": "\n".join(index) + "\n", **found}


def nouns_of(one: Any) -> Iterator[type]:
    """Yield the package's classes that a function's or a class's signatures name."""
    signed = [one, *(f for f in vars(one).values() if inspect.isfunction(f))] if inspect.isclass(one) else [one]
    for it in signed:
        if not it.__name__.startswith("_") or it.__name__ == "__init__":
            yield from _classes_in(typing.get_type_hints(it, localns=CHECKED_ALONE).values())


def _classes_in(hints: Iterable[Any]) -> Iterator[type]:
    for hint in hints:
        if inspect.isclass(hint) and hint.__module__.startswith("sumo_reactive."):
            yield hint
        yield from _classes_in(hint if isinstance(hint, list | tuple) else typing.get_args(hint))


def page(one: Any, shown: Iterable[str], *, is_public: bool) -> str:
    """Return the page of a function or class."""
    node = source_of(one)
    place = "sumo_reactive" if is_public else one.__module__
    parts = [f"# {one.__name__}", f"`from {place} import {one.__name__}`"]
    parts += [_fenced(signature(node))] if isinstance(node, Function) else []
    parts.append(told(node))
    if isinstance(node, ast.ClassDef):
        hidden = (base for base in one.__mro__[1:] if base.__module__ == one.__module__ and base.__name__.startswith("_"))
        parts += members([it for whole in (*map(source_of, hidden), node) for it in body_of(whole)])
    words = {name.id for name in ast.walk(node) if isinstance(name, ast.Name)}
    others = [name for name in sorted(shown) if name in words and name != one.__name__]
    parts += [f"See also: {', '.join(f'[{name}]({name}.md)' for name in others)}."] if others else []
    return "\n\n".join(parts) + "\n"


def source_of(one: Any) -> ast.ClassDef | Function:
    """Return the definition of a function or class."""
    (node,) = ast.parse(textwrap.dedent(inspect.getsource(one))).body
    assert isinstance(node, ast.ClassDef | Function)
    return node


def body_of(node: ast.ClassDef | Function) -> list[ast.stmt]:
    """Return the statements after the docstring."""
    return node.body[1:] if ast.get_docstring(node) is not None else node.body


def members(body: list[ast.stmt]) -> Iterator[str]:
    """Yield fields or choices, properties and methods of a class, each with what is said of it."""
    lines = []
    for field, after in zip(body, [*body[1:], None], strict=True):
        text = ast.unparse(field)
        if not isinstance(field, ast.AnnAssign | ast.Assign) or text.startswith("_"):
            continue
        said = after.value if isinstance(after, ast.Expr) else None
        comment = f": {_one_line(str(said.value))}" if isinstance(said, ast.Constant) else ""
        lines.append(f"- `{text}`{comment}")
    if lines:
        yield "## Fields\n\n" + "\n".join(lines)
    for method in body:
        if isinstance(method, Function) and not method.name.startswith("_"):
            yield f"## {method.name}\n\n{_fenced(signature(method))}\n\n{told(method)}"


def signature(node: Function) -> str:
    """Return how a function is called; of a property, its type."""
    result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    if any("property" in ast.unparse(one) for one in node.decorator_list):
        return f"{node.name}: {ast.unparse(node.returns)}" if node.returns else node.name
    whole = f"{node.name}({_given(node)}){result}"
    if len(whole) <= LONGEST:
        return whole
    arguments = ast.parse(f"def f({_given(node)}): ...").body[0]
    assert isinstance(arguments, ast.FunctionDef)
    given = "".join(f"    {part},\n" for part in _parts(arguments.args))
    return f"{node.name}(\n{given}){result}"


def _given(node: Function) -> str:
    """Return the parameters as written, `self` left out."""
    return ast.unparse(node.args).removeprefix("self").removeprefix("cls").removeprefix(", ")


def _parts(arguments: ast.arguments) -> Iterator[str]:
    """Yield each parameter with its type and default."""
    defaults = [None] * (len(arguments.args) - len(arguments.defaults)) + list(arguments.defaults)
    for one, default in zip(arguments.args, defaults, strict=True):
        yield ast.unparse(one) + (f" = {ast.unparse(default)}" if default else "")
    if arguments.kwonlyargs:
        yield "*"
    for one, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True):
        yield ast.unparse(one) + (f" = {ast.unparse(default)}" if default else "")


def told(node: ast.ClassDef | Function) -> str:
    """Return a docstring as paragraphs, each in one line."""
    return "\n\n".join(map(_one_line, (ast.get_docstring(node) or "").split("\n\n")))


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _fenced(code: str) -> str:
    return f"```text\n{code}\n```"


if __name__ == "__main__":
    main()
