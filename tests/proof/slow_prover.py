"""A plain prover of completeness, one box after the other: proofs for the check to read, and to be misled by.

It searches with the arithmetic of the check itself, so that its proofs say nothing of that arithmetic; they say
what the check does with a proof, good or bad.
"""

import itertools
import math
from functools import cache

import numpy as np
from flint import arb, ctx

from origami_nlp.pattern import Scene
from origami_nlp.problem import Model
from origami_nlp.proof import certificate as c, certificate_of, prove
from origami_nlp.proof.check_bounds import States
from origami_nlp.proof.check_forms import nonzero
from origami_nlp.proof.check_points import CheckedStratum, Refused
from tests.proof.balls import scene, sheet_of

R0, SMALL, TINY = 1e-3, 1e-2, 1e-7


class Prover:
    def __init__(self, stated: Scene) -> None:
        self.scene = stated
        with ctx.workprec(128):
            self.fine = sheet_of(stated)
        self.sheet = sheet_of(stated)
        self.points, self.undecided, self.kinds, self.numbers, self.boxes = [], [], [], [], []

    def node(self, kind: int, number: int = 0) -> None:
        self.kinds.append(kind)
        self.numbers.append(number)

    def prove(self) -> c.Certificate:
        up = math.nextafter(math.pi, 4)
        for pins in itertools.product((0, 1, -1), repeat=self.scene.degree):
            self.stratum(pins, tuple((s * math.pi,) * 2 if s else (-up, up) for s in pins))
        nodes = c.Nodes(
            np.array(self.kinds, np.uint8),
            np.array(self.numbers, np.int32),
            np.array(self.boxes, float).reshape(-1, 2, self.scene.degree),
        )
        return c.Certificate(self.scene, R0, tuple(self.points), (), tuple(self.undecided), nodes)

    def stratum(self, pins, whole) -> None:
        stack = [whole]
        free = [j for j, s in enumerate(pins) if not s]
        while stack:
            box = stack.pop()
            states = States(self.sheet, box, pins)
            if states.empty:
                self.node(c.CLOSED)
                continue
            if (leaf := self.leaf(box, pins, free)) is not None:
                self.node(*leaf)
                continue
            new = states.narrowed(box)
            wide = [(b - a) * 1e-9 for a, b in box]
            new = tuple(
                (max(a, p - w), min(b, q + w))
                for (a, b), (p, q), w in zip(box, new, wide, strict=True)
            )
            shares = [(new[j][1] - new[j][0]) / (box[j][1] - box[j][0] or 1) for j in free]
            if math.prod(shares) < 0.5:
                self.node(c.CONTRACT)
                self.boxes.append([[a for a, _ in new], [b for _, b in new]])
                stack.append(new)
                continue
            axis = max(free, key=lambda j: box[j][1] - box[j][0])
            self.node(c.SPLIT, axis)
            low, high = box[axis]
            middle = 0.5 * (low + high)
            for half in ((middle, high), (low, middle)):
                stack.append((*box[:axis], half, *box[axis + 1 :]))

    def leaf(self, box, pins, free):
        for four in itertools.combinations(free, 4):
            if nonzero(next(self.sheet.minors([four], box, pins))):
                return c.MINOR, sum(1 << i for i in four)
        for a, b in itertools.combinations(free, 2):
            row = self.sheet.twin_row(a, b, box, pins)
            if row is not None and nonzero(row):
                return c.TWIN, a * len(box) + b
        if not any(pins) and all(-R0 <= a and b <= R0 for a, b in box):
            return c.FLAT, 0
        width = max((box[j][1] - box[j][0] for j in free), default=0.0)
        if width < SMALL and len(free) >= 3:
            number = self.holding(box, pins, free)
            if number is None and self.locate(box, pins):
                number = self.holding(box, pins, free)
            if number is not None:
                return c.ROOT, number
        if width < TINY:
            lower, upper = ([e[k] for e in box] for k in (0, 1))
            self.undecided.append(c.UndecidedBox(tuple(lower), tuple(upper), pins, "tiny"))
            return c.UNDECIDED, len(self.undecided) - 1
        return None

    def holding(self, box, pins, free):
        for number, p in enumerate(self.points):
            r = p.unique_radius * (1 - 1e-9)
            if p.stratum == pins and all(
                p.x[j] - r <= box[j][0] and box[j][1] <= p.x[j] + r for j in free
            ):
                return number
        return None

    def locate(self, box, pins) -> bool:
        x = [math.pi * s if s else 0.5 * (a + b) for s, (a, b) in zip(pins, box, strict=True)]
        with ctx.workprec(128):
            return self.located(x, pins)

    def located(self, x, pins) -> bool:
        try:
            stratum = CheckedStratum(self.fine, pins)
            _, _, axes = self.fine.chain(stratum.angles([arb(x[i]) for i in stratum.free]))
            matrix = np.array([[float(v.mid()) for v in axes[i]] for i in stratum.free])
            k, rest = self.scene.stiffness, self.scene.rest_angles
            torque = [k[i] * (x[i] - rest[i]) for i in stratum.free]
            start = np.linalg.lstsq(matrix, torque)[0].tolist()
            found = stratum.locate(x, start)
            near = [float(a.mid()) for a in found.x]
            if any(p.stratum == pins and np.allclose(p.x, near, atol=1e-9) for p in self.points):
                return False
            radius = 0.02
            while radius > 1e-6 and not self.alone(stratum, near, radius, found.moment):
                radius /= 2
        except Refused:
            return False
        self.points.append(
            c.CertifiedPoint(
                x=tuple(near),
                stratum=pins,
                moment=tuple(float(m.mid()) for m in found.moment),
                radius=2 * max(float(a.rad()) for a in found.x) + 1e-15,
                unique_radius=radius,
                index=found.index,
                pinned_signs=found.signs,
                energy=float(found.energy.mid()),
                is_minimum=found.is_minimum,
            )
        )
        return True

    @staticmethod
    def alone(stratum, x, radius, moment) -> bool:
        try:
            return stratum.alone(x, radius, moment)
        except Refused:
            return False


@cache
def proved(degree: int, seed: int) -> c.Certificate:
    """The certificate of `tests.proof.balls.scene`, made once."""
    stated = scene(degree, seed)
    return certificate_of(stated, prove(Model(stated), record=True))


@cache
def proved_slowly(degree: int, seed: int) -> c.Certificate:
    """The same, by the prover of this file."""
    with ctx.workprec(64):
        return Prover(scene(degree, seed)).prove()
