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
from .complete import pose as pose
from .flat import Flat as Flat, flat_lemma as flat_lemma
from .result import Cluster as Cluster, CriticalPoint as CriticalPoint, Proof as Proof
from .touches import prove as prove
from .tree import Kind as Kind, Recorder as Recorder, Tree as Tree
