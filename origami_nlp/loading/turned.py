"""A load path as states that can be turned: its legs with a slider over the load, both sides of its snaps."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from origami_nlp.loading.driver import Driver
from origami_nlp.loading.records import Leg, Snap
from origami_nlp.show import (
    Content,
    Line,
    Panel,
    Piece,
    Station,
    vertex_body,
    vertex_folded,
    vertex_track,
    vertex_view,
)


def turn_path(
    driver: Driver, legs: Sequence[Leg], snaps: Sequence[Snap], told: Iterable[Piece]
) -> Content:
    """Return the stable states of a load path, for a page that can be turned.

    Parameters
    ----------
    driver, legs, snaps
        Of a `LoadPath`.
    told
        Its report.

    Returns
    -------
    Content
        Stations: the state at load 0, and the states before and after each snap.  Tracks: the legs, over the load.  One
        panel: the load over what it works on.
    """
    vertex = driver.scene.vertex
    label = f"{driver.name}{f' [{driver.unit}]' * bool(driver.unit)}"
    named = [
        (f"leg {k} begins at {leg.points[0].t:.6g} {driver.unit}".rstrip(), leg.points[0].t, leg.points[0].fold_angles)
        for k, leg in enumerate(legs[:1], start=1)
    ]  # fmt: skip
    for k, snap in enumerate(snaps, start=1):
        at = f"snap {k} at {snap.t:.9g} {driver.unit}".rstrip()
        named += [(f"before {at}", snap.t, snap.before), (f"after {at}", snap.t, snap.after)]
    stations: list[Station] = []
    places: list[tuple[int, float, float]] = []
    for title, t, phi in named:
        energy = float(driver.unloaded.energy(phi))
        angles = ", ".join(f"{v:.3f}" for v in np.degrees(phi) + 0.0)
        words = (f"fold angles of creases 1..{len(phi)} [deg]: {angles}",)
        view = vertex_view(vertex, phi)
        stations.append(Station(title, vertex_folded(vertex, phi, energy), view, lines=words))
        places.append((len(places), float(driver.conjugate(np.array(phi))), t))
    tracks, points = [], []
    for k, leg in enumerate(legs, start=1):
        if len(leg.points) < 2:
            continue
        loads = [p.t for p in leg.points]
        title = (
            f"leg {k}, {loads[0]:.6g} to {loads[-1]:.6g} {driver.unit}".rstrip()
            + f": ends with {leg.why}"
        )
        states = [p.fold_angles for p in leg.points]
        energies = [p.energy for p in leg.points]
        tracks.append(vertex_track(vertex, title, states, energies, parameter=loads, label=label))
        points.append(np.array([(p.angle, p.t) for p in leg.points]))
    lines = tuple(Line(p, t.title, "curve") for p, t in zip(points, tracks, strict=True))
    none = np.empty(0)
    axes = (driver.coordinate, label)
    panel = Panel("The load and what it works on", axes, none, none, None, lines, tuple(places))
    content = Content(
        driver.scene.label or repr(vertex),
        vertex_body(vertex),
        tuple(stations),
        panels=(panel,),
        pieces=tuple(told),
        note="" if tracks else "No leg was followed.",
        steps="Each step is a stable state under the load; energies are those without it.",
    )
    return content.with_tracks(tracks, [points])
