from .affine import (
    Affine as Affine,
    Turn as Turn,
    constant as constant,
    dot as dot,
    mixed as mixed,
    turn_of as turn_of,
    turned as turned,
    variables as variables,
)
from .certificate import (
    Certificate as Certificate,
    certificate_from_dict as certificate_from_dict,
    certificate_to_dict as certificate_to_dict,
    read_certificate as read_certificate,
    write_certificate as write_certificate,
)
from .chains import Rows as Rows, Vertex as Vertex
from .check import Check as Check, check_proof as check_proof
