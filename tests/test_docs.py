"""The pages build as a site without a warning, each is in its menu, and what it loads is its own."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, and what its builder said."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder / "site")]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=240, check=False)
    assert answer.returncode == 0, answer.stderr
    return folder / "site", answer.stderr


def test_the_site_is_built_without_a_warning(site):
    assert "WARNING" not in site[1]


def test_every_page_is_in_the_menu(site):
    assert "not included in the" not in site[1]
    pages = {page.stem for page in (ROOT / "docs").glob("*.md")}
    assert {page.name for page in site[0].iterdir() if (page / "index.html").exists()} >= pages - {"index"}
    assert (site[0] / "index.html").exists()


def test_no_page_loads_anything_from_elsewhere(site):
    for page in site[0].rglob("*.html"):
        assert re.findall(r'(?:src|<link[^>]*href)="https?://[^"]+', page.read_text(encoding="utf-8")) == [], page
