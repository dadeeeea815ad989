"""What a design returns, how it is printed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from origami_nlp.display import (
    Report,
    Section,
    Words,
    record_table,
    shown,
    springs_of,
)
from origami_nlp.inverse_design.infeasibility import Infeasibility
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.io import printable
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern import Pattern, Scene


@dataclass(frozen=True)
class HeldState:
    """One target of a design, and what was found there.

    Attributes
    ----------
    name
        As asked.
    target
        Fold angles asked for [rad], [N].
    fold_angles
        Those of the state that the springs were made for: closed to rounding, [N].
    moved
        Largest difference of the two [rad].
    found
        Distance of the minimum that the search found from `fold_angles` [rad]; inf where it found none.
    energy
        Elastic energy [J].
    kind
        Of the minimum; None where the state is not one.
    certificate
        What proves it, or why it is no minimum.
    full_space
        Verdict where the symmetry may break: ``"stable"``, ``"unstable"``, ``"undecided"``; None where not asked.
    """

    name: str = field(metadata=shown("state"))
    target: tuple[float, ...]
    fold_angles: tuple[float, ...]
    moved: float = field(metadata=shown("moved to close", "rad", ".2g"))
    found: float
    energy: float = field(metadata=shown("energy", "J", ".5g"))
    kind: str | None = field(metadata=shown("kind", missing="no minimum"))
    certificate: str
    full_space: str | None = field(metadata=shown("full space"))


@dataclass(frozen=True)
class HeldBarrier:
    """A barrier of a design, as measured.

    Attributes
    ----------
    start, end
        Names of states.
    rise
        Highest energy on the way less that of `start` [J]; nan where not known.
    fold_angles
        Where it is highest, [N].
    why
        What is wrong with it; "" where it is as asked.
    """

    start: str
    end: str
    rise: float
    fold_angles: tuple[float, ...]
    why: str


@dataclass(frozen=True)
class ExtraMinimum:
    """A minimum that nobody asked for.

    Attributes
    ----------
    energy
        In the scene's units.
    kind
        Of the minimum.
    fold_angles
        All N [rad].
    """

    energy: float = field(metadata=shown("energy", "J", ".5g"))
    kind: str = field(metadata=shown("kind"))
    fold_angles: tuple[float, ...] = field(metadata=shown("fold angles", "rad", ".2f"))


@dataclass(frozen=True, repr=False)
class Design(Report):
    """Springs for given states, checked by the main job; or the reason why there are none.

    Attributes
    ----------
    targets
        The question.
    margin
        Smallest stiffness along a free motion of a state, and smallest moment of a pressed contact [per rad], both over
        the mean stiffness; the largest that any springs have, unless barriers were made largest.  At most
        0, or -inf, where there are none.
    scene
        The scene, or the pattern, with the springs; None where there are none.
    states
        Each target, as found in the scene.
    extra_minima
        Minima of the scene that nobody asked for.
    reason
        Why there are no springs; None where there are.
    failed
        What the check of the scene found wrong, in words; empty for a verified design.
    minima
        The whole search for the minima of the scene.
    iterations
        Of the conic solver.
    residual
        Of its dual: the margin is the largest to about this.
    barriers
        Those that were asked for, as measured.
    refuted
        Where there is no scene: whether it is proved that no springs do what was asked.

    Examples
    --------
    >>> import math, origami_nlp as o
    >>> vertex = o.Vertex(("pi/2",) * 4)
    >>> straight = (math.pi / 3, 0.0, math.pi / 3, 0.0)
    >>> answer = o.design(o.inverse_design.Targets(vertex, (o.inverse_design.Target("book", straight),)))
    >>> answer.feasible, [state.name for state in answer.states]
    (True, ['book'])
    """

    PICTURE, SCHEMA, READS, ROWS = "draw_design", "origami-nlp/design/3", False, "states"
    ALSO = ("feasible", "verified")

    targets: Targets = field(metadata={"plain": False})
    margin: float
    scene: Scene | Pattern | None = None
    states: tuple[HeldState, ...] = ()
    extra_minima: tuple[ExtraMinimum, ...] = ()
    reason: Infeasibility | None = None
    failed: tuple[str, ...] = ()
    minima: MinimaResult | None = field(default=None, metadata={"plain": False})
    iterations: int = 0
    residual: float = 0.0
    barriers: tuple[HeldBarrier, ...] = ()
    refuted: bool = False

    @property
    def feasible(self) -> bool:
        """Whether springs with a positive margin exist."""
        return self.scene is not None

    @property
    def verified(self) -> bool:
        """Whether the main job found and certified every state."""
        return self.feasible and not self.failed

    @property
    def verdict(self) -> str:
        """Whether springs hold the states, in a sentence."""
        title = printable(self.targets.source) or "design"
        if self.reason is not None:
            proved = "" if self.refuted else " was found, which proves nothing"
            return f"{title}: no design{proved}: {self.reason.text}"
        n, more = len(self.states), len(self.extra_minima)
        if self.failed:
            return f"{title}: springs for {n} states, NOT verified: {self.failed[0]}"
        held = "the state" if n == 1 else f"all {n} states"
        status = getattr(getattr(self.minima, "completeness", None), "status", "not proved")
        known = f"margin {self.margin:.4g}, list {status}"
        return (
            f"{title}: springs hold {held} asked for, {more or 'no'} other minima found ({known})"
        )

    def report_sections(self) -> Iterator[Section]:
        """Return the verdict, states, springs, other minima, what is not proved, and the details of the solution."""
        if self.reason is not None:
            yield Words(self.verdict)
            for change in self.reason.changes:
                yield Words(f"what would help, alone: {change}")
            return
        yield record_table(self.states, self.verdict)
        assert self.scene is not None
        yield record_table(springs_of(self.scene), "Springs")
        for b in self.barriers:
            yield Words(f"barrier from {b.start} to {b.end}: {b.rise:.6g} J")
        for words in self.failed[1:]:
            yield Words(f"not verified: {words}")
        if self.extra_minima:
            yield record_table(self.extra_minima, "not asked for", narrow=True)
        known = self.minima and self.minima.completeness
        if known:
            yield from known.open_lines()
        if self.minima and not (known and known.proved):
            yield from self.minima.search.open_lines()
