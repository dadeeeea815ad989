"""origami_nlp: energy minima of an origami vertex, classified, and which of them are stable.

The public face: state a `Scene`, then `find_minima(scene)`.  CasADi, matplotlib and SymPy load only
when something asks for them, so that this import stays fast.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from origami_nlp.errors import OrigamiError
from origami_nlp.pattern import (
    Scene,
    Vertex,
    examples,
    format_scene,
    parse_scene,
    read_fold_scene,
    read_scene,
)

if TYPE_CHECKING:
    from origami_nlp.folding import examine
    from origami_nlp.minima import MinimaResult, Minimum, draw_minima, find_minima
    from origami_nlp.programme import Model


_LAZY = {
    "find_minima": "origami_nlp.minima.find",
    "Minimum": "origami_nlp.minima.find",
    "MinimaResult": "origami_nlp.minima.find",
    "examine": "origami_nlp.folding.embedding",
    "Model": "origami_nlp.programme.model",
    "draw_minima": "origami_nlp.minima.figure",
}

__all__ = [
    "MinimaResult",
    "Minimum",
    "Model",
    "OrigamiError",
    "Scene",
    "Vertex",
    "draw_minima",
    "examine",
    "examples",
    "find_minima",
    "format_scene",
    "parse_scene",
    "read_fold_scene",
    "read_scene",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(import_module(_LAZY[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
