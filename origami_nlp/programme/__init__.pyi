from . import compiled as compiled
from .admissible import (
    broken_gap as broken_gap,
    crossed_pairs as crossed_pairs,
    is_admissible as is_admissible,
)
from .closure import fold_piece as fold_piece
from .compiled import Structure as Structure, compile_structure as compile_structure
from .contacts import (
    CLOSED as CLOSED,
    Contacts as Contacts,
    Row as Row,
    closed_contacts as closed_contacts,
    gap_weights as gap_weights,
    row_name as row_name,
    row_values as row_values,
    row_weight as row_weight,
    same_gap as same_gap,
)
from .gaps import Gap as Gap, separation_rows as separation_rows
from .model import Local as Local, Model as Model
