from .certificate import (
    Certificate as Certificate,
    certificate_from_dict as certificate_from_dict,
    certificate_to_dict as certificate_to_dict,
    read_certificate as read_certificate,
    write_certificate as write_certificate,
)
from .check import Check as Check, check_proof as check_proof
