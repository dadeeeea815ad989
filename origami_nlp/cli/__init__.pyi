from . import options as options, progress as progress, search as search
from .entry import app as app
from .group import Group as Group
from .output import Output as Output, writes as writes
from .source import Source as Source, takes_scene as takes_scene
from .start import main as main
