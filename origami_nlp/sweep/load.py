"""Results of a sweep as pandas or xarray objects (extra ``sweep``)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.arguments import require
from origami_nlp.errors import OrigamiError, SweepError
from origami_nlp.sweep.store import read_table

if TYPE_CHECKING:
    import pandas
    import xarray

KINDS = ("interior", "contact-pinned", "contact-touching", "degenerate")


def load_states(folder: str | Path) -> pandas.DataFrame:
    """Read the states of a sweep (extra ``sweep``).

    Parameters
    ----------
    folder
        Of `run_sweep`.

    Returns
    -------
    pandas.DataFrame
        One row a minimum: the parameters of its scene, energy_J, kind, residuals, phi_1_rad .. phi_N_rad.

    Raises
    ------
    SweepError
        If pandas is not installed, or the folder holds no sweep.
    """
    pandas = require("pandas", "reading a sweep", "sweep", SweepError)
    with _readable(folder):
        scenes, states = (
            pandas.DataFrame(rows, columns=names)
            for names, rows in (read_table(folder, table) for table in ("scenes", "states"))
        )
        states = states.rename(columns={"energy": "energy_J"})
        angles = pandas.DataFrame([json.loads(a) for a in states.pop("fold_angles")], dtype=float)
        angles.columns = [f"phi_{i + 1}_rad" for i in angles.columns]
        own = ["status", "reason", "seconds", "starts", "expected_undiscovered"]
        return scenes.drop(columns=own).merge(states.join(angles), on="scene")


def load_sweep(folder: str | Path) -> xarray.Dataset:
    """Read counts and lowest energies of a sweep, labelled (extra ``sweep``).

    Parameters
    ----------
    folder
        Of `run_sweep`.

    Returns
    -------
    xarray.Dataset
        Over the axes of the sweep: ``count`` (minima), ``count_<kind>``, ``count_stable`` and ``count_unstable`` (NaN
        where that is not known of each), ``lowest_energy``, ``status``; a scene that is not done has count -1 and
        energy NaN.

    Raises
    ------
    SweepError
        If xarray is not installed, or the folder holds no sweep.
    """
    xarray = require("xarray", "reading a sweep", "sweep", SweepError)
    grid = sweep_grid(folder)
    dims = tuple(grid["axes"])
    coords = {name: (dims[k], v) for k, (name, v) in enumerate(grid["axes"].items())}
    if grid["mode"] == "list":
        dims = ("scene",)
        coords = {name: ("scene", v) for name, v in grid["axes"].items()}
    data = {key: (dims, grid[key]) for key in grid if key not in ("axes", "places", "log", "mode")}
    return xarray.Dataset(data, coords=coords, attrs={"source": "origami_nlp sweep"})


@contextmanager
def _readable(folder: str | Path) -> Iterator[None]:
    """Say of a store that holds what no sweep writes that it is none."""
    try:
        yield
    except (LookupError, TypeError, ValueError, OverflowError) as error:
        if isinstance(error, OrigamiError):
            raise
        raise SweepError(f"{str(folder)!r} is no store of a sweep: {error}") from None


def sweep_grid(folder: str | Path) -> dict[str, Any]:
    """The same as plain NumPy arrays over the sweep's shape (what figures use)."""
    with _readable(folder):
        return _grid(folder)


def _grid(folder: str | Path) -> dict[str, Any]:
    keys = dict(read_table(folder, "sweep")[1])
    sweep, shape = json.loads(keys["sweep"]), tuple(json.loads(keys["shape"]))
    total = int(np.prod(shape))
    status, count = np.full(total, "waiting", dtype="<U8"), np.full(total, -1)
    by_kind = {kind: np.full(total, -1) for kind in KINDS}
    energy, stable, unstable = np.full((3, total), np.nan)
    for k, said in _columns(folder, "scenes", "scene", "status"):
        status[k] = said
        if said == "done":
            for array in (count, stable, unstable, *by_kind.values()):
                array[k] = 0
    for k, value, kind, known in _columns(folder, "states", "scene", "energy", "kind", "stable"):
        count[k] += 1
        stable[k] += np.nan if known is None else known
        unstable[k] += np.nan if known is None else 1 - known
        by_kind[kind][k] += 1
        energy[k] = np.fmin(energy[k], value)
    flat = {f"count_{kind.replace('-', '_')}": v for kind, v in by_kind.items()}
    flat |= {
        "count": count,
        "count_stable": stable,
        "count_unstable": unstable,
        "lowest_energy": energy,
        "status": status,
    }
    return {
        "axes": {name: np.array(values, float) for name, _, values, _ in sweep["axes"]},
        "places": {name: list(places) for name, places, _, _ in sweep["axes"]},
        "log": {name: scale == "log" for name, _, _, scale in sweep["axes"]},
        "mode": sweep["search"]["mode"],
        **{name: array.reshape(shape) for name, array in flat.items()},
    }


def _columns(folder: str | Path, table: str, *names: str) -> Iterator[tuple[Any, ...]]:
    known, rows = read_table(folder, table)
    which = [known.index(name) for name in names]
    return (tuple(row[k] for k in which) for row in rows)
