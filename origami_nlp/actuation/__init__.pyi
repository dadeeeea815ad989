from .driving import DrivenSet as DrivenSet, driven_set as driven_set, signed_set as signed_set
from .figure import draw_actuation as draw_actuation
from .find import actuate as actuate
from .result import (
    Actuation as Actuation,
    FlatBranch as FlatBranch,
    StateTransition as StateTransition,
)
