from . import compiled as compiled
from .closure import fold_piece as fold_piece
from .compiled import (
    Structure as Structure,
    compile_structure as compile_structure,
    law_energy as law_energy,
)
from .contact import (
    STOP as STOP,
    Contact as Contact,
    FoldLimits as FoldLimits,
    LoopClosure as LoopClosure,
    held as held,
    openings as openings,
)
from .gaps import Gap as Gap
from .hinge_laws import HingeLaws as HingeLaws, LawChange as LawChange
from .kinematics import Kinematics as Kinematics
from .model import Local as Local, Model as Model
from .nlp import Nlp as Nlp
from .parameters import Parameters as Parameters
from .posed import Energies as Energies
from .protocol import Problem as Problem, Sparse as Sparse
from .touching import (
    MOST_LISTED as MOST_LISTED,
    ClosedContacts as ClosedContacts,
    ContactWords as ContactWords,
    closed_anyway as closed_anyway,
)
