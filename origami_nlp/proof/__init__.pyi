from .boxes import Boxes as Boxes, Remainder as Remainder, prune as prune
from .certificate import (
    Certificate as Certificate,
    certificate_from_dict as certificate_from_dict,
    certify as certify,
    read_certificate as read_certificate,
    write_certificate as write_certificate,
)
from .check import Check as Check, check_proof as check_proof
from .complete import pose as pose, prove as prove, prove_each as prove_each, why_not as why_not
from .flat import Flat as Flat, flat_lemma as flat_lemma
from .reduced import ReducedVertex as ReducedVertex
from .result import (
    Proof as Proof,
    ProofOptions as ProofOptions,
    ProvedState as ProvedState,
    Region as Region,
)
from .sheet_proof import (
    as_sheet as as_sheet,
    prove_sheet as prove_sheet,
    why_no_contact as why_no_contact,
    why_no_sheet as why_no_sheet,
)
