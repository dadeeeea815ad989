"""Section 4, second part: symmetry breaking and the counting of folded states.

A state is a word of N/2 flaps, V (partial angle rho_v) or M (rho_m), at a given elevation.  Rigid
rotations act on words by cyclic shifts, mirror images by reversal; all counts are exact
enumerations of orbits, and Burnside's lemma gives the formulas for every N.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..claims._section4_angles import compare
from ..claims.section4_cone import crease3
from ..cone import (
    ALPHA_PAIR,
    ELEVATION,
    azimuth,
    exact,
    lift,
    multiple,
    root,
    turn,
)
from ..decide import Correction, by_cases, refuted
from ..rotations import E1, E2, E3
from ..statement import WHOLE, Several, one_of, row
from ..symbols import upsilon

Word = tuple[int, ...]
N = sp.Symbol("N", positive=True, integer=True)
DEGREES = tuple(range(6, 31, 2))
TABLE = (4, 6, 8, 14, 20, 36, 60, 108, 188, 352, 632, 1182, 2192)
"""The printed table, N = 6, 8, .., 30."""


def words(flaps: int) -> list[Word]:
    """All assignments: 1 for valley, 0 for mountain."""
    return list(product((0, 1), repeat=flaps))


def shifts(word: Word) -> list[Word]:
    """Images under the rotations by multiples of 2 alpha."""
    return [word[i:] + word[:i] for i in range(len(word))]


def images(word: Word) -> list[Word]:
    """Images under the dihedral group of order 2 n (with repetitions)."""
    return [w for s in shifts(word) for w in (s, s[::-1])]


def orbit_count(flaps: int, action: Callable[[Word], list[Word]]) -> int:
    """Number of orbits by enumeration of least representatives, on integers for speed."""
    seen = bytearray(2**flaps)
    mirrored = action is images
    mask = 2**flaps - 1
    count = 0
    for code in range(2**flaps):
        if seen[code]:
            continue
        count += 1
        starts = [code]
        if mirrored:
            starts.append(int(format(code, f"0{flaps}b")[::-1], 2))
        for start in starts:
            for _ in range(flaps):
                seen[start] = 1
                # cyclic shift of a word of bits
                start = ((start << 1) & mask) | (start >> (flaps - 1))
    return count


def cycle_count(flaps: int, shift: int, mirrored: bool) -> int:
    """Number of cycles of one group element on the flap positions."""
    image = [((-i if mirrored else i) + shift) % flaps for i in range(flaps)]
    seen: set[int] = set()
    cycles = 0
    for start in range(flaps):
        cycles += start not in seen
        i = start
        while i not in seen:
            seen.add(i)
            i = image[i]
    return cycles


def burnside(flaps: int, mirrors: bool) -> sp.Rational:
    """Orbits of 2-colourings by Burnside's lemma: the mean of 2^cycles over the group."""
    kinds = (False, True) if mirrors else (False,)
    # a group element keeps a word that is constant on each of its cycles: 2^cycles of them
    total = sum(2 ** cycle_count(flaps, r, m) for r in range(flaps) for m in kinds)
    return sp.Rational(total, flaps * len(kinds))


def bracelet_formula(weight: Any, even: Any, odd: Any) -> Callable[[int], Any]:
    """The printed formula with its prefactor and its two additive terms as functions of N."""

    def value(degree: int) -> Any:
        half = degree // 2
        total = sum(sp.totient(d) * 2 ** (half // d) for d in sp.divisors(half))
        extra = even if half % 2 == 0 else odd
        return sp.sympify(weight).subs(N, degree) * total + sp.sympify(extra).subs(N, degree)

    return value


PRINTED = (1 / N, sp.Rational(3, 4) * 2 ** (N / 4), sp.Rational(1, 2) * 2 ** ((N / 2 + 1) / 2))


def _check_formula(statement: tuple[Any, Any, Any]) -> Verdict:
    """Printed formula against Burnside (N = 6..120) and against enumeration (N = 6..30)."""
    value = bracelet_formula(*statement)
    for degree in range(6, 121, 2):
        flaps = degree // 2
        counted = burnside(flaps, True)
        if value(degree) != counted:
            return refuted(
                f"N = {degree}: the formula gives {value(degree)}, there are {counted} bracelets.",
                "exact enumeration",
                None,
            )
        if degree in DEGREES and orbit_count(flaps, images) != counted:
            return Verdict(
                "unproved", "enumeration", f"Burnside and enumeration differ, N = {degree}"
            )
    return Verdict(
        "proved",
        "Burnside's lemma",
        "Rotations contribute sum psi(d) 2^(n/d), n = N/2; the n mirrors fix 2^((n+1)/2) words each "
        "for odd n, and n/2 each of 2^(n/2) and 2^(n/2+1) for even n; divided by 2n = N this is the "
        "formula.  Orbits enumerated for N = 6..30 and cycles counted for N = 6..120 agree.",
    )


def _check_equivalence(statement: str) -> Verdict:
    """Orbits under rigid rotations must be counted by `statement`: "bracelets", "necklaces" or "words"."""
    count: dict[str, Callable[[int], Any]] = {
        "bracelets": lambda n: burnside(n, True),
        "necklaces": lambda n: burnside(n, False),
        "words": lambda n: 2**n,
    }
    for degree in DEGREES:
        rigid = orbit_count(degree // 2, shifts)
        counted = count[statement](degree // 2)
        if rigid == counted:
            continue
        word = (1, 1, 0, 1, 0, 0)
        chiral = word[::-1] not in shifts(word)
        return refuted(
            f"N = {degree}: {rigid} states up to rotation, {counted} {statement}.  For N = 12 the word "
            f"VVMVMM and its mirror image MMVMVV are {'not ' if chiral else ''}shifts of each other: "
            "one state is the mirror image of the other, not a rigid rotation of it (a reflection is "
            "not a rotation; turning the vertex over would change the sign of upsilon).",
            "exact enumeration",
            Correction(
                r"\mathcal{N}_{\mathrm{rot}}(N)=\frac{2}{N}\sum_{d|(N/2)}\psi(d)\,2^{N/2d}"
                r"\ (\text{necklaces});\ \text{bracelets count states up to rotation and reflection}",
                _necklaces_proved,
                "up to rigid rotation the states are necklaces, up to rotation and reflection "
                "bracelets; the counts agree for N <= 10 and differ from N = 12 on.",
            )
            if statement == "bracelets"
            else None,
        )
    return Verdict("proved", "exact enumeration", f"Orbits of shifts are {statement}, N = 6..30.")


def _necklaces_proved() -> bool:
    formula = bracelet_formula(2 / N, 0, 0)
    return all(
        orbit_count(d // 2, shifts) == burnside(d // 2, False) == formula(d) for d in DEGREES
    )


def _check_table(statement: tuple[int, ...]) -> Verdict:
    """Every entry of the table against the printed formula (bracelets), by enumeration."""
    bracelets = [orbit_count(d // 2, images) for d in DEGREES]
    necklaces = [orbit_count(d // 2, shifts) for d in DEGREES]
    wrong = [
        f"N={d}: {t} for {b}"
        for d, t, b in zip(DEGREES, statement, bracelets, strict=True)
        if t != b
    ]
    if not wrong:
        return Verdict("proved", "exact enumeration", "All 13 entries are numbers of bracelets.")
    remark = (
        "  All 13 printed entries are numbers of NECKLACES (states up to rotation)."
        if list(statement) == necklaces
        else ""
    )
    right = ",".join(map(str, bracelets))
    return refuted(
        f"{len(wrong)} of {len(statement)} entries disagree with the formula: {'; '.join(wrong)}."
        + remark,
        "exact enumeration",
        Correction(
            rf"\mathcal{{N}}(6,8,\dots,30)={right}",
            lambda: [bracelet_formula(*PRINTED)(d) for d in DEGREES] == bracelets,
            "bracelet numbers from the printed formula, equal to enumerated orbits.",
        )
        if list(statement) == list(TABLE)
        else None,
    )


def stabilizer(word: Word) -> str:
    """Name of the subgroup of D_n that fixes a word: C_m or D_m."""
    rotations = sum(s == word for s in shifts(word))
    mirrors = sum(s[::-1] == word for s in shifts(word))
    return f"{'D' if mirrors else 'C'}{rotations}"


def classes(flaps: int) -> list[tuple[str, int]]:
    """(symmetry, orbit size) of every class up to rotation and reflection."""
    found: dict[Word, tuple[str, int]] = {}
    for word in words(flaps):
        key = min(images(word))
        found.setdefault(key, (stabilizer(word), len(set(images(word)))))
    return sorted(found.values())


_ORDERS = {"C1": 1, "C2": 2, "C4": 4, "D1": 2, "D2": 4, "D4": 8}
"""Subgroups of D_4 and their orders."""


def _check_eight(statement: tuple[tuple[str, int], ...]) -> Verdict:
    """Symmetry and orbit size of the classes at N = 8, and the orbit-stabilizer theorem."""
    found = classes(4)
    return by_cases(
        [
            (f"classes are {found}", sorted(statement) == found),
            ("orbit size times |stabilizer| = 8", all(s * _ORDERS[n] == 8 for n, s in found)),
            ("orbit sizes sum to 16", sum(s for _, s in found) == 16),
            ("no two classes merge or split without mirrors", orbit_count(4, shifts) == len(found)),
        ],
        "VVVV, MMMM: D4, orbit 1; VMVM: D2, orbit 2; VVVM, VMMM, VVMM: D1, orbit 4; sum 16.  At "
        "N = 8 rotations alone give the same six classes.",
        "exact enumeration",
    )


def _fold_multiset(word: Word) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Fold angles of odd and of even creases in the independent symbols rho_v, rho_m, |v|."""
    rv, rm, v = sp.symbols("rho_v rho_m v")
    partial = [rv if flap else rm for flap in word]
    # paper, eq. 4.5
    odd = tuple(partial[i - 1] + partial[i] for i in range(len(word)))
    even = tuple(-2 * v if flap else 2 * v for flap in word)
    return odd, even


def _check_subgroup(statement: int) -> Verdict:
    """Symmetries of the folded 8-vertex among the 16 of the flat one: those of D_n, n = `statement`.

    A rotation by an odd multiple of alpha would exchange odd and even creases.  The even angles
    take one value 4 times, or two values 3+1 or 2+2 times; the odd ones, with rho_v > 0 > rho_m and
    rho_v != -rho_m, take values with other multiplicities or of the other sign.
    """
    cases = []
    for word in words(4):
        odd, even = _fold_multiset(word)
        shape = [sorted(angles.count(a) for a in set(angles)) for angles in (odd, even)]
        uniform = len(set(word)) == 1  # 2 rho_v > 0 > -2 |v|: opposite signs, never equal
        cases.append(
            (f"odd and even fold angles of {word} differ", shape[0] != shape[1] or uniform)
        )
        # orbit-stabilizer theorem for the rotations
        larger = len({s for s in shifts(word)}) * sum(s == word for s in shifts(word)) == 4
        cases.append((f"rotations of {word} lie in C_4", larger))
    order = 2 * statement
    largest = max(sum(w == word for w in images(word)) for word in words(4))
    cases.append(
        (f"the largest symmetry has order {largest}, D_{statement} has {order}", largest == order)
    )
    return by_cases(
        cases,
        "Odd and even fold angles never agree as multisets, so no symmetry of the flat D_8 pattern "
        "outside D_4 survives.",
        "exact enumeration",
    )


def _check_count(statement: Any) -> Verdict:
    """Number of distinct fold-angle vectors at a given v != 0, N = 6..20."""
    cases = []
    for degree in range(6, 21, 2):
        distinct = {_fold_multiset(word)[1] for word in words(degree // 2)}
        claimed = sp.sympify(statement).subs(N, degree)
        cases.append(
            (f"N = {degree}: {len(distinct)} states against {claimed}", len(distinct) == claimed)
        )
    return by_cases(
        cases,
        "The signs of the even fold angles spell the word, so the 2^(N/2) words give distinct states.",
        "exact enumeration",
    )


def _check_breaking(statement: tuple[int, int, Any]) -> Verdict:
    """Each flap maps the elevated frame of one odd crease onto that of the next, whatever its kind.

    statement: (index offsets of the two partial angles at an odd crease j, factor f of
    phi_even = f sgn(rho) |v|).  Flap: Q(b_1, rho) Q(b_2, phi_2) Q(b_3, rho) = Q(e2, -v) Q(axis_3, v)
    for both kinds; the product over all flaps telescopes to the identity for every word.
    """
    left, right, factor = statement
    back = (ELEVATION[0], -ELEVATION[1])
    axis = turn(E3, multiple(ALPHA_PAIR, 2), E2)
    pairs: list[tuple[Any, Any, int]] = []
    for kind, side in (("valley", 1), ("valley", -1), ("mountain", 1), ("mountain", -1)):
        rho = root(kind, side)
        sgn = 1 if kind == "valley" else -1
        angle = factor * sgn * sp.Abs(upsilon)
        fold = (exact(sp.cos(angle), side), exact(sp.sin(angle), side))
        for v in (E1, E2, E3):
            flap = turn(E1, rho, turn(azimuth(1), fold, turn(azimuth(2), rho, v)))
            pairs.append((flap, turn(E2, back, turn(axis, ELEVATION, v)), side))
    verdict = compare(
        "flap transfer",
        pairs,
        "Q(b_1, rho) Q(b_2, -2 sgn(rho)|v|) Q(b_3, rho) is the same rotation for both kinds of flap, "
        "from the elevated frame of crease 1 to that of crease 3; so any word closes, phi_j is the "
        "sum of the partial angles before (j-2) and after (j) an odd crease, and crease 1 uses N-1.",
        None,
    )
    if verdict.verdict == "proved" and (left, right) != (-2, 0):
        return refuted(
            f"The flap before crease j is indexed j - 2 and the one after it j, not ({left}, {right}): "
            "for the word VMM of N = 6 crease 3 would get the angle of another crease.",
            "index count",
            None,
        )
    return verdict


def _check_same_crease(statement: Any) -> Verdict:
    """Crease 3 is in the same place whichever root flap 1 takes: prerequisite of mixing roots."""
    valley, mountain = (lift(azimuth(statement), root(k, 1)) for k in ("valley", "mountain"))
    shifted = crease3(2)
    pairs: list[tuple[Any, Any, int]] = [(valley, mountain, 1)]
    if statement == 0:
        pairs.append((turn(E3, multiple(ALPHA_PAIR, 2), valley), shifted, 1))
    return compare(
        "odd creases in the same place for both roots",
        pairs,
        "c_1, and with it every odd crease, depends on v only; the even creases do not share this.",
        None,
    )


CLAIMS: list[Claim] = [
    Claim(
        "s4.mixing",
        "sec. 4, symmetry breaking",
        "Odd creases do not move when a flap changes its root",
        0,
        r"\hat{c}_{2i+1}(\upsilon)\ \text{is the same for}\ \rho_v\ \text{and}\ \rho_m",
        _check_same_crease,
        damaged=(1, 2),
        origin="own derivation",
    ),
    Claim(
        "s4.breaking",
        "sec. 4, fold angles with broken symmetry",
        "Fold angles of a mixed assignment",
        (-2, 0, -2),
        r"\phi_1=\rho_1+\rho_{N-1},\quad \phi_j=-2\,\mathrm{sgn}(\rho_{j-1})|\upsilon|\ (j\ "
        r"\text{even}),\quad \phi_j=\rho_{j-2}+\rho_j\ (j\ \text{odd})",
        _check_breaking,
        damaged=((-2, 0, 2), (-2, 0, -1), (0, 2, -2)),
    ),
    Claim(
        "s4.states",
        "sec. 4, combinatorics",
        "Folded states for a given elevation",
        2 ** (N / 2),
        r"2^{N/2}\ \text{folded states for a given }\upsilon",
        _check_count,
        damaged=(2 ** (N / 2 + 1), 2 ** (N / 2 - 1), N**2),
    ),
    Claim(
        "s4.eight-classes",
        "sec. 4, fig. 8-fold symmetry breaking",
        "Six states at N = 8 with their symmetries and orbits",
        (("D4", 1), ("D4", 1), ("D2", 2), ("D1", 4), ("D1", 4), ("D1", 4)),
        r"2\times(D_4,1),\ 1\times(D_2,2),\ 3\times(D_1,4):\quad 1+1+2+4+4+4=16",
        _check_eight,
        damaged=(
            (("D4", 1), ("D2", 2), ("D2", 2), ("D1", 4), ("D1", 4), ("D1", 4)),
            (("D4", 1), ("D4", 1), ("C2", 2), ("D1", 4), ("D1", 4), ("D1", 4)),
        ),
        form=Several(row(one_of(*_ORDERS), WHOLE)),
    ),
    Claim(
        "s4.eight-subgroups",
        "sec. 4, N = 8",
        "Symmetry of each solution is a subgroup of D_4",
        4,
        r"\mathrm{Sym}(\text{state})\le D_4",
        _check_subgroup,
        damaged=(8, 2),
    ),
    Claim(
        "s4.equivalence",
        "sec. 4, 'up to rigid body rotations ... bracelets'",
        "Unique solutions up to rigid rotation",
        "bracelets",
        r"\#\{\text{states up to rigid rotation}\}=\#\{\text{bracelets, }N/2\text{ beads, 2 colours}\}",
        _check_equivalence,
        damaged=("words",),
        corrected="necklaces",
        form=one_of("bracelets", "necklaces", "words"),
        root="necklaces or bracelets",
    ),
    Claim(
        "s4.bracelet-formula",
        "sec. 4, bracelet formula",
        "Number of bracelets",
        PRINTED,
        r"\mathcal{N}(N)=\frac1N\sum_{d|(N/2)}\psi(d)2^{N/2d}+\begin{cases}\frac34 2^{N/4}&N/2\text{ even}"
        r"\\\frac12 2^{(N/2+1)/2}&N/2\text{ odd}\end{cases}",
        _check_formula,
        damaged=(
            (2 / N, PRINTED[1], PRINTED[2]),
            (1 / N, sp.Rational(1, 2) * 2 ** (N / 4), PRINTED[2]),
            (1 / N, PRINTED[1], sp.Rational(1, 2) * 2 ** (N / 4)),
        ),
    ),
    Claim(
        "s4.table",
        "sec. 4, tab:necklaces",
        "Number of single degree of freedom foldings, N = 6..30",
        TABLE,
        r"\mathcal{N}=4,6,8,14,20,36,60,108,188,352,632,1182,2192",
        _check_table,
        damaged=(
            (4, 6, 8, 13, 18, 30, 46, 78, 126, 224, 380, 687, 1225),
            (4, 6, 9, 13, 18, 30, 46, 78, 126, 224, 380, 687, 1224),
        ),
        corrected=(4, 6, 8, 13, 18, 30, 46, 78, 126, 224, 380, 687, 1224),
        root="necklaces or bracelets",
    ),
]
