"""An energy is one number whatever verb says it; a barrier is exact, or a bound that no other verb undercuts."""

import json
import math
from contextlib import suppress

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OrigamiError
from origami_nlp.pattern_problem import pose


def generic(seed):
    """A vertex of four to six creases with nothing special."""
    rng = np.random.default_rng([54, seed])
    n = 4 + seed % 3
    sectors = rng.uniform(0.7, 1.3, n)
    springs = rng.uniform(0.01, 0.05, n), rng.uniform(-2.5, 2.5, n)
    return o.Scene(o.Vertex(tuple(sectors * 2 * math.pi / sectors.sum())), *map(tuple, springs))


SCENES = {
    "miura": o.examples.miura(),
    "six": o.examples.degree6("pi/3", ratio=1.0),
    "generic": generic(1),
    **{name: name for name in ("miura:2x2", "metasheet:2x3")},
}
SHARE = 1e-9
"""Of the energy of all springs half a turn off."""


def said_of_states(stated, found):
    """Go through what verbs say of the states that are listed: verb, number, energy."""
    problem = pose(found.origami)
    again = found.from_dict(json.loads(json.dumps(found.to_dict())))
    frames = found.to_fold()["file_frames"]
    for k, m in enumerate(found.minima, start=1):
        yield "minima", k, m.energy
        yield (
            "energy of the fold angles",
            k,
            problem.energy(problem.reduce(np.array(m.fold_angles))),
        )
        yield "rows", k, found.rows[k - 1].energy
        yield "read back", k, again.minima[k - 1].energy
        titled = next(f for f in frames if f["frame_title"].startswith(f"state {k}:"))
        yield "FOLD", k, titled["origaminlp:energy"]
    for row in o.find_contacts(found).to_frame().to_dict("records"):
        yield "contacts", row["state"], row["energy_J"]
    if isinstance(stated, o.Scene):
        with suppress(OrigamiError):  # one degree of freedom has no landscape
            points = [p for p in o.find_critical_points(stated).points if p.kind == "minimum"]
            for p in points:
                near = np.abs(angles(found) - p.fold_angles).max(axis=1)
                if near.min() < 1e-6:
                    yield "critical points", int(near.argmin()) + 1, p.energy
    k = float(found.origami.stiffness[0])
    with suppress(OrigamiError):  # not of several creases of one sheet
        over = f"creases.stiffness[1]={k!r}:{1.2 * k!r}"
        for row in o.follow(stated, over, seconds=20, effort="quick").to_frame().to_dict("records"):
            phi = [row[f"phi_{c}_rad"] for c in range(1, angles(found).shape[1] + 1)]
            near = np.abs(angles(found) - phi).max(axis=1)
            if row["t"] == k and near.min() < 1e-7:
                yield "follow", int(near.argmin()) + 1, row["energy_J"]
    if found.stable:
        first = (
            o.load_path(stated, 1, state=1, seconds=20, to=1e-4).to_frame().to_dict("records")[0]
        )
        phi = [first[f"phi_{c}_rad"] for c in range(1, angles(found).shape[1] + 1)]
        near = np.abs(angles(found) - phi).max(axis=1)
        if first["t"] == 0.0 and near.min() < 1e-7:
            yield "load", int(near.argmin()) + 1, first["energy_J"]


def angles(found):
    return np.array([m.fold_angles for m in found.minima])


def said_of_leaving(found, passes):
    """Go through what verbs say of leaving a state: number, least and most that it takes."""
    energies = [m.energy for m in found.minima]
    for row in found.rows:
        if row.barrier is not None and not math.isnan(row.barrier):
            exact = row.barrier_method.startswith("exact")
            yield "minima", row.number, row.barrier if exact else -math.inf, row.barrier
    of = {np.round(m.fold_angles, 6).tobytes(): k for k, m in enumerate(found.minima, start=1)}
    number = [of[np.round(m.fold_angles, 6).tobytes()] for m in passes.result.minima]
    for k in range(1, len(number) + 1):
        mine = [p for p in passes.passes if k in (p.from_state, p.to_state)]
        tops = [p.energy - energies[number[k - 1] - 1] for p in mine]
        if not mine:
            continue
        exact = all(p.known.value == "exact" for p in mine)
        yield "barriers", number[k - 1], min(tops) if exact else -math.inf, min(tops)


@pytest.mark.parametrize("name", SCENES)
def test_no_two_verbs_differ(name):
    stated = SCENES[name]
    found = o.find_minima(stated, prove=False, seconds=60, effort="quick")
    assert found.minima
    unit = SHARE * 0.5 * math.pi**2 * float(np.sum(found.origami.stiffness))
    said = {}
    for verb, k, energy in said_of_states(stated, found):
        said.setdefault(k, {}).setdefault(verb, energy)
    for of_verbs in said.values():
        assert np.ptp([*of_verbs.values()]) <= unit, of_verbs
    assert set(said) == set(range(1, len(found.minima) + 1))
    passes = o.find_barriers(stated, found, seconds=60)
    leaving = {}
    for verb, k, least, most in said_of_leaving(found, passes):
        leaving.setdefault(k, {})[verb] = least, most
    for of_verbs in leaving.values():
        # all that are exact are equal, and no bound is below what is exact
        assert max(a for a, _ in of_verbs.values()) <= min(b for _, b in of_verbs.values()) + unit
