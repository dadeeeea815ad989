"""Results of a sweep as pandas or xarray objects (extra ``sweep``)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.errors import SweepError
from origami_nlp.sweep.store import read_table

if TYPE_CHECKING:
    import pandas
    import xarray

KINDS = ("interior", "contact-pinned", "contact-touching", "degenerate")


def _need(module: str) -> Any:
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise SweepError(f'{module} is not installed: pip install "origami_nlp[sweep]"') from None


def _rows(folder: str | Path, table: str) -> Iterator[dict[str, Any]]:
    names, rows = read_table(folder, table)
    return (dict(zip(names, row, strict=True)) for row in rows)


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
    pandas = _need("pandas")
    names, rows = read_table(folder, "scenes")
    scenes = pandas.DataFrame(rows, columns=names)
    names, rows = read_table(folder, "states")
    states = pandas.DataFrame(rows, columns=names).rename(columns={"energy": "energy_J"})
    angles = [json.loads(a) for a in states.pop("fold_angles")]
    degree = max(map(len, angles), default=0)
    for i in range(degree):
        states[f"phi_{i + 1}_rad"] = [a[i] if i < len(a) else np.nan for a in angles]
    own = ["status", "reason", "seconds", "starts", "expected_undiscovered"]
    return scenes.drop(columns=own).merge(states, on="scene")


def load_sweep(folder: str | Path) -> xarray.Dataset:
    """Read counts and lowest energies of a sweep, labelled (extra ``sweep``).

    Parameters
    ----------
    folder
        Of `run_sweep`.

    Returns
    -------
    xarray.Dataset
        Over the axes of the sweep: ``count`` (minima), ``count_<kind>``, ``lowest_energy``, ``status``; a scene that is
        not done has count -1 and energy NaN.

    Raises
    ------
    SweepError
        If xarray is not installed, or the folder holds no sweep.
    """
    xarray = _need("xarray")
    grid = sweep_grid(folder)
    dims = tuple(grid["axes"])
    coords = {name: (dims[k], v) for k, (name, v) in enumerate(grid["axes"].items())}
    if grid["mode"] == "list":
        dims = ("scene",)
        coords = {name: ("scene", v) for name, v in grid["axes"].items()}
    data = {key: (dims, grid[key]) for key in grid if key not in ("axes", "places", "log", "mode")}
    return xarray.Dataset(data, coords=coords, attrs={"source": "origami_nlp sweep"})


def sweep_grid(folder: str | Path) -> dict[str, Any]:
    """The same as plain NumPy arrays over the sweep's shape (what figures use)."""
    keys = dict(read_table(folder, "sweep")[1])
    sweep, shape = json.loads(keys["sweep"]), tuple(json.loads(keys["shape"]))
    axes = {name: np.array(values) for name, _, values, _ in sweep["axes"]}
    total = int(np.prod(shape))
    status = np.full(total, "waiting", dtype="<U8")
    count = np.full(total, -1)
    by_kind = {kind: np.full(total, -1) for kind in KINDS}
    energy = np.full(total, np.nan)
    for scene in _rows(folder, "scenes"):
        status[scene["scene"]] = scene["status"]
        if scene["status"] == "done":
            for array in (count, *by_kind.values()):
                array[scene["scene"]] = 0
    for state in _rows(folder, "states"):
        k = state["scene"]
        count[k] += 1
        by_kind[state["kind"]][k] += 1
        energy[k] = np.fmin(energy[k], state["energy"])
    arrays = {f"count_{kind.replace('-', '_')}": v.reshape(shape) for kind, v in by_kind.items()}
    return {
        "axes": axes,
        "places": {name: list(places) for name, places, _, _ in sweep["axes"]},
        "log": {name: scale == "log" for name, _, _, scale in sweep["axes"]},
        "mode": sweep["search"]["mode"],
        "count": count.reshape(shape),
        **arrays,
        "lowest_energy": energy.reshape(shape),
        "status": status.reshape(shape),
    }
