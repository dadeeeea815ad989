"""Follow a stable state under a load: as far as it is stable, through snaps, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from origami_nlp.arguments import check_flag, check_number, check_type, check_until, shown
from origami_nlp.continuation import ContinuationOptions
from origami_nlp.errors import OptionError, OutOfTime, unless_stopped
from origami_nlp.minima import JudgedState
from origami_nlp.paths.driver import driver_of
from origami_nlp.paths.job import CUT, FollowedLoad
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.result import LoadPath
from origami_nlp.paths.yielding import YieldingHinges, go_yielding
from origami_nlp.pattern import Stated, as_origami
from origami_nlp.pattern_problem import Work


def load_path(
    origami: Stated,
    load: int | Sequence[int] | Work | None = None,
    *,
    to: float | str = "snap",
    state: int | JudgedState = 1,
    unload: bool = False,
    full: bool = True,
    yield_torque: float | Sequence[float | None] | Mapping[int, float] | None = None,
    options: ContinuationOptions | None = None,
    seconds: float | None = None,
    **search: Any,
) -> LoadPath:
    """Load a stable state of a vertex or of a pattern by a torque or a force, and follow it.

    Where the state ends in a limit point, or comes to the flat state, where branches cross, it snaps: it descends, at
    the load at which it ends, to the next minimum, from where the path goes on.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it.
    load
        Number (1-based) of the crease that the torque t [N m] is on, towards valley > 0, and on its images under the
        symmetry of a scene; None: t times the forces of the scene's loads.  Of a pattern also several numbers, or a
        `Torque`, `Pull` or `DeadForce`.
    to
        Load at which the path ends, from 0; ``"snap"``: both ways to the first snap.
    state
        Number (1-based) of the stable state at load 0, by energy; of a pattern also a state of `find_minima`.
    unload
        Whether the load then falls back to 0, also from where it snapped.
    full
        Whether states may break the symmetry, where the state that is loaded is stable without it: at a pitchfork the
        path goes on along what branches off there, or snaps.
    yield_torque
        Torque [N m] at which hinges yield: of all creases, of each (None: it does not), or of some by their numbers
        (1-based).  Hinges are elastic below it and perfectly plastic at it: their rest angles move, and stay moved.
        Such a path keeps no symmetry and ends at its first snap (how far hinges yield in it is decided by its speed).
    options
        Of the continuation; lengths are root mean squares over creases.
    seconds
        Wall time, to a second or two: what was followed by then is returned, and what was left out named.  None: no
        limit.
    search
        Of the search for the state: effort, seed, max_starts, starts of `find_minima`.

    Returns
    -------
    LoadPath
        Legs, snaps, branches and events.

    Raises
    ------
    OptionError
        If an argument is not what it must be, there is no such stable state, or the time was over before it began.
    Interrupted
        If the user interrupts it: a `KeyboardInterrupt` whose ``result`` holds what was followed.

    Examples
    --------
    >>> import origami_nlp as o
    >>> path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=0.05)
    >>> [(event.type, round(event.t, 6)) for event in path.events]
    [('closes', 0.042461)]
    """
    driver = driver_of(as_origami(origami), load)
    if options is not None:
        check_type("options", options, ContinuationOptions)
    check_flag("unload", unload)
    check_flag("full", full)
    if (isinstance(to, str) and to != "snap") or to == 0:
        raise OptionError(f"to = {shown(to)} must be a load other than 0, or 'snap'")
    ends = [-driver.farthest, driver.farthest] if to == "snap" else [check_number("to", to)]
    until = check_until(seconds)
    driver, number, x = driver.begin(state, until, search, full)
    hinges = None
    if yield_torque is not None:
        x = driver.problem.expand(x)
        hinges, driver = YieldingHinges.of(driver, yield_torque, x, number), driver.free
    over = ParameterRange(driver.name, min(0.0, *ends), max(0.0, *ends), driver.unit, False)
    job = FollowedLoad(driver, over, driver.steps(options, until), number)
    kept = job.record
    if full and driver.keeps:
        why = f"state {number or 'given'} is stable with its symmetry {driver.keeps} alone"
        kept.alarms.append(f"{why}: the path keeps it")
    try:
        for end in ends:
            if hinges:
                led = go_yielding(job, (x, hinges), 0.0, end)
                if unload and led is not None:
                    go_yielding(job, led, end, 0.0)
                continue
            arrived = job.go(x, 0.0, end, once=to == "snap")
            if unload and arrived is not None:
                job.low, job.high = min(0.0, end), max(0.0, end)
                job.go(*arrived, 0.0, once=False)
                job.low, job.high = over.low, over.high
    except OutOfTime:  # of a descent
        kept.alarms.append(CUT)
    except KeyboardInterrupt:
        job.stop()
    if any(one.stopped for one in kept.stages):
        job.stop()
    if job.stopped and not kept.ways:
        raise KeyboardInterrupt
    if not kept.ways and not hinges:
        late = f"seconds = {seconds or 0:g}: the time was over before a leg was followed: give more"
        raise OptionError(kept.alarms[0] if seconds is None else late)
    return unless_stopped(job.result(), job.stopped)
