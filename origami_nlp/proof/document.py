"""From a proof, as it was found, to the certificate that others can check."""

from __future__ import annotations

from typing import cast

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene
from origami_nlp.proof import certificate as c
from origami_nlp.proof.result import Cluster, Proof, ProvedCriticalPoint
from origami_nlp.proof.tree import NodeKind, Tree

NAMES = {
    NodeKind.SPLIT: c.SPLIT,
    NodeKind.CONTRACT: c.CONTRACT,
    NodeKind.NARROW: c.NARROW,
    NodeKind.CLOSED: c.CLOSED,
    NodeKind.EMPTY: c.CLOSED,
    NodeKind.NONE: c.NONE,
    NodeKind.MINOR: c.MINOR,
    NodeKind.TWIN: c.TWIN,
    NodeKind.FLAT: c.FLAT,
    NodeKind.ROOT: c.ROOT,
    NodeKind.SINGULAR: c.SINGULAR,
    NodeKind.UNDECIDED: c.UNDECIDED,
}
"""Kinds of nodes, as certificates count them."""


def certificate_of(scene: Scene, proof: Proof, *others: Proof) -> c.Certificate:
    """Return a proof with its scene, in the form that is written to a file and checked.

    Parameters
    ----------
    scene
        What was proved.
    proof, *others
        With their trees: one for each of `Scene.of_each_winding`, in their order.

    Returns
    -------
    Certificate
        All that is claimed.

    Raises
    ------
    OptionError
        If a tree was not recorded.
    """
    check_type("scene", scene, Scene)
    check_type("proof", proof, Proof)
    if proof.tree is None:
        raise OptionError("the proof has no tree: find it with record=True")
    return c.Certificate(
        scene,
        proof.flat_radius,
        tuple(map(_point, proof.points)),
        tuple(map(_left, proof.singular)),
        tuple(map(_left, proof.undecided)),
        _nodes(proof.tree, None if proof.flat_radius else len(proof.undecided) - 1),
        tuple(map(certificate_of, scene.of_each_winding[1:], others)),
    )


def _point(p: ProvedCriticalPoint) -> c.CertifiedPoint:
    return c.CertifiedPoint(
        **{
            name: getattr(p, name) for name in c.CertifiedPoint.__dataclass_fields__
        }  # all by the same names
    )


def _left(cluster: Cluster) -> c.UndecidedBox:
    signs = cast("tuple[c.Sign, ...]", cluster.stratum)
    return c.UndecidedBox(cluster.lower, cluster.upper, signs, cluster.reason)


def _nodes(tree: Tree, near_flat: int | None) -> c.Nodes:
    """Return the tree with kinds as in `c.KINDS`; leaves near a flat state of no lemma rest on an undecided box."""
    kind = np.zeros_like(tree.kind)
    number = tree.data.astype(np.int32)
    size = tree.lower.shape[1]
    for ours, theirs in NAMES.items():
        kind[tree.kind == ours] = theirs
    rows = {
        c.MINOR: [sum(1 << i for i in four) for four in tree.minors],
        c.TWIN: [pair[0] * size + pair[-1] for pair in tree.twins],
    }
    for which, values in rows.items():
        own = kind == which
        if own.any():
            number[own] = np.array(values, np.int32)[number[own]]
    if near_flat is not None:
        flat = kind == c.FLAT
        kind[flat], number[flat] = c.UNDECIDED, near_flat
    return c.Nodes(kind, number, np.stack([tree.lower, tree.upper], axis=1))
