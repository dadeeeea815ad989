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
from .chains import Rows as Rows, Vertex as Vertex
