"""Results of a sweep as pandas or xarray objects (extra ``sweep``)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.arguments import require
from origami_nlp.display import KINDS
from origami_nlp.errors import SweepError
from origami_nlp.sweep.store import read_store, readable

if TYPE_CHECKING:
    import pandas
    import xarray


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
    rows = read_store(folder)[1]
    with readable(folder):
        each = ((k, row, state) for k, row in rows.items() for state in row["states"])
        states = [{"scene": k, **row["parameters"], **state} for k, row, state in each]
        return pandas.DataFrame(states).astype({"energy_J": float, "closure": float})


def load_sweep(folder: str | Path) -> xarray.Dataset:
    """Read counts and lowest energies of a sweep, labelled (extra ``sweep``).

    Parameters
    ----------
    folder
        Of `run_sweep`.

    Returns
    -------
    xarray.Dataset
        Over the axes of the sweep: ``count`` (minima), ``count_<kind>``, ``count_shallow``, ``count_stable`` and
        ``count_unstable`` (NaN where that is not known of each), ``lowest_energy``, ``status``; a scene that is not
        done has count -1 and energy NaN.

    Raises
    ------
    SweepError
        If xarray is not installed, or the folder holds no sweep.
    """
    xarray = require("xarray", "reading a sweep", "sweep", SweepError)
    sweep, rows = read_store(folder)
    with readable(folder):
        shape, axes = tuple(sweep["shape"]), sweep["axes"]
        names = ["count", "count_shallow", *(f"count_{kind.replace('-', '_')}" for kind in KINDS)]
        data: dict[str, Any] = {name: np.full(shape, -1) for name in names}
        for name in ("count_stable", "count_unstable", "lowest_energy"):
            data[name] = np.full(shape, np.nan)
        data["status"] = np.full(shape, "waiting", dtype="<U8")
        for k, row in rows.items():
            data["status"].flat[k] = row["status"]
            if row["status"] == "done":
                for name, value in _counted(row["states"]).items():
                    data[name].flat[k] = value
        along = ["scene"] * len(axes) if sweep["search"]["mode"] == "list" else [a[0] for a in axes]
        coords = {a[0]: (d, np.array(a[2], float)) for a, d in zip(axes, along, strict=True)}
        whole = {key: (along[: len(shape)], v) for key, v in data.items()}
        return xarray.Dataset(whole, coords=coords, attrs={"source": "origami_nlp sweep"})


def _counted(states: list[dict[str, Any]]) -> dict[str, float]:
    """Return what is said of the states of one scene."""
    kinds, stable = [s["kind"] for s in states], [s["stable"] for s in states]
    settled = (s["shallow"] or s["full_space"] in ("stable", "unstable") for s in states)
    known = 1.0 if all(settled) else np.nan
    found = {f"count_{kind.replace('-', '_')}": kinds.count(kind) for kind in KINDS}
    if sum(found.values()) < len(kinds):
        raise ValueError(f"kinds {kinds}")
    lowest = min((float(s["energy_J"]) for s in states), default=np.nan)
    return found | {
        "count": len(states),
        "count_shallow": sum(s["shallow"] is True for s in states),
        "count_stable": known * stable.count(True),
        "count_unstable": known * stable.count(False),
        "lowest_energy": lowest,
    }
