#!/usr/bin/env python3
"""Make the notebooks of docs/paths/ from the pages beside them, with what their cells print, or compare them.

    python tools/notebooks.py [NAME…] [--check] [--paths FOLDER]

A page's blocks of Python are the notebook's cells. They run in a fresh kernel, in a folder that holds copies of scenarios,
networks and experiments alone. Pictures are not compared, and numbers as those of `samples.py`. Exit codes: 0 written or up
to date, 1 out of date, 2 wrong usage.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path

import jupytext
import nbformat
from jupyter_client import AsyncKernelManager
from nbclient import NotebookClient
from nbformat import NotebookNode
from samples import COPIED, is_alike

ROOT = Path(__file__).resolve().parent.parent
PATHS = ROOT / "docs" / "paths"
LONGEST_S = 600


def main() -> None:
    """Write or compare what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="of pages in docs/paths/; all without one")
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if a notebook is out of date")
    parser.add_argument("--paths", type=Path, default=PATHS, metavar="FOLDER", help="of pages and notebooks")
    asked = parser.parse_args()
    known = {page.stem: page for page in sorted(asked.paths.glob("*.md"))}
    if unknown := set(asked.names) - set(known):
        parser.error(f"no page named {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    stale = [name for name in asked.names or known if is_stale(known[name], writes=not asked.check)]
    print(f"{'out of date' if asked.check else 'written'}: {', '.join(stale)}" if stale else "up to date")
    raise SystemExit(int(asked.check and bool(stale)))


def is_stale(page: Path, *, writes: bool) -> bool:
    """Run a page's cells; return whether its notebook says something else, after writing it anew if that is asked for."""
    fresh, place = executed(page), page.with_suffix(".ipynb")
    if place.is_file() and is_alike(told(nbformat.read(place, 4)), told(fresh)):
        return False
    if writes:
        nbformat.write(fresh, place)
    return True


def executed(page: Path) -> NotebookNode:
    """Return a page as a notebook whose cells have run; raise CellExecutionError where one fails."""
    notebook = jupytext.read(page)
    notebook.metadata = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as sockets:
        for name in COPIED:
            shutil.copytree(ROOT / name, Path(folder, name))
        kernel = AsyncKernelManager(kernel_name="python3", transport="ipc", ip=f"{sockets}/kernel")  # no port is opened
        NotebookClient(notebook, km=kernel, timeout=LONGEST_S, resources={"metadata": {"path": folder}}).execute()
    for number, cell in enumerate(notebook.cells):
        cell.id, cell.metadata = f"cell-{number}", {}
        if cell.cell_type == "code":
            cell.outputs = [one for one in cell.outputs if one.get("name") != "stderr"]
    return notebook


def told(notebook: NotebookNode) -> str:
    """Return sources and printed texts of all cells."""
    found = []
    for cell in notebook.cells:
        outputs = cell.get("outputs", ())
        found += [cell.source, *(one.get("text", one.get("data", {}).get("text/plain", "")) for one in outputs)]
    return "\n".join(found)


if __name__ == "__main__":
    main()
