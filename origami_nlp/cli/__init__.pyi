from . import options as options, progress as progress, states as states
from .entry import app as app
from .exits import Ended as Ended
from .group import Group as Group, writes as writes
from .output import Output as Output
from .source import Source as Source
from .start import main as main
