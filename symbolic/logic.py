"""Set arguments about minima, decided by enumerating every landscape on a few neighbours."""

from __future__ import annotations

from functools import cache
from itertools import pairwise, product

SPACES = ("relaxed", "physical", "symmetric")


@cache
def energy_orders() -> frozenset[tuple[str, str]]:
    """Pairs (A, B) with 'a minimum in A is a minimum in B' true in every landscape.

    A neighbour is a triple (higher than the candidate, contact-admissible, symmetric); symmetric
    neighbours count in the symmetric space only when contact-admissible.  'x is a minimum in A' is
    a universal statement over neighbours, so three of them exhibit every failure there is.
    """
    valid = {(a, b) for a in SPACES for b in SPACES}
    kinds = list(product((True, False), repeat=3))
    for neighbours in product(kinds, repeat=3):
        stable = {
            "relaxed": all(higher for higher, _, _ in neighbours),
            "physical": all(higher for higher, admissible, _ in neighbours if admissible),
            "symmetric": all(h for h, admissible, sym in neighbours if admissible and sym),
        }
        valid -= {(a, b) for a in SPACES for b in SPACES if stable[a] and not stable[b]}
    return frozenset(valid)


def counting_order(names: tuple[str, str, str]) -> bool:
    """Whether N_names[0] <= N_names[1] <= N_names[2] holds for the candidates of any landscape."""
    orders = energy_orders()
    return all((a, b) in orders for a, b in pairwise(names))
