"""What a state adds to the Euler characteristic, counted on its sampled link."""

from __future__ import annotations

import numpy as np

from origami_nlp.critical.link import RADII, Link, link_of
from origami_nlp.critical.result import Kind
from origami_nlp.kkt import State
from origami_nlp.numerics import RISES
from origami_nlp.problem import Parameters


def links_of(state: State, doubts: list[str]) -> tuple[Link, ...]:
    """Sample the links of a state, or record why they are not known."""
    try:
        return tuple(link_of(state, radius) for radius in RADII)
    except ValueError as error:
        doubts.append(f"the link of {in_degrees(state.x)} is not known: {error}")
        return ()


def count_links(
    hinges: Parameters, links: tuple[Link, ...], doubts: list[str]
) -> tuple[None, int, Kind, str]:
    """Return (no index, contribution, kind, how) from the links of a state at several radii, under other hinges."""
    if not links:
        return None, 0, "undecided", "link not known"
    counts = [link.lower(hinges) for link in links]
    chi, empty, whole = counts[-1]
    # 1 for a minimum (chi 0), -1 for a saddle (two lower arcs), 1 for a maximum (a whole circle has chi 0), 0 for
    # regular
    contribution = 1 - chi
    radii = " and ".join(f"{link.radius:g}" for link in links)
    how = f"sampled link at radii {radii} rad"
    if len(set(counts)) > 1:
        doubts.append(f"links of {in_degrees(links[0].center)} disagree between radii {radii}")
    elif links[-1].pieces == 0:
        how = "the link is empty"
    elif _first_order(links, hinges):
        how = "first order: slopes of U along the link"
    if empty:
        return None, contribution, "minimum", how
    if contribution == 0:
        return None, 0, "regular", how
    if contribution < 0:
        return None, contribution, "saddle", how
    return None, contribution, "maximum" if whole else "pinch", how


def _first_order(links: tuple[Link, ...], hinges: Parameters) -> bool:
    """Return whether slopes of U alone decide: firm at the ends of every arc, and with the same lower link."""
    for link in links:
        pull = hinges.torque(link.center)
        firm = RISES * float(np.linalg.norm(pull))
        for circle in link.circles:
            # where the slope decides, the sign of U - U(p) on the link is that of its part of first order in the radius
            slope = (circle.x - link.center) @ pull / link.radius
            change = hinges.energy_change(link.center, circle.x)
            ends = circle.inside & ~(np.roll(circle.inside, 1) & np.roll(circle.inside, -1))
            if (np.abs(slope[ends]) <= firm).any() or np.abs(slope).max() <= firm:
                return False
            if (np.diff(np.sign(slope[circle.inside])) != 0).sum() != (
                np.diff(np.sign(change[circle.inside])) != 0
            ).sum():
                return False
    return True


def shape_of(link: Link) -> str:
    """Describe what the link of a singular state is."""
    if link.pieces == 0:
        return "isolated state"
    parts = []
    full = sum(bool(c.inside.all()) for c in link.circles)
    arcs = link.pieces - full - link.thin
    for count, one in ((full, "circle"), (arcs, "arc"), (link.thin, "point")):
        if count:
            parts.append(f"{count} {one}{'s' * (count > 1)}")
    return "link: " + ", ".join(parts)


def in_degrees(x: np.ndarray) -> str:
    """Write the fold angles of the model's variables in degrees, for a doubt."""
    return "(" + ", ".join(f"{v:.3f}" for v in np.degrees(x)) + ") deg"
