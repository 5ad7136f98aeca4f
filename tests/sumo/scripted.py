"""SUMO as a script says: what it answers is in a table, and what it is told is kept, in order."""

from __future__ import annotations

from collections.abc import Callable

import libsumo
import pytest


class Domain:
    """One of SUMO's domains (`libsumo.vehicle`, …).

    `answers` maps what may be asked to the answer: a value for all, a dict by whom or what it is asked of, or a function.
    An exception is raised. Whatever is no question is an order, kept in `told`.
    """

    def __init__(self, **answers: object) -> None:
        self.answers = answers
        self.told: list[tuple[object, ...]] = []

    def __getattr__(self, name: str) -> Callable[..., object]:
        if name not in self.answers and name.startswith(("get", "is", "convert", "find")):
            raise AssertionError(f"nobody has scripted {name}")
        return lambda *of, **more: self._said(name, of, more)

    def _said(self, name: str, of: tuple[object, ...], more: dict[str, object]) -> object:
        if name not in self.answers:
            self.told.append((name, *of, more) if more else (name, *of))
            return None
        answer = self.answers[name]
        if callable(answer):
            return answer(*of, **more)
        if isinstance(answer, dict):
            answer = answer[of[0] if len(of) == 1 else of]
        if isinstance(answer, Exception):
            raise answer
        return answer


def script(monkeypatch: pytest.MonkeyPatch, **domains: Domain) -> None:
    """Have these domains answer in the place of SUMO's, each by its name."""
    for name, domain in domains.items():
        monkeypatch.setattr(libsumo, name, domain)
