from .run import run_sweep as run_sweep
from .spec import Sweep as Sweep, parse_sweep as parse_sweep, read_sweep as read_sweep
from .store import load_states as load_states, load_sweep as load_sweep
