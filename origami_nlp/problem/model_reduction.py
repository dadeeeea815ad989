"""Which contacts a scene needs, and which it leaves out, with the reason."""

from __future__ import annotations

from origami_nlp.pattern import Scene, windings_of
from origami_nlp.problem.gaps import Gap, LeftOut, can_cross


def enumerate_gaps(
    scene: Scene,
) -> tuple[tuple[Gap, ...], tuple[tuple[int, int], ...], tuple[LeftOut, ...]]:
    """List the gaps beyond fold limits that `scene` needs.

    Returns
    -------
    gaps
        Mirror, axis and facet-pair contacts, as rays of the modelled piece.
    pairs
        The facet pairs among them, as positions of their first rays.
    left_out
        What was not modelled, and why (facets and creases 1-based).
    """
    group = scene.group
    left: list[LeftOut] = []
    if not group.is_trivial:
        kept = len({r for r in group.orbit})
        left.append(
            LeftOut(
                f"{scene.degree - kept} of {scene.degree} fold angles",
                f"tied to the other {kept} by {group.name}",
            )
        )
    if scene.adjusted:
        left.append(
            LeftOut(
                f"asymmetry of the data, up to {scene.adjusted:.1e}",
                f"averaged over {group.name}: symmetry_tolerance = {scene.symmetry_tolerance:g}",
            )
        )
    if scene.panels:
        left.append(
            LeftOut(
                f"thickness of panels ({scene.panels[0]:g} mm) but for stops",
                "panels that share no crease, and corners at the vertex, are tested as paper",
            )
        )
    if scene.contact != "full":
        left.append(
            LeftOut("crossing of non-adjacent facets", f'contact = "{scene.contact}" does not ask')
        )
        every = windings_of(group, scene.contact)
        others = [w for w in every if w != (scene.winding or 1)]
        if others:
            often = ", ".join(map(str, others))
            left.append(
                LeftOut(
                    f"symmetric states that wind {often} times around the axis",
                    "each winding is a problem of its own: searches solve all",
                )
            )
        if scene.contact == "none":
            left.append(LeftOut("fold limits |phi| <= pi", 'contact = "none" does not ask'))
            left.append(LeftOut("fold angles beyond 2 pi", "each further turn repeats the shape"))
        return (), (), tuple(left)
    left.append(LeftOut("pairs of adjacent facets", "they cannot cross while |phi| <= pi"))
    gaps: list[Gap] = []
    if group.kind == "D":
        _mirror_gaps(scene, gaps, left)
    pairs = _facet_pairs(scene, gaps, left)
    return tuple(gaps), pairs, tuple(left)


def facet_of_ray(scene: Scene, r: int) -> int:
    """Return the 0-based facet of the vertex that starts at (or, for a mirror ray, contains) ray r."""
    group = scene.group
    if group.kind == "C":
        return r % scene.degree
    crease = group.rays[r].crease
    if crease is not None:
        return crease
    neighbour = group.rays[1 if r == 0 else r - 1].crease
    assert neighbour is not None, "two mirrors cannot bound one facet piece"
    return (neighbour - 1) % scene.degree if r == 0 else neighbour


def _mirror_gaps(scene: Scene, gaps: list[Gap], left: list[LeftOut]) -> None:
    """Keep the wedge between its two mirrors; neighbours of a mirror ray are already kept."""
    group = scene.group
    last = len(group.rays) - 1
    sides = (0,) if group.order == 1 else (0, 1)  # D1: both mirrors are one plane
    for r in range(1, last):
        for side in sides:
            # D1: both mirrors are one plane, so either neighbour counts
            neighbours = {1, last - 1} if group.order == 1 else {(1, last - 1)[side]}
            crease = group.rays[r].crease
            assert crease is not None
            if r in neighbours:
                left.append(
                    LeftOut(
                        f"crease {crease + 1} against a mirror",
                        "next to the mirror: same as the fold limit there, or held by its facet",
                    )
                )
            else:
                gaps.append(Gap("mirror", (r, side), None, 2 * group.order))
    if group.order >= 2:
        # the mirror at the other end of the wedge is the wall that keeps a mirror ray on its own side of the axis
        gaps.append(Gap("axis", (0, 1), None, group.order))
        gaps.append(Gap("axis", (last, 0), None, group.order))
    left.append(
        LeftOut(
            "facets of the wedge against their images",
            "the mirror planes separate them while every ray of the wedge stays between the mirrors",
        )
    )


def _facet_pairs(scene: Scene, gaps: list[Gap], left: list[LeftOut]) -> tuple[tuple[int, int], ...]:
    group, n = scene.group, scene.degree
    sectors = scene.vertex.sector_angles
    pairs: list[tuple[int, int]] = []
    if group.kind == "D":
        candidates = [
            (i, j) for i in range(len(group.rays) - 1) for j in range(i + 2, len(group.rays) - 1)
        ]
        weight = {pair: 2 * group.order for pair in candidates}
    else:
        period = n // group.order
        seen: set[tuple[int, int]] = set()
        candidates, weight = [], {}
        for i in range(period):
            for j in range(i + 2, i + n - 1):
                pair = (i, j % n)
                # one pair for all of its images under C_n: fewer than n where a turn exchanges the two facets
                images = {
                    tuple(sorted(((i + m * period) % n, (j + m * period) % n)))
                    for m in range(group.order)
                }
                if images & seen:
                    continue
                seen |= images  # type: ignore[arg-type]
                first, second = min(pair), max(pair)
                candidates.append((first, second))
                weight[first, second] = len(images)
    rays = n if group.kind == "C" else len(group.rays)
    for i, j in candidates:
        a, b = facet_of_ray(scene, i), facet_of_ray(scene, j)
        if a == b or (a - b) % n in (1, n - 1):
            continue
        if not can_cross(sectors, a, b):
            left.append(
                LeftOut(
                    f"facets {a + 1} and {b + 1}",
                    "too far apart: the sector angles between them cannot bridge the gap",
                )
            )
            continue
        pairs.append((i, j))
        for on, other in ((j, i), (i, j)):
            for k in (other, (other + 1) % rays):
                gaps.append(Gap("facet-pair", (k, on), (i, j), weight[i, j]))
    return tuple(pairs)
