"""A real browser without a window: what a page says, what stands in it, and what it looks like."""

import html
import json
import re
import shutil
import socketserver
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import matplotlib.image
import numpy as np

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
BROWSER = next((found for name in BROWSERS if (found := shutil.which(name))), None)
NO_BROWSER = f"no browser on this machine: none of {', '.join(BROWSERS)} is on the path"

FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--force-device-scale-factor=1",
    "--enable-logging=stderr", "--v=0", "--virtual-time-budget=10000",
)  # fmt: skip
WIDTH, SECONDS = 1300, 120

PLACES = """<script>
addEventListener("load", () => setTimeout(() => {
  const plots = [...document.querySelectorAll(".js-plotly-plot")].map((plot) => {
    const box = plot.getBoundingClientRect();
    return [plot.id, Math.round(box.left), Math.round(box.top), Math.round(box.right), Math.round(box.bottom)];
  });
  document.body.dataset.places = JSON.stringify({ height: document.documentElement.scrollHeight, plots: plots });
}, 1000));
</script>"""
"""Notes where the plots of a page are when it has been drawn."""


PRESSED = """<script>
addEventListener("load", () => setTimeout(async () => {
  const seen = new Set();
  const kinds = "button, [role=button], input[type=button], input[type=submit], .modebar-btn, .updatemenu-button";
  for (let found = true; found && seen.size < 500; ) {
    found = false;
    for (const button of document.querySelectorAll(kinds)) {
      if (seen.has(button)) continue;
      seen.add(button);
      found = true;
      button.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true, view: window }));
      await new Promise((done) => setTimeout(done, 20));
    }
  }
  const titles = [...seen].map((one) => one.getAttribute("data-title") || one.textContent.trim());
  document.body.dataset.pressed = JSON.stringify(titles);
}, 1000));
</script>"""
"""Presses every button, also those that come up by that, and notes what stands on them."""


@dataclass(frozen=True)
class Opened:
    """A page in a browser: lines on its console, its elements after loading, its plots as pictures (n, m, 3), 0 to 1."""

    console: list[str]
    dom: str
    plots: dict[str, np.ndarray]


OWN_HOSTS = (".google.com", ".googleapis.com", ".gstatic.com", ".gvt1.com")
"""Where a browser with a new profile asks for updates and the like."""


@dataclass(frozen=True)
class Pressed:
    """What became of pressing every button of a page: their titles, lines on the console, hosts that the page asked for."""

    buttons: list[str]
    console: list[str]
    hosts: set[str]


def pressed(page: Path, folder: Path) -> Pressed:
    """Press every button of a page while the network refuses every request and notes where it was to go."""
    hosts: set[str] = set()
    with _refusing(hosts) as port:
        refused = f"--proxy-server=127.0.0.1:{port}", "--proxy-bypass-list=<-loopback>", "--disable-popup-blocking"
        dom, said = _browse(_with(page, folder, PRESSED), folder, "--dump-dom", *refused)
    found = re.search(r'data-pressed="([^"]*)"', dom)
    assert found, said
    console = [line for line in said.splitlines() if "CONSOLE" in line]
    return Pressed(json.loads(html.unescape(found[1])), console, {one for one in hosts if not one.endswith(OWN_HOSTS)})


@contextmanager
def _refusing(hosts: set[str]) -> Iterator[int]:
    """Give the port of a proxy that answers nobody and notes the hosts asked for."""

    class Refusal(socketserver.StreamRequestHandler):
        def handle(self) -> None:
            if asked := re.match(rb"[A-Z]+ (?:\w+://)?([^/: ]+)", self.rfile.readline(1000)):
                hosts.add(asked[1].decode(errors="replace"))

    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Refusal) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield server.server_address[1]
        finally:
            server.shutdown()
            thread.join()


def _with(page: Path, folder: Path, script: str) -> Path:
    """Return a copy of a page with a script at its end."""
    noted = folder / "noted.html"
    noted.write_text(page.read_text(encoding="utf-8").replace("</body>", f"{script}</body>"), encoding="utf-8")
    return noted


def browsed(page: Path, folder: Path, script: str, noted: str) -> tuple[object, list[str]]:
    """Open a page with a script that notes what it finds in the body's data under a name; return that and the console."""
    dom, said = _browse(_with(page, folder, script), folder, "--dump-dom")
    found = re.search(rf'data-{noted}="([^"]*)"', dom)
    assert found, said
    return json.loads(html.unescape(found[1])), [line for line in said.splitlines() if "CONSOLE" in line]


def opened(page: Path, folder: Path) -> Opened:
    """Open a page in a browser with a new profile; `folder` takes what that needs."""
    noted = _with(page, folder, PLACES)
    dom, said = _browse(noted, folder, "--dump-dom")
    found = re.search(r'data-places="([^"]*)"', dom)
    places = json.loads(html.unescape(found[1])) if found else {"height": 1000, "plots": []}
    picture = folder / "page.png"
    _browse(noted, folder, f"--screenshot={picture}", f"--window-size={WIDTH},{places['height']}")
    pixels = matplotlib.image.imread(picture)[..., :3]
    plots = {name: pixels[top:bottom, left:right] for name, left, top, right, bottom in places["plots"]}
    return Opened([line for line in said.splitlines() if "CONSOLE" in line], dom, plots)


def _browse(page: Path, folder: Path, *flags: str) -> tuple[str, str]:
    profile = folder / "profile"
    command = [BROWSER, *FLAGS, f"--window-size={WIDTH},1000", *flags, f"--user-data-dir={profile}", page.as_uri()]
    answer = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=SECONDS, check=True)
    shutil.rmtree(profile, ignore_errors=True)
    return answer.stdout, answer.stderr


def coloured(picture: np.ndarray) -> int:
    """Return how many pixels of a picture are neither white, black nor grey."""
    return int(np.count_nonzero(picture.max(axis=2) - picture.min(axis=2) > 0.25))


def of_colour(picture: np.ndarray, colour: str) -> int:
    """Return how many pixels of a picture have a colour such as "#0072b2"."""
    wanted = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return int(np.count_nonzero(np.abs(picture - wanted).max(axis=2) < 0.02))
