"""The store of a sweep: a file ``sweep.jsonl`` that grows by a line a scene, written at once.

Its first line is the sweep, each other one what became of a scene: ``scene`` (from 0), ``parameters``, ``status``
(``done``; ``invalid``: these values make no scene; ``failed``), ``reason``, ``seconds``, ``starts``, ``states`` (rows
of `MinimaResult.to_frame`).  The last line of a scene counts; one that was cut by kill -9 is none.

Only the process that runs the sweep writes: it holds ``sweep.lock`` beside it, an empty database, for as long as it
lives; a second one is told so.
"""

from __future__ import annotations

import json
import math
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.arguments import check_path, require
from origami_nlp.display import KINDS
from origami_nlp.errors import OrigamiError, SweepError
from origami_nlp.sweep.spec import Sweep

if TYPE_CHECKING:
    import pandas
    import xarray

SCHEMA = "origami-nlp/sweep/5"
FILE, LOCK = "sweep.jsonl", "sweep.lock"


class Store:
    """The store of a sweep in a folder, open for writing.

    Parameters
    ----------
    folder
        Made if there is none.
    sweep
        Whose store it is.

    Raises
    ------
    SweepError
        If the folder holds another sweep, is no store, or another process runs a sweep there.
    """

    def __init__(self, folder: str | Path, sweep: Sweep) -> None:
        self.sweep, path, where = sweep, Path(folder) / FILE, f"--folder {str(folder)!r}"
        stated = {"schema": SCHEMA, **sweep.to_dict()}
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            # the system ends the transaction with the process, however that ends
            self._lock = sqlite3.connect(path.parent / LOCK, timeout=0, isolation_level=None)
            self._lock.execute("BEGIN EXCLUSIVE")
            if path.exists():
                whole = path.read_bytes()
                if not whole.endswith(b"\n"):
                    path.write_bytes(whole[: whole.rfind(b"\n") + 1])
            self._file = open(path, "a", encoding="utf-8")
        except (OSError, sqlite3.Error) as error:
            busy = getattr(error, "sqlite_errorcode", 0) == sqlite3.SQLITE_BUSY
            why = (
                "is in use: another process runs a sweep there"
                if busy
                else f"cannot be used: {error}"
            )
            raise SweepError(f"{where} {why}") from None
        self.status: dict[int, str] = {}
        if not path.stat().st_size:
            self._write(stated)
            return
        try:
            head, rows = read_store(folder)
            if head != stated:
                raise SweepError(f"{where} holds another sweep: choose another folder")
        except SweepError:
            self.__exit__()
            raise
        self.status = {k: row["status"] for k, row in rows.items()}

    def add(self, outcome: dict[str, Any]) -> None:
        """Add what became of a scene."""
        self._write(outcome)
        self.status[outcome["scene"]] = outcome["status"]

    def _write(self, data: dict[str, Any]) -> None:
        self._file.write(json.dumps(data, allow_nan=False) + "\n")
        self._file.flush()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()
        self._lock.close()


def read_store(folder: str | Path) -> tuple[dict[str, Any], dict[int, dict[str, Any]]]:
    """Return the sweep of a store, and its scenes by number."""
    check_path("folder", folder)
    path = Path(folder) / FILE
    if not path.is_file():
        raise SweepError(f"{str(folder)!r} holds no sweep: {FILE} is not there")
    with readable(folder):
        head, *lines = path.read_text("utf-8").splitlines(keepends=True)
        rows = [json.loads(line) for line in lines if line.endswith("\n")]
        stated = json.loads(head)
        kinds = {"scene": int, "status": str, "reason": str, "parameters": dict, "states": list}
        good = all(type(row[key]) is kind for row in rows for key, kind in kinds.items())
        if not (good and isinstance(stated["schema"], str) and stated["shape"]):
            raise ValueError("a line of it is no sweep, or no scene")
        found = {row["scene"]: row for row in rows}
        return stated, {k: found[k] for k in sorted(found) if 0 <= k < math.prod(stated["shape"])}


@contextmanager
def readable(folder: str | Path) -> Iterator[None]:
    """Say of a store that holds what no sweep writes that it is none."""
    try:
        yield
    except (LookupError, TypeError, ValueError, OverflowError, AttributeError, OSError) as error:
        if isinstance(error, OrigamiError):
            raise
        raise SweepError(f"{str(folder)!r} is no store of a sweep: {error}") from None


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
    with readable(folder):
        found = read_store(folder)[1].items()
        each = ((k, row, state) for k, row in found for state in row["states"])
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
        unknown = ("count_stable", "count_unstable", "lowest_energy")
        data |= {name: np.full(shape, np.nan) for name in unknown}
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
    return found | {
        "count": len(states),
        "count_shallow": sum(s["shallow"] is True for s in states),
        "count_stable": known * stable.count(True),
        "count_unstable": known * stable.count(False),
        "lowest_energy": min((float(s["energy_J"]) for s in states), default=np.nan),
    }
