"""A load path of a sheet: legs of stable states, snaps between them, branches and events around them.

JSON schema ``origami-nlp/sheet-load/1``: that of a vertex's load path with a pattern in place of a scene.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from origami_nlp.loading import LoadedPath, read_path
from origami_nlp.numerics import TYPED
from origami_nlp.pattern import Pattern, pattern_from_dict, pattern_to_dict
from origami_nlp.sheet_loading.work import DeadForce, Pull, Torque, Work

if TYPE_CHECKING:
    from typing import Self

SCHEMA = "origami-nlp/sheet-load/1"


@dataclass(frozen=True, repr=False)
class SheetLoadPath(LoadedPath):
    """A sheet under a load that grows, through fold limits and snaps.

    Attributes
    ----------
    driver
        What the load is.
    state
        Number (1-based) of the stable state of the unloaded sheet that is loaded; 0 where it was given itself.
    low, high
        Range of the load.
    legs, snaps
        What the state does, in order.
    branches, events
        All equilibria that were followed, unstable ones included, and where they change.
    alarms
        What does not fit together, in words; empty where everything does.
    steps, evaluations
        What following cost.
    pattern
        As stated.

    Examples
    --------
    >>> import origami_nlp as o
    >>> sheet = o.examples.pattern("miura", 2, 3).with_springs(0.01, 1.2)
    >>> path = o.find_load_path(sheet, 2, to=0.02)
    >>> [leg.why for leg in path.legs], len(path.snaps)
    (['range'], 0)
    """

    driver: Work
    pattern: Pattern

    PICTURE, TURNED, READ = "draw_sheet_load", "turn_sheet_path", SCHEMA
    WAY = "facets do not cross at the states of the path, nor at those of ways down; between states it is not asked"

    @property
    def label(self) -> str:
        """What is loaded."""
        return self.pattern.name or "pattern"

    def _more(self) -> Iterator[str]:
        for number, leg in enumerate(self.legs, start=1):
            at = [p.angle for p in leg.points]
            if len(at) > 1 and max(at) - min(at) <= TYPED * self.driver.arm:
                yield (
                    f"leg {number}: the load does no work, what it works on stays as it is ({self.driver.coordinate}: "
                    f"{at[0]:.6g}); no motion that is free there changes it to first order"
                )

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data."""
        load: dict[str, Any] = {"kind": type(self.driver).__name__}
        if isinstance(self.driver, Torque):
            load["creases"] = list(self.driver.creases)
        elif isinstance(self.driver, Pull):
            load["corners"] = list(self.driver.corners)
        else:
            d = self.driver
            load |= {"corner": d.corner, "direction": list(d.direction), "held": d.held}
        return {
            "schema": SCHEMA,
            "pattern": pattern_to_dict(self.pattern),
            "load": load,
            **self._plain(),
        }

    @classmethod
    def _read(cls, data: dict[str, Any]) -> Self:
        pattern = pattern_from_dict(data["pattern"])
        return cls(driver=_work(pattern, data["load"]), pattern=pattern, **read_path(data))


def _work(pattern: Pattern, load: dict[str, Any]) -> Work:
    if load["kind"] == "Torque":
        return Torque(pattern, tuple(map(int, load["creases"])))
    if load["kind"] == "Pull":
        a, b = map(int, load["corners"])
        return Pull(pattern, (a, b))
    x, y, z = map(float, load["direction"])
    return DeadForce(pattern, int(load["corner"]), (x, y, z), int(load["held"]))


def path_states(path: SheetLoadPath) -> Iterator[tuple[str, Any, dict[str, Any]]]:
    """Yield the stable states of all legs in order: title, fold angles, and what else is known of each.

    Parameters
    ----------
    path
        Of `find_load_path`.

    Yields
    ------
    tuple
        For frames of a FOLD file.
    """
    for number, leg in enumerate(path.legs, start=1):
        for p in leg.points:
            title = f"leg {number}, {path.driver.name} = {p.t:.9g} {path.driver.unit}"
            yield title, p.fold_angles, {"leg": number, "parameter": p.t, "energy": p.energy}
