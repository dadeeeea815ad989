"""A load path as states that can be turned: its legs with a slider over the load, both sides of its snaps."""

from __future__ import annotations

import numpy as np

from origami_nlp.display import Content, Keyframe, Panel, Poser
from origami_nlp.paths.interactive import view_paths
from origami_nlp.paths.load_result import LoadPath

MOST_ANGLES = 24
"""Fold angles that are listed beside a state."""


def view_path(path: LoadPath) -> Content:
    """Return the stable states of a load path, of a vertex or of a pattern, for a page that can be turned.

    Parameters
    ----------
    path
        Of `load_path`.

    Returns
    -------
    Content
        Stations: the state at load 0, and the states before and after each snap.  Tracks: the legs, over the load.  One
        panel: the load over what it works on.
    """
    driver, unit = path.driver, path.driver.unit
    poser, energy = Poser(driver.unloaded), driver.unloaded.energy
    label = f"{driver.name}{path.in_unit}"
    first = path.legs[0].points[0]
    named = [(f"leg 1 begins at {first.t:.6g} {unit}", first.t, first.fold_angles)]
    for k, snap in enumerate(path.snaps, start=1):
        at = f"snap {k} at {snap.t:.9g} {unit}"
        named += [(f"before {at}", snap.t, snap.before), (f"after {at}", snap.t, snap.after)]
    stations: list[Keyframe] = []
    places: list[tuple[int, float, float]] = []
    for k, (title, t, phi) in enumerate(named):
        angles = ", ".join(f"{v:.3f}" for v in np.degrees(phi)[:MOST_ANGLES] + 0.0)
        more = ", ..." if len(phi) > MOST_ANGLES else ""
        words = (f"fold angles of creases 1..{len(phi)} [deg]: {angles}{more}",)
        folded = poser.folded(phi, float(energy(phi)))
        stations.append(Keyframe(title.rstrip(), folded, poser.view(phi), lines=words))
        places.append((k, float(driver.conjugate(np.array(phi))), t))
    tracks, points = [], []
    for k, leg in enumerate(path.legs, start=1):
        if len(leg.points) < 2:
            continue
        loads = [p.t for p in leg.points]
        title = f"leg {k}, {leg.span} {unit}".rstrip()
        states = np.array([p.fold_angles for p in leg.points])
        title += f": ends with {leg.why}"
        tracks.append(poser.track(title, states, energy(states), parameter=loads, label=label))
        points.append(np.array([(p.angle, p.t) for p in leg.points]))
    none = np.empty(0)
    axes = (driver.coordinate, label)
    panel = Panel("The load and what it works on", axes, none, none, None, (), tuple(places))
    steps = "Each step is a stable state under the load; energies are those without it."
    return view_paths(
        path.label, poser.body, stations, tracks, points, panel, path.report_sections(), steps
    )
