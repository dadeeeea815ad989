"""The boxes of a proof on the surface of closed states: which argument excludes each piece, and the roots left."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.display import angle_ticks, minimum_look, pass_look
from origami_nlp.errors import OptionError
from origami_nlp.problem import FoldLimits, Model, complete
from origami_nlp.proof.boxes import strata
from origami_nlp.proof.result import Proof
from origami_nlp.proof.tree import NodeKind, Tree

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OUTSIDE, BALANCE, REMOVED, ROOT, OPEN = range(5)
WORDS = {
    OUTSIDE: ("no closed state within the limits", "#ffffff"),
    BALANCE: ("excluded: no moment balances the torques (a minor is not zero)", "#9ecae1"),
    REMOVED: ("excluded: closure and balance together have no solution", "#fdd49e"),
    ROOT: ("in the box of one certified root", "#d7301f"),
    OPEN: ("left open", "#54278f"),
}
"""What a closed state is to the proof: words and colour, of different lightness."""
MARKS: dict[tuple[bool, bool], tuple[str, dict[str, Any]]] = {
    (False, True): ("minimum", minimum_look("interior", None, 16.0)),
    (False, False): ("saddle or maximum", pass_look("saddle", 15.0)),
    (True, True): (
        "minimum with creases at their limits",
        minimum_look("contact-pinned", None, 13.0),
    ),
    (True, False): ("critical only with creases held there", pass_look("corner", 12.0)),
}
"""Words and marker of a critical point: whether a variable is at its limit, whether it is a minimum."""
MEANING = {
    NodeKind.MINOR: BALANCE,
    NodeKind.TWIN: BALANCE,
    NodeKind.NARROW: REMOVED,
    NodeKind.NONE: REMOVED,
    NodeKind.ROOT: ROOT,
    NodeKind.FLAT: ROOT,
}
"""Other leaves leave a closed state open."""


def locate(
    tree: Tree, stratum: tuple[int, ...], x: np.ndarray, limits: FoldLimits | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Find where the tree of a proof deals with states.

    Parameters
    ----------
    tree
        Of a proof that was recorded.
    stratum
        +1 or -1 for a pinned variable, 0 for a free one, [n].
    x
        States of it, shape [K, n] [rad].
    limits
        Fold limits of the scene; +-pi by default.

    Returns
    -------
    node : numpy.ndarray
        Position in the tree of the leaf that holds each, or of the contraction that removed it, [K].
    kind : numpy.ndarray
        Its `NodeKind`, [K].
    """
    n = len(stratum)
    wanted = list(itertools.product((0, 1, -1), repeat=n)).index(tuple(stratum))
    where = np.full(len(x), -1)
    everything, none = np.arange(len(x)), np.arange(0)
    whole = strata(n, limits)[wanted : wanted + 1]
    low, high = whole.lower[:, 0], whole.upper[:, 0]
    waiting: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    number = -1
    for node, (kind, data) in enumerate(zip(tree.kind.tolist(), tree.data.tolist(), strict=True)):
        if not waiting:
            number += 1
            if number > wanted:
                break
            waiting.append((everything if number == wanted else none, low, high))
        held, a, b = waiting.pop()
        where[held] = node
        if kind == NodeKind.SPLIT:
            middle = 0.5 * (a[data] + b[data])
            first, second = b.copy(), a.copy()
            first[data] = second[data] = middle
            below = x[held, data] <= middle
            waiting += [(held[~below], second, b), (held[below], a, first)]
        elif kind in (NodeKind.CONTRACT, NodeKind.NARROW):
            a, b = tree.lower[data], tree.upper[data]
            inside = ((x[held] >= a) & (x[held] <= b)).all(axis=1)
            waiting.append((held[inside], a, b))
    return where, tree.kind[where]


def draw_proof(
    model: Model, proof: Proof, pair: tuple[int, int] = (0, 1), size: int = 500
) -> Figure:
    """Draw the closed states of a scene with two degrees of freedom, cut into the boxes of its proof.

    Two of the variables are the axes; closure gives the others, in up to two ways: a panel each.

    Parameters
    ----------
    model
        The scene.
    proof
        Of it, recorded.
    pair
        Positions of the variables along x and y.
    size
        Points along each.

    Returns
    -------
    matplotlib.figure.Figure
        With all critical points; those with variables at their limits lie on the rim of the surface.

    Raises
    ------
    OptionError
        If the proof was not recorded, or the scene has not two degrees of freedom.
    """
    from matplotlib.figure import Figure

    if proof.tree is None:
        raise OptionError("the proof has no tree: prove(model, record=True) keeps it")
    if model.dof != 2:
        raise OptionError(f"the scene has {model.dof} degrees of freedom: draw_proof is for two")
    figure = Figure(figsize=(9.6, 6.4), dpi=110, layout="compressed")
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    branches, there = _closed(model, pair, size)
    shown = set()
    for ax, x, exists, title in zip(
        axes, branches, there, ("one way to close", "the other way to close"), strict=True
    ):
        shown |= _draw(ax, proof.tree, x, exists, model.fold_limits, size)
        ax.set(title=title, aspect="equal", xlabel=rf"fold angle $\phi_{{{pair[0] + 1}}}$")
        angle_ticks(ax.xaxis, -math.pi, math.pi)
        angle_ticks(ax.yaxis, -math.pi, math.pi)
    for p in sorted(proof.points, key=lambda p: (not any(p.stratum), bool(p.is_minimum))):
        apart = [
            _distance(branch, e, p.x, pair, size) for branch, e in zip(branches, there, strict=True)
        ]
        style = MARKS[any(p.stratum), bool(p.is_minimum)][1]
        axes[int(np.argmin(apart))].plot(
            p.x[pair[0]], p.x[pair[1]], zorder=5, clip_on=False, **style
        )
    axes[0].set_ylabel(rf"fold angle $\phi_{{{pair[1] + 1}}}$")
    _legend(figure, sorted(shown))
    return figure


def _closed(model: Model, pair: tuple[int, int], size: int) -> tuple[np.ndarray, np.ndarray]:
    """Close states over a grid of two variables: two ways [2, K, n], and which exist [2, K]."""
    step = np.linspace(-math.pi, math.pi, size + 2)[1:-1]
    x = np.zeros((size * size, model.size))
    x[:, pair[0]], x[:, pair[1]] = np.tile(step, size), np.repeat(step, size)
    solve = np.array([v for v in range(model.size) if v not in pair])
    states, exists = complete(model, x, np.tile(solve, (len(x), 1)))
    exists &= model.fold_limits.inside(states).all(axis=2)
    return states.swapaxes(0, 1), exists.T


def _distance(
    branch: np.ndarray, exists: np.ndarray, x: tuple[float, ...], pair: tuple[int, int], size: int
) -> float:
    """Return how far the nearest state of a branch, of those next to x in the picture, is from x."""
    near = exists & (
        np.abs(branch[:, pair] - np.array(x)[list(pair)]).max(axis=1) < 8 * math.pi / size
    )
    return float(np.abs(branch[near] - x).max(axis=1).min()) if near.any() else math.inf


def _draw(
    ax: Any, tree: Tree, x: np.ndarray, exists: np.ndarray, limits: FoldLimits, size: int
) -> set[int]:
    """Colour the states of one branch, with lines where boxes meet; return which meanings there are."""
    from matplotlib.colors import ListedColormap

    meaning, node = np.zeros(len(x), dtype=int), np.full(len(x), -1)
    where, kinds = locate(tree, (0,) * x.shape[1], x[exists], limits)
    node[exists] = where
    meaning[exists] = [MEANING.get(NodeKind(k), OPEN) for k in kinds]
    picture, nodes = meaning.reshape(size, size), node.reshape(size, size)
    edge = np.zeros((size, size), dtype=bool)
    edge[:, 1:] |= nodes[:, 1:] != nodes[:, :-1]
    edge[1:] |= nodes[1:] != nodes[:-1]
    extent = (-math.pi, math.pi, -math.pi, math.pi)
    colours = ListedColormap([colour for _, colour in WORDS.values()])
    options = {"origin": "lower", "extent": extent, "interpolation": "nearest"}
    ax.imshow(picture, cmap=colours, vmin=-0.5, vmax=len(WORDS) - 0.5, **options)
    lines = np.zeros((size, size, 4))
    lines[edge] = (0.2, 0.2, 0.2, 0.55)
    ax.imshow(lines, **options)
    return set(np.unique(meaning).tolist())


def _legend(figure: Figure, shown: list[int]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        Patch(facecolor=WORDS[m][1], edgecolor="#555555", label=WORDS[m][0]) for m in shown
    ]
    handles += [Line2D([], [], label=words, **style) for words, style in MARKS.values()]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
