from .entry import app as app
from .start import main as main
