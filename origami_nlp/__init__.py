"""origami_nlp: energy minima of an origami vertex, classified, and which of them are stable.

The public face: state a `Scene`, then `find_minima(scene)`.  CasADi, matplotlib and SymPy load only
when something asks for them, so that this import stays fast.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from origami_nlp.errors import OrigamiError
from origami_nlp.state import examples
from origami_nlp.state.scene import Scene
from origami_nlp.state.scene_file import format_scene, parse_scene, read_scene
from origami_nlp.state.vertex import Vertex

if TYPE_CHECKING:
    from origami_nlp.judge.minima import MinimaResult, Minimum, find_minima
    from origami_nlp.model.embedding import examine
    from origami_nlp.model.nlp import Model
    from origami_nlp.tell.figure import draw_minima

__version__ = "0.1.0"

_LAZY = {
    "find_minima": "origami_nlp.judge.minima",
    "Minimum": "origami_nlp.judge.minima",
    "MinimaResult": "origami_nlp.judge.minima",
    "examine": "origami_nlp.model.embedding",
    "Model": "origami_nlp.model.nlp",
    "draw_minima": "origami_nlp.tell.figure",
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
    "read_scene",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(import_module(_LAZY[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
