"""The store of a sweep: one SQLite file that grows by a transaction a scene.

SQLite is in Python's standard library, readable from anywhere, and keeps what it said it kept through
kill -9: a scene is there whole or not at all.  Tables (documented, so that other programs can read them):

- ``sweep(key, value)``: the sweep as JSON, schema and version;
- ``scenes(scene, <one column an axis>, status, reason, seconds, starts, expected_undiscovered)``: status is
  ``done``, ``invalid`` (these values make no scene) or ``failed``;
- ``states(scene, state, energy, kind, dimension, closure, kkt, full_space, stable, fold_angles)``: the
  minima of each scene by energy; stable is 1 or 0, null where the full space was not asked; fold angles [rad] as a
  JSON list.

Only the process that runs the sweep writes: it holds ``sweep.lock`` beside it, an empty database, for as long as it
lives; a second one is informed of it.
"""

from __future__ import annotations

import json
import math
import sqlite3
import time
from collections.abc import Callable, Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from origami_nlp.arguments import check_path
from origami_nlp.errors import OrigamiError, SweepError
from origami_nlp.sweep.spec import Sweep

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult

SCHEMA = "origami-nlp/sweep/3"
FILE, LOCK = "sweep.sqlite", "sweep.lock"
T = TypeVar("T")
Rows = tuple[tuple[Any, ...], ...]


@dataclass(frozen=True)
class Outcome:
    """What became of one scene; states: rows, see the module."""

    scene: int
    status: str
    reason: str
    seconds: float
    starts: int
    missing: float | None
    states: Rows


def attempted(index: int, make: Callable[[int], T], find: Callable[[T], MinimaResult]) -> Outcome:
    """Make a scene and find its states; errors become the outcome, so that one scene does not end a sweep.

    Parameters
    ----------
    index
        Of the scene, from 0.
    make
        Makes it.
    find
        Returns its minima.

    Returns
    -------
    Outcome
        ``invalid`` where the values make no scene, ``failed`` where the search does not end.
    """
    begin = time.perf_counter()
    try:
        made = make(index)
    except OrigamiError as error:
        return Outcome(index, "invalid", str(error), 0.0, 0, None, ())
    try:
        found = find(made)
    except Exception as error:  # whatever it is: it is reported, by name
        reason = f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}"
        return Outcome(index, "failed", reason, time.perf_counter() - begin, 0, None, ())
    missing = getattr(found.search, "expected_undiscovered", math.inf)
    rows = tuple(
        (*row, m.full_space and m.full_space.verdict, known, list(m.fold_angles))
        for m, (*row, known) in zip(found.minima, map(_known, found._rows()), strict=True)
    )
    seconds = time.perf_counter() - begin
    missing = missing if math.isfinite(missing) else None
    return Outcome(index, "done", "", seconds, found.search.starts, missing, rows)


def _known(row: dict[str, Any]) -> list[Any]:
    """Return what of a row of a table of minima is kept."""
    kkt = row["kkt"] if math.isfinite(row["kkt"]) else None
    return [*(row[k] for k in ("energy_J", "kind", "dimension", "closure")), kkt, row["stable"]]


class Store:
    """An open store; use as a context manager."""

    def __init__(self, folder: str | Path, sweep: Sweep) -> None:
        """Open the store of `sweep` in `folder`, or make it.

        Raises
        ------
        SweepError
            If the folder holds another sweep, is no store, or another process runs a sweep there.
        """
        path = Path(folder) / FILE
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._lock = sqlite3.connect(path.parent / LOCK, timeout=0, isolation_level=None)
            try:
                self._lock.execute(
                    "BEGIN EXCLUSIVE"
                )  # the system ends it with the process, however that ends
            except sqlite3.OperationalError as error:
                if error.sqlite_errorcode != sqlite3.SQLITE_BUSY:
                    raise
                raise SweepError(
                    f"--folder {str(folder)!r} is in use: another process runs a sweep there; wait for its end, or "
                    "choose another folder"
                ) from None
            self._db = sqlite3.connect(path)
            self._db.execute("PRAGMA journal_mode = WAL")
            self._db.execute("PRAGMA synchronous = NORMAL")
            known = _read_key(self._db, "sweep")
            if known is None:
                self._make(sweep)
            elif known != sweep.fingerprint():
                self._db.close()
                raise SweepError(
                    f"--folder {str(folder)!r} holds another sweep: choose another folder"
                )
        except (OSError, sqlite3.Error) as error:
            raise SweepError(f"--folder {str(folder)!r} cannot be used: {error}") from None
        self._axes = [a.name for a in sweep.axes]

    def _make(self, sweep: Sweep) -> None:
        axes = ", ".join(f"{_quoted(a.name)} REAL" for a in sweep.axes)
        with self._db:
            self._db.execute("BEGIN IMMEDIATE")
            self._db.execute("CREATE TABLE sweep (key TEXT PRIMARY KEY, value TEXT)")
            self._db.execute(
                f"CREATE TABLE scenes (scene INTEGER PRIMARY KEY, {axes}, status TEXT, reason TEXT, "
                "seconds REAL, starts INTEGER, expected_undiscovered REAL)"
            )
            self._db.execute(
                "CREATE TABLE states (scene INTEGER, state INTEGER, energy REAL, kind TEXT, "
                "dimension INTEGER, closure REAL, kkt REAL, full_space TEXT, "
                "stable INTEGER, fold_angles TEXT, PRIMARY KEY (scene, state))"
            )
            rows = [
                ("schema", SCHEMA),
                ("shape", json.dumps(sweep.shape)),
                ("sweep", sweep.fingerprint()),
            ]
            self._db.executemany("INSERT INTO sweep VALUES (?, ?)", rows)

    def done(self) -> set[int]:
        """Return the scenes that need no more work (failed ones are tried again)."""
        rows = self._db.execute("SELECT scene FROM scenes WHERE status != 'failed'")
        return {int(r[0]) for r in rows}

    def add(self, outcome: Outcome, parameters: dict[str, float]) -> None:
        """Add a scene, whole."""
        with self._db:
            self._db.execute("DELETE FROM states WHERE scene = ?", (outcome.scene,))
            values = [parameters[name] for name in self._axes]
            o = outcome
            row = [o.scene, *values, o.status, o.reason, o.seconds, o.starts, o.missing]
            self._db.execute(
                f"INSERT OR REPLACE INTO scenes VALUES ({', '.join('?' * len(row))})", row
            )
            self._db.executemany(
                "INSERT INTO states VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                [(o.scene, k, *s[:-1], json.dumps(s[-1])) for k, s in enumerate(o.states, start=1)],
            )

    def counts(self) -> dict[str, int]:
        """Return how many scenes have each status."""
        return dict(self._db.execute("SELECT status, COUNT(*) FROM scenes GROUP BY status"))

    def close(self) -> None:
        """Close the file, and let others have it."""
        self._db.close()
        self._lock.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def read_table(folder: str | Path, table: str) -> tuple[list[str], list[tuple[Any, ...]]]:
    """Return column names and rows of a table of a store, in order (see the module)."""
    check_path("folder", folder)
    path = Path(folder) / FILE
    if not path.is_file():
        raise SweepError(f"{str(folder)!r} holds no sweep: {FILE} is not there")
    order = {"scenes": "scene", "states": "scene, state", "sweep": "key"}[table]
    try:
        with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as db:
            cursor = db.execute(f"SELECT * FROM {table} ORDER BY {order}")
            return [c[0] for c in cursor.description], cursor.fetchall()
    except sqlite3.Error as error:
        raise SweepError(f"{str(path)!r} is no store of a sweep: {error}") from None


def _read_key(db: sqlite3.Connection, key: str) -> str | None:
    there: Iterable[tuple[str]] = db.execute("SELECT name FROM sqlite_master WHERE name = 'sweep'")
    if not list(there):
        return None
    row = db.execute("SELECT value FROM sweep WHERE key = ?", (key,)).fetchone()
    return row[0] if row else None


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""').replace("\x00", "") + '"'
