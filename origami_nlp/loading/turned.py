"""A load path as states that can be turned: its legs with a slider over the load, both sides of its snaps."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from origami_nlp.atlas import turn_paths
from origami_nlp.loading.result import LoadedPath, LoadPath
from origami_nlp.show import (
    Body,
    Content,
    Folded,
    Panel,
    Station,
    Track,
    vertex_body,
    vertex_folded,
    vertex_track,
    vertex_view,
)

MOST_ANGLES = 24
"""Fold angles that are listed beside a state."""
Angles = Sequence[float]


def turn_path(path: LoadPath) -> Content:
    """Return the stable states of a vertex's load path, for a page that can be turned.

    Parameters
    ----------
    path
        Of `load_path`.

    Returns
    -------
    Content
        Of `turn_loaded`.
    """
    vertex, energy = path.scene.vertex, path.driver.unloaded.energy

    def folded(phi: Angles) -> Folded:
        return vertex_folded(vertex, phi, float(energy(phi)))

    def track(title: str, states: list[Angles], loads: list[float], label: str) -> Track:
        energies = [float(energy(phi)) for phi in states]
        return vertex_track(vertex, title, states, energies, parameter=loads, label=label)

    def view(phi: Angles) -> np.ndarray:
        return vertex_view(vertex, phi)

    return turn_loaded(path, vertex_body(vertex), folded, view, track)


def turn_loaded(
    path: LoadedPath,
    body: Body,
    folded: Callable[[Angles], Folded],
    view: Callable[[Angles], np.ndarray],
    track: Callable[[str, list[Angles], list[float], str], Track],
) -> Content:
    """Return the stable states of a load path, of a vertex or of a sheet, for a page that can be turned.

    Parameters
    ----------
    path
        The path.
    body
        What is folded.
    folded, view
        A state in space, and from where it is seen.
    track
        Makes a track of a title, states, their loads, and what the load is.

    Returns
    -------
    Content
        Stations: the state at load 0, and the states before and after each snap.  Tracks: the legs, over the load.  One
        panel: the load over what it works on.
    """
    driver = path.driver
    label = f"{driver.name}{f' [{driver.unit}]' * bool(driver.unit)}"
    named = [
        (f"leg {k} begins at {leg.points[0].t:.6g} {driver.unit}".rstrip(), leg.points[0].t, leg.points[0].fold_angles)
        for k, leg in enumerate(path.legs[:1], start=1)
    ]  # fmt: skip
    for k, snap in enumerate(path.snaps, start=1):
        at = f"snap {k} at {snap.t:.9g} {driver.unit}".rstrip()
        named += [(f"before {at}", snap.t, snap.before), (f"after {at}", snap.t, snap.after)]
    stations: list[Station] = []
    places: list[tuple[int, float, float]] = []
    for title, t, phi in named:
        shown = np.degrees(phi)[:MOST_ANGLES] + 0.0
        more = ", ..." if len(phi) > MOST_ANGLES else ""
        angles = ", ".join(f"{v:.3f}" for v in shown) + more
        words = (f"fold angles of creases 1..{len(phi)} [deg]: {angles}",)
        stations.append(Station(title, folded(phi), view(phi), lines=words))
        places.append((len(places), float(driver.conjugate(np.array(phi))), t))
    tracks, points = [], []
    for k, leg in enumerate(path.legs, start=1):
        if len(leg.points) < 2:
            continue
        loads = [p.t for p in leg.points]
        title = (
            f"leg {k}, {loads[0]:.6g} to {loads[-1]:.6g} {driver.unit}".rstrip()
            + f": ends with {leg.why}"
        )
        tracks.append(track(title, [p.fold_angles for p in leg.points], loads, label))
        points.append(np.array([(p.angle, p.t) for p in leg.points]))
    none = np.empty(0)
    axes = (driver.coordinate, label)
    panel = Panel("The load and what it works on", axes, none, none, None, (), tuple(places))
    steps = "Each step is a stable state under the load; energies are those without it."
    return turn_paths(path.label, body, stations, tracks, points, panel, path.told(), steps)
