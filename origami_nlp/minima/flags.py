"""What can be bad about a list of minima, and about one of them: a flag each, with cause and cure.

`docs/flags.md` is made from these docstrings: ``python -m tests.minima.test_flags``.
"""

from __future__ import annotations

from dataclasses import dataclass

from origami_nlp.display import Flags


@dataclass(frozen=True, repr=False)
class ResultFlags(Flags):
    """Of a `MinimaResult`: what to know before the list is used.

    Those about the search are down where nothing can be missing: where the list is proved complete.

    Attributes
    ----------
    nothing_found
        No minimum is listed: every start ended elsewhere, or at a state that is not decided. Cure: Look at
        `search.undecided` and `search.rejected`; start from states that you know (`guesses`), or with
        effort="thorough".
    may_miss_minima
        No proof says that the list is complete; there may be minima that no start reached. Cure: prove=True, or
        seconds for it (within fold limits up to four degrees of freedom, with contact where `completeness.reason` does
        not say no); else another `seed`, effort="thorough", and compare.
    singular_states_open
        The list is proved complete but for regions around singular states, where creases lose rank
        (`completeness.singular`). Cure: Judge these states by other means, such as starts near them (`guesses`).
    search_stopped_early
        The search came to its cap on starts, or its time was over, before every minimum was reached often enough. Cure:
        More `max_starts` or `seconds`, or effort="thorough".
    starts_ended_nowhere
        More descents ended nowhere than at a minimum: near singular states steps become short, and very different
        stiffnesses make narrow valleys. Cure: effort="thorough"; `guesses` near the states that you expect.
    reached_once
        A minimum was reached by one drawn start only, so that others like it may have been missed. Cure:
        effort="thorough", or another `seed`.
    still_finding
        The very last drawn start reached a minimum that none before had reached. Cure: More `max_starts`, or
        effort="thorough".
    proof_added_minima
        The proof found minima that the search had missed (`completeness.added`); they are listed. Cure: None is needed
        here, but do not trust a search of this effort on similar scenes without a proof.
    undecided_states
        Some states were neither certified as minima nor refuted; none is listed (`search.undecided`). Cure: Look at
        the reason of each; often a sector angle or a stiffness is nearly special, and making it exactly so, or clearly
        not, decides.
    solver_failed
        IPOPT, asked to confirm the lowest minima, did not converge somewhere (`solver` of each). Certificates do not
        rest on it. Cure: None is needed where certificates are exact; look at `solver` of the minima to see which.
    residual_above_tolerance
        A listed state closes, or balances, less well than states do that Newton has polished. Cure: Do not use its
        digits beyond that; please report the scene.
    geometry_moved
        Sector angles that were special to within 1e-7 rad were moved to be exactly so (`scene.relations`), since
        doubles cannot distinguish the two cases. Cure: State the exact angles, or angles that are clearly different.
    made_symmetric
        Angles or stiffnesses were averaged over the symmetry (`scene.adjusted` is the largest change): the states are
        those of the averaged scene. Cure: A smaller `symmetry_tolerance`, or symmetry="none", to keep what was
        measured.
    facets_may_cross
        Contact between facets that are no neighbours is not modelled, so that a listed state may pass through itself.
        Cure: contact="full", or `check_admissible` each state.
    panels_simplified
        Panels are thick and tapered beside their hinges, which is a stop at each crease. Cure: None in this model;
        contact of panels that share no crease, corners at the vertex and shifted hinges (another kinematics) are not
        in it.
    copies_curl
        Copies of the cell curl freely: these are states of a piece of the sheet, in which contact is with copies a few
        lattice vectors away alone. Cure: None is needed for a piece; else state how the sheet is rolled.
    stability_not_asked
        Only states with the symmetry were compared; a minimum among them may be unstable when the symmetry breaks.
        Cure: full=True, or ``--full``.
    """

    nothing_found: bool = False
    may_miss_minima: bool = False
    singular_states_open: bool = False
    search_stopped_early: bool = False
    starts_ended_nowhere: bool = False
    reached_once: bool = False
    still_finding: bool = False
    proof_added_minima: bool = False
    undecided_states: bool = False
    solver_failed: bool = False
    residual_above_tolerance: bool = False
    geometry_moved: bool = False
    made_symmetric: bool = False
    facets_may_cross: bool = False
    panels_simplified: bool = False
    copies_curl: bool = False
    stability_not_asked: bool = False


@dataclass(frozen=True, repr=False)
class StateFlags(Flags):
    """Of a `JudgedState`: what to know before the state is used.

    Attributes
    ----------
    degenerate
        Loop closure loses rank there, or contacts are dependent, so that the usual second-order test does not apply;
        `certificate` says what was proved instead. Cure: None is needed; expect that small changes of the scene change
        the state, or split it.
    multipliers_not_unique
        Contacts share the load in more than one way: each moment is known only as a range (`multiplier_range`). Cure:
        Quote the range; rigid facets do not say more.
    touching_without_moment
        A closed contact carries no moment: the facets rest on each other, and an arbitrarily small load may open them.
        Cure: None is needed; if the contact is meant to hold, change a rest angle so that it presses.
    isolated
        No other admissible state is near (`local_dimension` is 0): geometry alone holds it, whatever the springs.
        Cure: None is needed; do not read stiffness into it.
    shallow
        An escape path from it is known that climbs by less than 1e-4 of the energy that folds every crease by pi
        (`escape`): errors of rest angles of a hundredth of a degree make such states, and remove them. Cure: Do not
        build on it; `find_minima(..., noise=degrees)` says what survives errors of a size that you state.
    solver_disagrees
        IPOPT, started beside it, ended at a lower state near it (`solver`). Cure: Trust the certificate, which does
        not rest on IPOPT; check the state with `check_admissible` if in doubt.
    residual_above_tolerance
        The state closes, or balances, less well than states do that Newton has polished. Cure: Do not use its digits
        beyond `closure_residual` and `kkt_residual`; please report the scene.
    unstable_in_full_space
        It is a minimum among symmetric states only: a motion that breaks the symmetry lowers the energy
        (`full_space.descent`). Cure: Do not call it stable; `full_space.lands_on` says where it goes.
    not_decided_in_full_space
        Whether it is stable when the symmetry may break was neither proved nor refuted. Cure: Search the scene with
        symmetry="none" from there (`guesses`); do not call it stable.
    """

    degenerate: bool = False
    multipliers_not_unique: bool = False
    touching_without_moment: bool = False
    isolated: bool = False
    shallow: bool = False
    solver_disagrees: bool = False
    residual_above_tolerance: bool = False
    unstable_in_full_space: bool = False
    not_decided_in_full_space: bool = False
