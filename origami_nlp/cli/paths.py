"""Commands that follow states: under a load, over a parameter, over two."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from origami_nlp.cli import options as o
from origami_nlp.cli.group import writes
from origami_nlp.cli.progress import progress
from origami_nlp.cli.source import Source
from origami_nlp.cli.timed import Clock
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from origami_nlp.pattern import Pattern


@writes("json", "csv", "figure", "html", "fold", "mesh", verbose=True)
def load(
    origami: Source,
    clock: Clock,
    crease: list[int] | None = o.CREASE,
    edge: list[int] | None = o.EDGE,
    pull: str | None = o.PULL,
    force: str | None = o.FORCE,
    fixed_facet: int | None = o.FIXED_FACET,
    to: str = o.TO,
    state: int | None = o.STATE,
    unload: bool = o.UNLOAD,
    confirm: bool = o.CONFIRM,
    yields: list[str] | None = o.YIELDS,
    full: bool | None = o.FULL,
    effort: str = o.EFFORT,
    seed: int = o.SEED,
    starts: int | None = o.STARTS,
) -> Any:
    """Load a stable state of ORIGAMI until it snaps, or to a given load: load against angle, snaps, hysteresis.

    A pattern is loaded by one of --crease, --edge, --pull and --force, a vertex by --crease, else by the scene's own
    forces.  Images of the crease under the symmetry of a vertex bear the same torque; where the state breaks the
    symmetry (a pitchfork) the path goes on along stable states that branch off, or snaps.  --no-full keeps the
    symmetry; --symmetry none loads the one crease alone.  With --yield creases yield: their rest angles move, and stay
    moved as the load falls; the path ends where it first snaps.
    """
    from origami_nlp.paths import load_path
    from origami_nlp.pattern import Scene

    end = to if to == "snap" else _number("--to", to, "a load, or snap")
    if fixed_facet is not None and not force:
        raise OptionError(f"--fixed-facet = {fixed_facet} is for --force V,X,Y,Z: leave it out")
    if origami.is_whole and sum(map(bool, (crease, edge, pull, force))) != 1:
        raise OptionError(
            "a pattern is loaded by one of --crease K, --edge E, --pull V,W and --force V,X,Y,Z"
        )
    pulled, forced = _numbers("--pull", pull, 2), _numbers("--force", force, 4)
    what, work = origami.read_whole(), crease
    if not isinstance(what, Scene):
        work = _work(what, crease, edge, pulled, forced, fixed_facet or 1)
    elif edge or pull or force or len(crease or ()) > 1:
        raise OptionError("--edge, --pull, --force and several --crease are for patterns")
    elif not crease and not what.loads:
        raise OptionError("--crease K is missing: the crease that bears the torque, from 1")
    count = what.degree if isinstance(what, Scene) else what.creases
    options: dict[str, Any] = {
        "yield_torque": _yields(yields, count),
        "full": full,
        "starts": starts,
    }
    with progress(f"{origami.name} under load"):
        return clock.within(
            load_path,
            what,
            work[0] if isinstance(work, list) and work else work or None,
            to=end,
            state=1 if state is None else state,
            unload=unload,
            confirm=confirm,
            effort=effort,
            seed=seed,
            **options,
        )


def _number(option: str, text: str, what: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"{option} = {text!r} must be {what}") from None


def _numbers(option: str, text: str | None, count: int) -> list[float]:
    """Return numbers with commas between them, the first of them vertices."""
    what = f"{count} numbers with commas between them"
    values = [_number(option, part, what) for part in text.split(",")] if text else []
    if text and (len(values) != count or not all(map(math.isfinite, values))):
        raise OptionError(f"{option} = {text!r} must be {what}")
    for value in values[: 2 if count == 2 else 1]:
        if value != int(value):
            raise OptionError(f"{option}: vertex {value:g} must be a whole number, as in the file")
    return values


def _yields(given: list[str] | None, creases: int) -> dict[int, float] | None:
    """Return the torques at which creases yield, by crease from 1; later ones count."""
    found: dict[int, float] = {}
    for text in given or ():
        crease, some, torque = text.rpartition("=")
        try:
            which = [int(crease)] if some else range(1, creases + 1)
            found |= dict.fromkeys(which, float(torque))
        except ValueError:
            raise OptionError(
                f"--yield = {text!r} must be a torque, or CREASE=TORQUE as in 2=0.01"
            ) from None
    return found or None


def _work(
    sheet: Pattern,
    creases: list[int] | None,
    edges: list[int] | None,
    pull: list[float],
    force: list[float],
    fixed_facet: int,
) -> Any:
    """Return what a load on a pattern works on."""
    from origami_nlp.pattern import listed
    from origami_nlp.pattern_problem import DeadForce, Pull, Torque

    number = {edge: crease for crease, edge in enumerate(sheet.numbers.tolist(), start=1)}
    for edge in edges or ():
        if edge not in number:
            raise OptionError(
                f"--edge = {edge} is no crease: the file has creases at edges {listed([*number])}"
            )
    if creases or edges:
        return Torque(sheet, tuple(creases or [number[edge] for edge in edges or ()]))
    if pull:
        return Pull(sheet, (int(pull[0]), int(pull[1])))
    return DeadForce(sheet, int(force[0]), (force[1], force[2], force[3]), fixed_facet)


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

    # options of an example by name are among what it can be followed over
    named = origami.is_example and not origami.given
    options: dict[str, Any] = {
        "prove": o.wanted_proof(prove),
        "starts": starts,
        "full": full,
        "checks": checks,
    }
    with progress(f"{origami.name} over {parameter}") as report:
        options["progress"] = lambda text: report(text=text)
        what = origami.name if named else origami.read_whole()
        return clock.within(follow_states, what, parameter, effort=effort, seed=seed, **options)


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
