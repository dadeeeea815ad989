"""All minima of a mesh whose vertices fold flat, with cycles or without, within fold limits (`mesh_states`).

The closed states are finitely many products of curves, and the energy is a sum over curves: a state is a minimum if it
is one along every curve of every product that it lies in.  Those products are known from which creases are 0, at +-180
degrees or neither, vertex by vertex.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern, laid_flat
from origami_nlp.proof.flat_sheets import SheetProof
from origami_nlp.proof.mesh_certificate import MeshCertificate
from origami_nlp.proof.mesh_minima import MeshMinima
from origami_nlp.proof.mesh_states import (
    MOST_MODES,
    as_folding_mesh,
    why_no_mesh,
)
from origami_nlp.proof.rows import UNIT
from origami_nlp.proof.sheet_certificate import CertifiedState, OpenInterval, stated_sheet


@dataclass(frozen=True, kw_only=True)
class MeshProof(SheetProof):
    """What is proved of a mesh whose vertices fold flat: all closed states are products of curves.

    Attributes
    ----------
    products
        Which curves, with all other creases at 0 or +-180 degrees.
    isolated
        How many of these products are of states alone: no curve is in them.
    together
        Curves of one product, at most.
    """

    products: int
    isolated: int
    together: int

    @property
    def states(self) -> str:
        """Where all closed states are, in words."""
        return (
            f"are {self.products} products of {self.curves} curves, along which "
            f"tangents of half the fold angles are proportional ({self.together} of a product at most; "
            f"{self.isolated} products are of flat and flat-folded states alone)"
        )

    meant = "of the sheet whose vertices fold flat and whose equal sectors are equal exactly"


def prove_mesh(
    pattern: Pattern,
    *,
    boxes: int = 1_000_000,
    until: float = math.inf,
    modes: int = MOST_MODES,
) -> MeshProof:
    """Find every minimum of the energy of a mesh of vertices that fold flat, within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Flat vertices of degree four, opposite sectors of each summing to 180 degrees; in any order, with cycles.
    boxes
        At most so many boxes of theta; what is left is undecided.
    until
        Stop then (`time.monotonic`).
    modes
        Ways to fold all vertices, each by itself, that are gone through at most.

    Returns
    -------
    MeshProof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such mesh: `why_no_mesh` says why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import prove_mesh
    >>> proof = prove_mesh(o.examples.pattern("miura", 2, 3))
    >>> proof.curves, len(proof.minima), proof.undecided
    (6, 14, ())
    """
    pattern.check_plain_hinges("a proof")
    mesh, why = as_folding_mesh(pattern, modes)
    if mesh is None:
        raise OptionError(
            f"pattern = {pattern.title}: no mesh that can be proved: {why or why_no_mesh(pattern)}"
        )
    started = time.process_time()
    search = MeshMinima(mesh, laid_flat(pattern), boxes, until)
    search.run()
    return MeshProof(
        curves=len({c for f in search.products for c in f.curves}),
        minima=tuple(search.minima),
        maxima=search.maxima,
        undecided=tuple(search.open),
        deviation=mesh.deviation + 4 * UNIT,
        moved=mesh.moved,
        boxes=search.boxes,
        seconds=time.process_time() - started,
        products=len(search.products),
        isolated=sum(not f.curves for f in search.products),
        together=max((len(f.curves) for f in search.products), default=0),
    )


def certificate_of_mesh(
    pattern: Pattern, proof: SheetProof, *, generic: bool = False
) -> MeshCertificate:
    """Return the proof of a mesh in the form that is written to a file and checked.

    Parameters
    ----------
    pattern
        The mesh.
    proof
        Of it.
    generic
        Whether it is one of vertices that need not fold flat (`prove_quad_mesh`).

    Returns
    -------
    MeshCertificate
        All that is claimed.

    Raises
    ------
    OptionError
        If a facet is of several pieces, or there are stops or hinge laws: the check knows none.
    """
    pattern.check_plain_hinges("the certificate of a mesh")
    if proof.contact:
        raise OptionError("the certificate of a mesh: within fold limits only")
    return MeshCertificate(
        **stated_sheet(pattern),
        deviation=proof.deviation,
        minima=tuple(CertifiedState(tuple(m.fold_angles.tolist()), m.radius) for m in proof.minima),
        undecided=tuple(
            OpenInterval(tuple(low.tolist()), tuple(high.tolist()), why)
            for low, high, why in proof.undecided
        ),
        generic=generic,
    )
