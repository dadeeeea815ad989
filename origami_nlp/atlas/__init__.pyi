from .family import (
    Family as Family,
    Over as Over,
    family_of as family_of,
    parse_over as parse_over,
)
from .find import follow as follow, follow_family as follow_family
from .result import (
    Atlas as Atlas,
    PathBranch as PathBranch,
    PathEvent as PathEvent,
    PathPoint as PathPoint,
    StateAt as StateAt,
)
