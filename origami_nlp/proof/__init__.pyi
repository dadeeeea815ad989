from .boxes import Boxes as Boxes, Remainder as Remainder, prune as prune
from .certificate import (
    Certificate as Certificate,
    Proof as Proof,
    ProofOptions as ProofOptions,
    ProvedState as ProvedState,
    Region as Region,
    certificate_from_dict as certificate_from_dict,
    read_certificate as read_certificate,
    write_certificate as write_certificate,
)
from .check import Check as Check, check_proof as check_proof
from .flat import Flat as Flat, flat_lemma as flat_lemma
from .pieces import ReducedVertex as ReducedVertex
from .proving import (
    as_sheet as as_sheet,
    certify as certify,
    pose as pose,
    prove as prove,
    prove_sheet as prove_sheet,
    why_no_contact as why_no_contact,
    why_no_sheet as why_no_sheet,
    why_not as why_not,
)
from .touches import gaps_of as gaps_of
