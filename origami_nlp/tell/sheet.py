"""The paper's 3x3 sheets of landscapes: figure 3 (degree 6) and figure 4 (degree 8)."""

from __future__ import annotations

from typing import Any


def find_panels(name: str, *, seed: int = 0) -> Any:
    """Find the nine panels of a sheet."""
    raise NotImplementedError


def draw_sheet(name: str, panels: Any) -> Any:
    """Draw the nine panels of a sheet."""
    raise NotImplementedError


def sheet_table(panels: Any) -> Any:
    """Tabulate the nine panels of a sheet."""
    raise NotImplementedError
