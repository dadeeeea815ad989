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
from .boxes import Boxes as Boxes, Left as Left, prune as prune
from .chains import Rows as Rows
from .complete import pose as pose, prove as prove
from .figure import draw_proof as draw_proof, locate as locate
from .flat import Flat as Flat, flat_lemma as flat_lemma
from .result import Cluster as Cluster, CriticalPoint as CriticalPoint, Proof as Proof
from .singular import Isolation as Isolation, isolated as isolated
from .tree import Kind as Kind, Recorder as Recorder, Tree as Tree
