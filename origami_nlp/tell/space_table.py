"""Tables of an admissible space and of the transitions of a family."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from origami_nlp.judge.space import Space
from origami_nlp.judge.space_transitions import Sweep
from origami_nlp.state.angles import format_angle


def print_space(space: Space, console: Console) -> None:
    """Print components, pinch points and handles of a space."""
    title = f"{space.scene.name or 'scene'}: {len(space.components)} component(s), "
    title += f"{space.holes} hole(s), Euler characteristic {space.euler_characteristic}"
    table = _table(title, ("component", "dimension", "chi", "holes", "a state of it"))
    for k, part in enumerate(space.components, start=1):
        state = _angles(part.fold_angles)
        table.add_row(
            str(k), str(part.dimension), str(part.euler_characteristic), str(part.holes), state
        )
    console.print(table)
    if space.pinch_points:
        heads = ("where branches meet", "dimensions", "contacts", "state")
        table = _table("", heads)
        for pinch in space.pinch_points:
            branches = " + ".join(str(d) for d, _ in pinch.branches)
            contacts = "; ".join(pinch.contacts) or "-"
            table.add_row(pinch.kind, branches, contacts, _angles(pinch.fold_angles))
        console.print(table)
    if space.handles:
        table = _table("", ("handle", "length [rad]", "from", "to", "ends"))
        for handle in space.handles:
            first, last = (_angles(handle.fold_angles[k]) for k in (0, -1))
            names = "; ".join(handle.contacts)
            table.add_row(names, f"{handle.length:.4f}", first, last, " / ".join(handle.ends))
        console.print(table)
    joins = space.picture_joins
    if joins:
        console.print(
            f"The picture in the paper's chart encloses {space.picture_holes} hole(s), the space {space.holes}: "
            "these chart points carry states that are apart in the space"
        )
        for point, states in joins:
            shown = " | ".join(_angles(phi) for phi in states)
            console.print(f"  ({_angles(point)}): {shown}")


def print_transitions(sweep: Sweep, console: Console) -> None:
    """Print where the space of a family changes, and how each change was confirmed."""
    count = len(sweep.transitions)
    console.print(
        f"{sweep.family}: {count} transition(s), {len(sweep.samples)} sector angles swept"
    )
    for t in sweep.transitions:
        console.print(
            f"\n[bold]alpha_1 = {t.alpha:.15f}[/bold] = {format_angle(t.alpha)}: {', '.join(t.changes)}"
        )
        if t.bracket is None:
            console.print("  not seen by the sweep: both sides are alike")
        else:
            half = (t.bracket[1] - t.bracket[0]) / 2
            console.print(f"  the sweep's bracket: {sum(t.bracket) / 2:.9f} +- {half:.0e}")
        table = _table("", ("", "components", "holes", "chi", "handles", "drawn holes", "corners"))
        for name, s in (("below", t.below), ("at", t.at), ("above", t.above)):
            cells = (*s.topology[:3], s.topology[5], s.picture_holes)
            corners = "-" if s.topology[5] else str(sum(n for _, n in s.corners))
            table.add_row(name, *(str(c) for c in cells), corners)
        console.print(table)
        before, after = dict(t.below.corners), dict(t.above.corners)
        for what, one, other in (("gone", before, after), ("new", after, before)):
            for contacts in sorted(c for c in one if other.get(c) != one[c]):
                console.print(f"  corner {what}: {'; '.join(contacts)}")
        if t.creases:
            console.print(f"  creases that meet: {', '.join(f'{i} on {j}' for i, j in t.creases)}")
        console.print("  contacts that become dependent:")
        for contacts in t.contacts:
            console.print(f"    {'; '.join(contacts)}")
        console.print(f"  states admissible on one side only: {len(t.witnesses)}")
        for w in t.witnesses:
            side = "below" if w.admissible[0] else "above"
            state = ", ".join(f"{v:.4f}" for v in w.fold_angles[1])
            console.print(f"    {side}, with {'; '.join(w.kept)} held: ({state})")
    for a, b in sweep.unexplained:
        console.print(f"unexplained: the signature changes between {a:.9f} and {b:.9f}")
    for a in sweep.silent:
        console.print(f"silent: contacts become dependent at {a:.12f}, and nothing changes")


def _table(title: str, heads: tuple[str, ...]) -> Table:
    table = Table(title=title or None, title_justify="left")
    for head in heads:
        table.add_column(Text(head))
    return table


def _angles(values: object) -> str:
    return ", ".join(format_angle(v) for v in values)  # type: ignore[attr-defined]
