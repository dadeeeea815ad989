"""Rank-deficient states are alone: no other critical point within a radius, by a blow-up to second order."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from origami_nlp.numerics import CLOSES, EPS, RANK
from origami_nlp.programme import Kinematics, Model
from origami_nlp.proof.forms import Forms, no_zero

RADII = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
NEAR = 1e-3

Stratum = tuple[int, ...]


@dataclass(frozen=True)
class Isolation:
    point: tuple[float, ...]
    radius: float
    reason: str
    strata: tuple[Stratum, ...]


def isolated(model: Model, x: np.ndarray, stratum: Stratum) -> Isolation:
    point, why = _folded_point(model, np.asarray(x, dtype=float), tuple(stratum))
    if point is None:
        return Isolation(tuple(np.asarray(x, dtype=float).tolist()), 0.0, why, ())
    known = _KNOWN.setdefault(model, {})
    key = tuple(point.tolist())
    if key not in known:
        known[key] = _decided(model, point)
    radius, reason = known[key][tuple(stratum)]
    return Isolation(key, radius, reason, (tuple(stratum),) if radius else ())


_KNOWN: WeakKeyDictionary = WeakKeyDictionary()


def _folded_point(model, x, stratum):
    turns = np.rint(x / math.pi)
    point = turns * math.pi
    if np.abs(x - point).max() > NEAR:
        return None, "not flat-folded"
    if any(s and s != t for s, t in zip(stratum, turns, strict=True)):
        return None, "not on the stratum"
    kinematics = Kinematics(model)
    at = kinematics.fold(point[None])
    if np.abs(kinematics.closure(at)[0]).max() > CLOSES or at.sheet[0] <= 0:
        return None, "no flat-folded state there: does not close"
    return point, ""


def _decided(model, point):
    site = _Site(model, point)
    turns = np.rint(point / math.pi).astype(int)
    strata = list(itertools.product(*[(0, int(t)) if t else (0,) for t in turns]))
    out = {s: (0.0, "") for s in strata}
    open_ = strata
    for radius in RADII:
        faces = no_zero(site.forms(open_, radius))
        for s, empty, u in zip(open_, faces.empty, faces.direction, strict=True):
            out[s] = (
                radius if empty else 0.0,
                "alone" if empty else f"direction {np.round(u, 3).tolist()}",
            )
        open_ = [s for s, empty in zip(open_, faces.empty, strict=True) if not empty]
        if not open_:
            break
    return out


class _Site:
    def __init__(self, model, point):
        kinematics = Kinematics(model)
        m, n = model.equation_count, model.size
        at = kinematics.fold(np.tile(point, (m, 1)))
        jacobian = kinematics.closure(at)[1][0]
        hessian = kinematics.closure_hessian(at, np.eye(m))
        left, size, _ = np.linalg.svd(jacobian)
        size = np.append(size, np.zeros(m))[:m]
        self.rank = int((size > RANK).sum())
        assert (size[self.rank :] < CLOSES).all()
        self.jacobian = left.T @ jacobian
        self.hessian = np.einsum("ab,aij->bij", left, hessian)
        self.m, self.n = m, n
        s = model.structure
        self.lever = 1.0 if s.kind == "D" and s.order > 1 else 0.5
        p = model.parameters
        torque = p.torque(point)
        torque[np.abs(torque) <= 16 * EPS * p.stiffness] = 0.0
        self.scale = float(np.abs(torque).max()) or float(p.stiffness.max())
        self.torque, self.stiffness = torque / self.scale, p.stiffness / self.scale
        self.point = point
        self.axes = at.axes[0][:n]
        self.cyclic = s.kind == "C" and s.order == 1
        self.minors = list(self._minors())

    def _minors(self) -> Iterator[tuple]:
        """Each set S with its constant, linear and quadratic parts and norms."""
        rank, m = self.rank, self.m
        if m - rank > 1:
            return
        for rows in itertools.combinations(range(self.n), m + 1):
            s = list(rows)
            g, k = self.torque[s], self.stiffness[s]
            j = self.jacobian[:rank, s].T
            constant, linear, quadratic = 0.0, np.zeros(self.n), np.zeros((self.n, self.n))
            at_rest = not g.any()
            if rank == m:
                for a in range(m + 1):
                    c = (-1) ** a * np.linalg.det(np.delete(j, a, axis=0))
                    constant += c * g[a]
                    if at_rest:
                        linear[s[a]] += c * k[a]
                h = None
            else:
                h = self.hessian[-1][s]
                for a, b in itertools.permutations(range(m + 1), 2):
                    others = np.delete(j, (a, b), axis=0)
                    # G first and h last: bring rows a and b out
                    sign = (-1) ** (a + b + (b < a) + m) * (-1)
                    d = sign * (np.linalg.det(others) if rank else 1.0)
                    if at_rest:
                        quadratic[s[a]] += d * k[a] * h[b]
                    else:
                        linear += d * g[a] * h[b]
                quadratic = 0.5 * (quadratic + quadratic.T)
            yield s, at_rest, constant, linear, quadratic, j, h

    def forms(self, strata, radius) -> Forms:
        n, m, rank = self.n, self.m, self.rank
        sigma = self.lever * n
        reach = sigma * radius
        eta = CLOSES
        free = np.array([[t == 0 for t in s] for s in strata])
        rows = []
        every = np.ones(len(strata), dtype=bool)
        zero1, zero2 = np.zeros(n), np.zeros((n, n))
        for a in range(m):
            if a < rank:
                rows.append((0.0, self.jacobian[a], zero2, sigma * reach**2 / 6 + eta * n, every))
            else:
                error = sigma**2 * reach**2 / 12 + eta * n**2
                rows.append((0.0, zero1, self.hessian[a], error, every))
        d_range = self.lever * reach**2 / 2 + eta
        d_null = self.lever * sigma * reach**2 / 6 + eta * n
        for s, at_rest, constant, linear, quadratic, j, h in self.minors:
            root = math.sqrt(len(s))
            g = np.linalg.norm(self.stiffness[s] if at_rest else self.torque[s])
            dg = eta * root + (0.0 if at_rest else radius * np.linalg.norm(self.stiffness[s]))
            sizes = [g, *np.linalg.norm(j, axis=0)]
            more = [dg] + [d_range * root] * j.shape[1]
            if h is not None:
                sizes.append(np.linalg.norm(np.abs(h).sum(axis=1)))
                more.append(d_null * root)
            sizes, more = np.array(sizes), np.array(more)
            error = np.prod(sizes + more) - np.prod(sizes) + 64 * EPS * np.prod(sizes + more)
            rows.append((constant, linear, quadratic, error, free[:, s].all(axis=1)))
        for (a, b), tau, which in self._twins(strata, free):
            ga, gb = self.torque[a], tau * self.torque[b]
            ka, kb = self.stiffness[a], tau * self.stiffness[b]
            linear = np.zeros(n)
            if ga == gb and (ga == 0 or ka == abs(kb)):
                linear[a], linear[b] = ka, -kb
                top = max(ka, abs(kb))
                rows.append((0.0, linear / top, zero2, 0.0, which))
            else:
                error = radius * (ka + abs(kb)) + eta
                rows.append((ga - gb, linear, zero2, error, which))
        turns = np.rint(self.point / math.pi)
        lower = np.where(free & (turns <= 0) * 1, 0, 0)
        lower = np.where(free & (turns >= 0), -1.0, 0.0)
        upper = np.where(free & (turns <= 0), 1.0, 0.0)
        c, a, q, e, holds = zip(*rows, strict=True)
        return Forms(
            np.array(c), np.array(a), np.array(q), np.array(e), np.array(holds).T, lower, upper
        )

    def _twins(self, strata, free):
        for a, b in itertools.combinations(range(self.n), 2):
            if np.linalg.norm(np.cross(self.axes[a], self.axes[b])) > CLOSES:
                continue
            inner = ~free[:, a + 1 : b].any(axis=1)
            if self.cyclic:
                inner |= ~(free[:, :a].any(axis=1) | free[:, b + 1 :].any(axis=1))
            which = inner & free[:, a] & free[:, b]
            if not which.any():
                continue
            ja, jb = self.jacobian[:, a], self.jacobian[:, b]
            if jb @ jb < RANK or ja @ ja < RANK:
                continue
            tau = 2.0 ** round(math.log2((ja @ ja) / (jb @ jb)) / 2) * np.sign(ja @ jb)
            yield (a, b), tau, which
