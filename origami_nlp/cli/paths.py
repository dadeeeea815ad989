"""Commands that follow states: under a load, over a parameter, over two."""

from __future__ import annotations

import math
from typing import Any

from origami_nlp.cli import options as o
from origami_nlp.cli.group import writes
from origami_nlp.cli.progress import progress
from origami_nlp.cli.source import Source
from origami_nlp.cli.timed import Clock
from origami_nlp.errors import OptionError
from origami_nlp.io import is_number


@writes("json", "csv", "figure", "html", "fold", "mesh", verbose=True)
def load(
    origami: Source,
    clock: Clock,
    crease: list[int] | None = o.CREASE,
    pull: str | None = o.PULL,
    force: str | None = o.FORCE,
    fixed_facet: int | None = o.FIXED_FACET,
    to: str = o.TO,
    state: int | None = o.STATE,
    unload: bool = o.UNLOAD,
    yields: list[str] | None = o.YIELDS,
    full: bool | None = o.FULL,
    effort: str = o.EFFORT,
    seed: int = o.SEED,
    starts: int | None = o.STARTS,
) -> Any:
    """Load a stable state of ORIGAMI until it snaps, or to a given load: load against angle, snaps, hysteresis.

    A pattern is loaded by one of --crease, --pull and --force, a vertex by --crease, else by the scene's own forces.
    Images of the crease under the symmetry of a vertex bear the same torque; where the state breaks the symmetry (a
    pitchfork) the path goes on along stable states that branch off, or snaps.  --no-full keeps the symmetry; --symmetry
    none loads the one crease alone.  With --yield creases yield: their rest angles move, and stay moved as the load
    falls; the path ends where it first snaps.
    """
    from origami_nlp.paths import load_path

    end = to if to == "snap" else _numbers("--to", to, 1)[0]
    given = [*filter(None, (crease, pull, force))]
    if len(given) > 1 or (origami.is_whole and not given):
        raise OptionError("give one of --crease K, --pull V,W and --force V,X,Y,Z")
    if fixed_facet is not None and not force:
        raise OptionError(f"--fixed-facet = {fixed_facet} is for --force V,X,Y,Z: leave it out")
    pulled, forced = _numbers("--pull", pull, 2), _numbers("--force", force, 4)
    what = origami.read_whole()
    bears = _work(what, crease, pulled, forced, fixed_facet)
    options: Any = {"to": end, "unload": unload, "full": full, "effort": effort, "seed": seed}
    options |= {"starts": starts, "state": state, "yield_torque": _yields(yields, what)}
    with progress(f"{origami.name} under load"):
        return clock.within(load_path, what, bears, **options)


def _numbers(option: str, text: str | None, count: int) -> list[float]:
    """Return numbers with commas between them."""
    values = [float(v) if is_number(v) else math.nan for v in text.split(",")] if text else []
    if text and (len(values) != count or not all(map(math.isfinite, values))):
        raise OptionError(f"{option} = {text!r} must be {count} numbers with commas between them")
    return values


def _vertex(option: str, value: float) -> int:
    if value % 1:
        raise OptionError(f"{option}: vertex {value:g} is no whole number, as in the file")
    return int(value)


def _yields(given: list[str] | None, what: Any) -> dict[int, float] | None:
    """Return the torques at which creases yield, by crease from 1; later ones count."""
    found: dict[int, float] = {}
    for text in given or ():
        crease, some, torque = text.rpartition("=")
        if not is_number(torque) or (some and not crease.isdecimal()):
            raise OptionError(f"--yield = {text!r} must be a torque, or CREASE=TORQUE as in 2=0.01")
        which = [int(crease)] if some else range(1, len(what.stiffness) + 1)
        found |= dict.fromkeys(which, float(torque))
    return found or None


def _work(what: Any, crease: Any, pull: list[float], force: list[float], facet: int | None) -> Any:
    """Return what a load works on, as `load_path` takes it."""
    from origami_nlp.pattern import Scene
    from origami_nlp.pattern_problem import DeadForce, Pull

    if isinstance(what, Scene):
        if pull or force or (crease and len(crease) > 1):
            raise OptionError("--pull, --force and several --crease are for patterns")
        if not crease and not what.loads:
            raise OptionError("--crease K is missing: the crease that bears the torque, from 1")
        return crease[0] if crease else None
    if crease:
        return crease
    if pull:
        a, b = (_vertex("--pull", v) for v in pull)
        return Pull(what, (a, b))
    return DeadForce(what, _vertex("--force", force[0]), tuple(force[1:]), facet or 1)  # type: ignore[arg-type]


@writes("json", "csv", "figure", "html", "fold", verbose=True)
def follow(
    origami: Source,
    clock: Clock,
    parameter: str = o.PARAMETER,
    checks: int = o.CHECKS,
    prove: str | None = o.PROVE,
    starts: int | None = o.STARTS,
    full: bool | None = o.FULL,
    effort: str = o.EFFORT,
    seed: int = o.SEED,
) -> Any:
    """Follow the states of ORIGAMI over a parameter, and locate where they appear, change and vanish."""
    from origami_nlp.paths import follow as follow_states

    options: Any = {"starts": starts, "full": full, "checks": checks, "effort": effort}
    # options of an example by name are among what it can be followed over
    named = origami.is_example and not origami.given
    what = origami.name if named else origami.read_whole()
    with progress(f"{origami.name} over {parameter}") as report:
        options |= {"prove": o.wanted_proof(prove), "seed": seed, "progress": report.at}
        return clock.within(follow_states, what, parameter, **options)


@writes("json", "figure")
def boundary(
    origami: Source,
    clock: Clock,
    event: str = o.EVENT,
    parameter: str = o.PARAMETER,
    lines: int = o.LINES,
    effort: str = o.EFFORT,
    seed: int = o.SEED,
) -> Any:
    """Draw where states of a vertex appear, change and vanish over two parameters, as exact curves."""
    from origami_nlp.paths import find_bifurcation_set

    options: dict[str, Any] = {"lines": lines, "effort": effort, "seed": seed}
    return clock.within(find_bifurcation_set, origami.read(), event, parameter, **options)
