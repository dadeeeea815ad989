"""From a proof, as it was found, to the certificate that is written."""

from __future__ import annotations

from typing import cast

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model
from origami_nlp.proof import certificate as c
from origami_nlp.proof.options import ProofOptions
from origami_nlp.proof.result import Cluster, Proof, ProvedCriticalPoint
from origami_nlp.proof.touches import prove


def certificate_of_scene(scene: Scene, boxes: int) -> c.Certificate:
    """Prove the list of a scene, of each winding, and return the proof in the form that is written to a file.

    Parameters
    ----------
    scene
        The scene.
    boxes
        That a proof may take.

    Returns
    -------
    Certificate
        Of all windings.
    """
    models = [Model(one) for one in scene.of_each_winding]
    return certificate_of(scene, *(prove(m, options=ProofOptions(boxes=boxes)) for m in models))


def certificate_of(scene: Scene, proof: Proof, *others: Proof) -> c.Certificate:
    """Return a proof with its scene, in the form that is written to a file.

    Parameters
    ----------
    scene
        What was proved.
    proof, *others
        One for each of `Scene.of_each_winding`, in their order.

    Returns
    -------
    Certificate
        All that is claimed.

    Raises
    ------
    OptionError
        If facets may touch: a certificate names no touches.
    """
    check_type("scene", scene, Scene)
    check_type("proof", proof, Proof)
    if scene.contact == "full":
        raise OptionError(
            "a certificate names no touches of facets: it is for contact = 'fold-limits'"
        )
    return c.Certificate(
        scene,
        proof.flat_radius,
        tuple(map(_point, proof.points)),
        tuple(map(_left, proof.singular)),
        tuple(map(_left, proof.undecided)),
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
