from .contact import (
    STOP as STOP,
    Contact as Contact,
    FoldLimits as FoldLimits,
    Local as Local,
    LoopClosure as LoopClosure,
    held as held,
    openings as openings,
)
from .hinge_laws import HingeLaws as HingeLaws
from .nlp import Nlp as Nlp
from .parameters import Energies as Energies, Parameters as Parameters
from .protocol import Problem as Problem
from .touching import (
    MOST_LISTED as MOST_LISTED,
    ClosedContacts as ClosedContacts,
    ContactWords as ContactWords,
)
