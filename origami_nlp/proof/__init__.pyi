from .boxes import Boxes as Boxes, Remainder as Remainder, prune as prune
from .certificate import (
    Certificate as Certificate,
    certificate_from_dict as certificate_from_dict,
    certificate_to_dict as certificate_to_dict,
    read_certificate as read_certificate,
    write_certificate as write_certificate,
)
from .check import Check as Check, check_proof as check_proof
from .complete import pose as pose
from .curve_contact import why_no_contact as why_no_contact
from .document import (
    certificate_of as certificate_of,
    certificate_of_scene as certificate_of_scene,
)
from .flat import Flat as Flat, flat_lemma as flat_lemma
from .flat_sheets import SheetMinimum as SheetMinimum, SheetProof as SheetProof
from .mesh_certificate import (
    MeshCertificate as MeshCertificate,
    mesh_from_dict as mesh_from_dict,
    mesh_to_dict as mesh_to_dict,
)
from .mesh_states import why_no_mesh as why_no_mesh
from .meshes import (
    MeshProof as MeshProof,
    certificate_of_mesh as certificate_of_mesh,
    prove_mesh as prove_mesh,
)
from .options import ProofOptions as ProofOptions
from .pieces import VanishingRows as VanishingRows
from .quad_meshes import QuadProof as QuadProof, prove_quad_mesh as prove_quad_mesh
from .quad_sheets import why_no_quad_mesh as why_no_quad_mesh
from .result import Cluster as Cluster, Proof as Proof, ProvedCriticalPoint as ProvedCriticalPoint
from .touches import prove as prove, why_not as why_not
