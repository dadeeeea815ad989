"""Tables of an admissible space and of the transitions of a family."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from origami_nlp.pattern import format_angle
from origami_nlp.space.find import Space
from origami_nlp.space.transitions import Sweep


def print_space(space: Space, console: Console) -> None:
    """Print components, pinch points and handles of a space."""
    console.print(
        f"{space.scene.label or 'scene'}: {len(space.components)} component(s), {space.holes} hole(s), "
        f"Euler characteristic {space.euler_characteristic} (mesh of {space.size} rings, "
        f"{len(space.mesh.wedge)} vertices)",
        soft_wrap=True,
    )
    for k, part in enumerate(space.components, start=1):
        console.print(
            f"  component {k}: dimension {part.dimension}, Euler characteristic {part.euler_characteristic}, "
            f"{part.holes} hole(s), such as {_angles(part.fold_angles)}",
            soft_wrap=True,
        )
    for pinch in space.pinch_points:
        dimensions = " + ".join(str(d) for d, _ in pinch.branches)
        contacts = f", {'; '.join(pinch.contacts)}" if pinch.contacts else ""
        state = _angles(pinch.fold_angles)
        console.print(f"  {pinch.kind} ({dimensions}): {state}{contacts}", soft_wrap=True)
    for handle in space.handles:
        first, last = (_angles(handle.fold_angles[k]) for k in (0, -1))
        ends = " to ".join(
            f"{phi} [{end}]" for phi, end in zip((first, last), handle.ends, strict=True)
        )
        console.print(
            f"  handle, {'; '.join(handle.contacts)}, length {handle.length:.4f} rad: {ends}",
            soft_wrap=True,
            markup=False,
        )
    joins = space.picture_joins
    if joins:
        console.print(
            f"  the picture in the paper's chart encloses {space.picture_holes} hole(s), the space {space.holes}: "
            "these chart points carry states that are apart in the space",
            soft_wrap=True,
        )
        for point, states in joins:
            shown = " | ".join(_angles(phi) for phi in states)
            console.print(f"  {_angles(point)}: {shown}", soft_wrap=True)


def print_transitions(sweep: Sweep, console: Console) -> None:
    """Print where the space of a family changes, and how each change was confirmed."""
    count = len(sweep.transitions)
    console.print(
        f"{sweep.family}: {count} transition(s), {len(sweep.samples)} sector angles swept"
    )
    for t in sweep.transitions:
        at = Text(f"alpha_1 = {t.alpha:.15f}", style="bold")
        console.print()
        console.print(at + f" = {format_angle(t.alpha)}: {', '.join(t.changes)}")
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
            state = _angles(w.fold_angles[1])
            console.print(f"    {side}, with {'; '.join(w.kept)} held: {state}")
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
    """Write fold angles for people: multiples of pi as such, others with four decimals."""
    texts = []
    for v in values:  # type: ignore[attr-defined]
        text = format_angle(v) if abs(v) > 1e-12 else "0"
        texts.append(text if "pi" in text or text == "0" else f"{v:.4f}")
    return "(" + ", ".join(texts) + ")"
