"""Who yields to whom at a junction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class RightOfWay:
    """Two square boolean tables over a junction's connections, shape (n, n).

    `yields[i, j]`: traffic on i lets traffic on j go first. `conflicts[i, j]`: their paths meet.
    """

    yields: NDArray[np.bool_]
    conflicts: NDArray[np.bool_]

    def __post_init__(self) -> None:
        if self.yields.shape != self.conflicts.shape or self.yields.ndim != 2:
            raise ValueError("right-of-way tables are square and of one size")

    def must_yield(self, own: int, other: int) -> bool:
        """Whether connection `own` yields to `other`; False where either has no row."""
        return self._known(own, other) and bool(self.yields[own, other])

    def in_conflict(self, own: int, other: int) -> bool:
        """Whether the paths of the two connections meet; False where either has no row."""
        return self._known(own, other) and bool(self.conflicts[own, other])

    def _known(self, own: int, other: int) -> bool:
        return 0 <= own < len(self.yields) and 0 <= other < len(self.yields)
