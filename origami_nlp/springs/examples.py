"""Targets that people want, by name."""

from __future__ import annotations

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError

EXAMPLES: dict[str, str] = {
    "waitukaitis-five": """\
# A vertex of four creases with five stable states, as many as Waitukaitis et al. found (PRL 114, 055503, 2015).
[vertex]
sector_angles_deg = [99.4, 83.5, 74.1, 103.0]

[model]
name = "five states on four creases"
symmetry = "none"

[[states]]
name = "a"
fold_angles_deg = [27.27, 101.001, -27.353, 104.22]

[[states]]
name = "b"
fold_angles_deg = [99.626, 153.537, -100.033, 169.255]

[[states]]
name = "c"
fold_angles_deg = [122.501, 155.781, -123.129, 180.0]

[[states]]
name = "d"
fold_angles_deg = [38.227, 1.016, 38.345, -1.039]

[[states]]
name = "e"
fold_angles_deg = [170.836, 53.677, 177.635, -55.0]

[springs]
stiffness = [0.01, 1.0]
""",
    "switch": """\
# Two states, and twice as much energy to leave the first as the second: exactly 20 mJ and 10 mJ.
[vertex]
sector_angles_deg = [99.4, 83.5, 74.1, 103.0]

[model]
name = "switch 1:2"
symmetry = "none"

[[states]]
name = "off"
fold_angles_deg = [27.27, 101.001, -27.353, 104.22]

[[states]]
name = "on"
fold_angles_deg = [99.626, 153.537, -100.033, 169.255]

[[barriers]]
from = "off"
to = "on"
exactly = 0.02

[[barriers]]
from = "on"
to = "off"
exactly = 0.01

[springs]
stiffness = [0.01, 1.0]
preload = true
""",
    "flat-and-one": """\
# Stable where it is flat, and in one folded state only.
[vertex]
sector_angles_deg = [99.4, 83.5, 74.1, 103.0]

[model]
name = "flat and one folded state"
symmetry = "none"

[[states]]
name = "flat"
fold_angles_deg = [0, 0, 0, 0]

[[states]]
name = "folded"
fold_angles_deg = [42.7, 124.6, -42.8, 129.7]

[springs]
stiffness = [0.005, 0.5]

[ask]
extra_states = "forbid"
""",
    "three-equal": """\
# Three states of a vertex with six creases, all of the same energy; the springs are wound.
[vertex]
sector_angles_deg = [75, 30, 75, 75, 30, 75]

[model]
name = "three states of equal depth"
symmetry = "none"

[[states]]
name = "a"
fold_angles_deg = [97, -7, 21, 64, 58, -55]

[[states]]
name = "b"
fold_angles_deg = [53, 21, 44, 14, 136, -85]
energy_above = "a"
energy_difference = 0

[[states]]
name = "c"
fold_angles_deg = [110, -95, 120, 48, 90, -47]
energy_above = "a"
energy_difference = 0

[springs]
stiffness = [0.005, 0.5]
preload = true
""",
    "monostable8": """\
# The degree-8 vertex of the paper (alpha = 45 deg), stable in one state alone.
[vertex]
sector_angles_deg = [45.0, 45.0, 45.0, 45.0, 45.0, 45.0, 45.0, 45.0]

[model]
name = "one state on eight creases"
symmetry = "D2"

[[states]]
name = "only"
fold_angles_deg = [71.1, -76.8, -22.9, -76.8, 71.1, -76.8, -22.9, -76.8]

[springs]
stiffness = [0.005, 0.5]
preload = true

[ask]
extra_states = "forbid"
rounds = 6
""",
}
"""TOML by name."""


def example_targets(name: str) -> str:
    """Return the targets of an example as TOML.

    Parameters
    ----------
    name
        One of `EXAMPLES`.

    Raises
    ------
    OptionError
        If there is none of this name.
    """
    if name not in EXAMPLES:
        raise OptionError(f"example = {shown(name)}: use one of {', '.join(EXAMPLES)}")
    return EXAMPLES[name]
