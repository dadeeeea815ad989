from .lines import ERROR_KEY as ERROR_KEY, DrawingOptions as DrawingOptions, Lines as Lines
from .reading import (
    READERS as READERS,
    drawing_kind as drawing_kind,
    drawing_to_fold as drawing_to_fold,
    read_drawing as read_drawing,
)
from .sheet import Drawing as Drawing, half_edges as half_edges
from .writing import (
    WRITTEN as WRITTEN,
    write_drawing as write_drawing,
)
