"""Where `symbolic/` is in a checkout: beside the package.  An installed package has the folder itself in this place."""

from pathlib import Path

__path__ = [str(Path(__file__).parents[1] / "symbolic")]
