"""Commands that follow states: under a load, over a parameter, over two."""

from __future__ import annotations

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
    pull: tuple[int, int] | None = o.PULL,
    force: tuple[int, float, float, float] | None = o.FORCE,
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
    from origami_nlp.pattern import Scene
    from origami_nlp.pattern_problem import DeadForce, Pull

    if to != "snap" and not is_number(to):
        raise OptionError(f"--to = {to!r} must be a number, or snap")
    given = [*filter(None, (crease, pull, force))]
    if len(given) > 1 or (origami.is_whole and not given):
        raise OptionError("give one of --crease K, --pull V W and --force V X Y Z")
    if fixed_facet is not None and not force:
        raise OptionError(f"--fixed-facet = {fixed_facet} is for --force V X Y Z: leave it out")
    what: Any = origami.read_whole()
    bears: Any = crease
    if isinstance(what, Scene):
        if pull or force or (crease and len(crease) > 1):
            raise OptionError("--pull, --force and several --crease are for patterns")
        if not crease and not what.loads:
            raise OptionError("--crease K is missing: the crease that bears the torque, from 1")
        bears = crease[0] if crease else None
    elif pull:
        bears = Pull(what, pull)
    elif force:
        bears = DeadForce(what, force[0], force[1:], fixed_facet or 1)
    options: Any = {"to": to if to == "snap" else float(to), "unload": unload, "full": full}
    options |= {"starts": starts, "state": state, "effort": effort, "seed": seed}
    with progress(f"{origami.name} under load"):
        torques = _yields(yields, len(what.stiffness))
        return clock.within(load_path, what, bears, yield_torque=torques, **options)


def _yields(given: list[str] | None, creases: int) -> dict[int, float] | None:
    """Return the torques at which creases yield, by crease from 1; later ones count."""
    found: dict[int, float] = {}
    for text in given or ():
        crease, some, torque = text.rpartition("=")
        if not is_number(torque) or (some and not crease.isdecimal()):
            raise OptionError(f"--yield = {text!r} must be a torque, or CREASE=TORQUE as in 2=0.01")
        which = [int(crease)] if some else range(1, creases + 1)
        found |= dict.fromkeys(which, float(torque))
    return found or None


@writes("json", "csv", "figure", "html", "fold", verbose=True)
def follow(
    origami: Source,
    clock: Clock,
    parameter: str = o.PARAMETER,
    checks: int = o.CHECKS,
    prove: bool | None = o.PROVE,
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
        options |= {"prove": prove, "seed": seed, "progress": report.at}
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
