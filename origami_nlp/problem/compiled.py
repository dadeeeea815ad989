"""What two scenes must share to be solved by the same compiled functions, and those functions.

A `Structure` holds only what changes the form of the nonlinear program: group, rays, contacts.
Sector angles, stiffness, rest angles and load are parameters, so one solver serves a whole sweep.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.numerics import quaternion as quat
from origami_nlp.pattern import HingeLaw, flat_points, followed
from origami_nlp.problem.closure import FoldedExpressions, fold_piece
from origami_nlp.problem.gaps import Gap, gap_expression
from origami_nlp.problem.hinge_laws import PIECE

Evaluate = Callable[..., tuple[np.ndarray, ...]]


def evaluator(function: ca.Function) -> Evaluate:
    """Return a callable that evaluates `function` at arrays (or numbers) and returns its outputs as arrays.

    Each output has the shape of the CasADi matrix, [rows, columns], zeros of its sparsity included, and is a new
    array.  The values are those of calling the function itself.  Not for several threads at once: arguments
    pass through buffers that belong to the callable.
    """
    buffer: Any
    buffer, trigger = function.buffer()
    arguments = [np.zeros(function.nnz_in(i)) for i in range(function.n_in())]
    outputs = [np.zeros(function.nnz_out(i)) for i in range(function.n_out())]
    for i, a in enumerate(arguments):
        if not function.sparsity_in(i).is_dense():
            raise ValueError(f"argument {i} of {function.name()} must be dense")
        if a.size:
            buffer.set_arg(i, memoryview(a.data))
    for i, a in enumerate(outputs):
        if a.size:
            buffer.set_res(i, memoryview(a.data))
    shapes = [tuple(function.size_out(i)) for i in range(function.n_out())]
    # places of a sparse output's entries in the whole matrix, row by row; CasADi itself counts column by column
    where: list[Any] = []
    for i, (_, columns) in enumerate(shapes):
        sparsity = function.sparsity_out(i)
        if sparsity.is_dense():
            where.append(None)
        else:
            r, c = (np.array(v, dtype=int) for v in sparsity.get_triplet())
            where.append(r * columns + c)

    def evaluate(*values: Any) -> tuple[np.ndarray, ...]:
        for a, v in zip(arguments, values, strict=True):
            a[:] = v
        trigger()
        out = []
        for a, shape, at in zip(outputs, shapes, where, strict=True):
            if at is None:
                out.append(a.reshape(shape, order="F").copy())
            else:
                full = np.zeros(shape[0] * shape[1])
                full[at] = a
                out.append(full.reshape(shape))
        return tuple(out)

    evaluate.kept_alive = (function, buffer, trigger)  # type: ignore[attr-defined]
    return evaluate


@dataclass(frozen=True)
class Structure:
    """The form of the nonlinear program.

    kind, order: the point group C_n or D_n.
    winding: how often states wind round its axis.
    has_crease: for each ray of the piece, whether it is a crease.
    limits: whether |phi| <= pi is imposed.
    gaps: mirror, axis and facet-pair contacts (fold limits are bounds, not listed here).
    pairs: facet pairs that may cross, each as positions of their first rays.
    flat_sheet: whether the sector angles of the vertex sum to 2 pi.
    laws: whether a variable has a hinge law in place of a linear spring; empty where none has.
    dead: facets of the points at which forces pull, and first the one that is held, 0-based; empty without forces.
    """

    kind: str
    order: int
    has_crease: tuple[bool, ...]
    limits: bool
    gaps: tuple[Gap, ...]
    pairs: tuple[tuple[int, int], ...]
    flat_sheet: bool = True
    dead: tuple[int, ...] = ()
    winding: int = 1
    laws: tuple[bool, ...] = ()

    @property
    def turn(self) -> Fraction:
        """How many pieces make one turn round the axis, order / winding.

        Closed states of a piece depend on its sectors and on this number alone: they are those of a vertex with the
        group of this order, whose sectors do not add up to 2 pi where states wind more than once.
        """
        return Fraction(self.order, self.winding)

    @property
    def flat_piece(self) -> bool:
        """Whether the piece closes when it lies flat."""
        return self.flat_sheet and self.winding == 1

    @cached_property
    def first_gaps(self) -> tuple[int, ...]:
        """For each gap, the first one with the same rays: crease k on facet j belongs to two facet pairs."""
        first: dict[tuple[str, tuple[int, ...]], int] = {}
        return tuple(first.setdefault((g.type, g.rays), i) for i, g in enumerate(self.gaps))

    @cached_property
    def gaps_of_pairs(self) -> dict[tuple[int, int], list[int]]:
        """The gaps of each facet pair: both ends of the first facet off the second, then the reverse."""
        out: dict[tuple[int, int], list[int]] = {}
        for index, gap in enumerate(self.gaps):
            if gap.pair is not None:
                out.setdefault(gap.pair, []).append(index)
        return out


@dataclass(frozen=True)
class Functions:
    """Symbols and compiled CasADi functions of one structure.

    Arguments: x fold angles [n]; p parameters: `Parameters.vector`, and with laws their pieces at x
    (`HingeLaws.pieces_at`), so that the functions are those of every law.

    x, p, energy, piece, shift, laws: the symbols; shift of laws, and their pieces.
    gaps: values of `Structure.gaps` (facet pairs without sign).
    closure(x, p): equations and their Jacobian.
    local(x, p): energy gradient, equations, Jacobian, gaps, Jacobian of gaps.
    hessian(x, p, s, lam, mu): Hessian of s U + lam . equations + mu . gaps.
    rays(x, p): deformed rays, shape [3, rays].
    lift(x, p): positive on the lift q = +1.
    evaluators: the same functions by name, called with NumPy arrays.
    drift: how the KKT system changes with the parameters.
    """

    x: ca.SX
    p: ca.SX
    energy: ca.SX
    piece: FoldedExpressions
    gaps: ca.SX
    closure: ca.Function
    local: ca.Function
    hessian: ca.Function
    rays: ca.Function
    lift: ca.Function
    shift: ca.SX
    laws: ca.SX

    @cached_property
    def evaluators(self) -> dict[str, Evaluate]:
        """Return fast callables for closure, local, hessian, rays and lift."""
        return {
            f.name(): evaluator(f)
            for f in (self.closure, self.local, self.hessian, self.rays, self.lift)
        }

    @cached_property
    def drift(self) -> Evaluate:
        """Return drift(x, p, lam, mu, dp): how grad(U - lam . equations - mu . gaps), equations and gaps change with p.

        Built when a path over parameters first asks for it.
        """
        x, p, g, gaps = self.x, self.p, self.piece.equations, self.gaps
        lam, mu = ca.SX.sym("lam", g.shape[0]), ca.SX.sym("mu", gaps.shape[0])
        step = ca.SX.sym("dp", p.shape[0])
        lagrangian = self.energy - ca.dot(lam, g) - ca.dot(mu, gaps)
        moved = [ca.jtimes(v, p, step) for v in (ca.gradient(lagrangian, x), g, gaps)]
        return evaluator(
            ca.Function("drift", [x, p, lam, mu, step], [ca.densify(v) for v in moved])
        )


def law_energy(law: HingeLaw, phi: ca.SX) -> ca.SX:
    """Return the energy of a law as symbols: its own pieces, chosen by the fold angle."""
    return _piece_energy(law_piece(law, phi), phi)


def law_piece(law: HingeLaw, phi: ca.SX) -> list[ca.SX]:
    """Return the piece of a law at a fold angle as symbols: where it begins, and coefficients of its energy."""
    breaks, coefficients = law.energy_pieces
    return [ca.pw_const(phi, breaks[1:-1], c) for c in (breaks[:-1], *coefficients)]


def _piece_energy(piece: list[ca.SX], phi: ca.SX) -> ca.SX:
    at, *coefficients = piece
    energy: ca.SX = ca.SX(0)
    for c in coefficients:
        energy = energy * (phi - at) + c
    return energy


@lru_cache(maxsize=64)
def compile_structure(structure: Structure) -> Functions:
    """Build the symbols and functions of `structure` (cached: one build per structure)."""
    s = structure
    n = sum(s.has_crease)
    sector_count = len(s.has_crease) - (1 if s.kind == "D" else 0)
    x = ca.SX.sym("phi", n)
    sectors = ca.SX.sym("alpha", sector_count)
    stiffness, rest, load = ca.SX.sym("k", n), ca.SX.sym("phi0", n), ca.SX.sym("m", n)
    held, *facets = s.dead or (0,)
    forces = ca.SX.sym("f", 5, len(facets))  # points and forces
    weight_of_law, shift = ca.SX.sym("w", len(s.laws)), ca.SX.sym("d", len(s.laws))
    laws = ca.SX.sym("c", PIECE, len(s.laws))
    p = ca.vertcat(
        sectors, stiffness, rest, load, ca.vec(forces), weight_of_law, shift, ca.vec(laws)
    )
    piece = fold_piece(s.kind, s.turn, s.has_crease, x, sectors, s.flat_piece)
    sines = [ca.sin(sectors[i]) for i in range(sector_count)]
    # paper, eq. 3.1; a variable stands for all creases of its orbit, whose stiffness is summed in k
    springs = ca.DM([float(not law) for law in s.laws]) if s.laws else 1.0
    energy = 0.5 * ca.sum1(springs * stiffness * (x - rest) ** 2) - ca.dot(load, x)
    for v in np.flatnonzero(s.laws).tolist():
        piece_of_law = ca.vertsplit(laws[:, v])
        energy += weight_of_law[v] * _piece_energy(piece_of_law, x[v] - shift[v])
    for i, facet in enumerate(facets):
        energy -= quat.dot(
            _carried(held, facet, x, sectors, forces[:2, i]), ca.vertsplit(forces[2:, i])
        )
    gaps = ca.vertcat(ca.SX(0, 1), *(gap_expression(g, piece, sines) for g in s.gaps))
    g = piece.equations
    lam, mu, weight = ca.SX.sym("lam", g.shape[0]), ca.SX.sym("mu", gaps.shape[0]), ca.SX.sym("s")
    # signs as in IPOPT; `Model.lagrangian_hessian` has those of Nocedal & Wright (12.33), U - lam . g - mu . gaps
    lagrangian = weight * energy + ca.dot(lam, g) + ca.dot(mu, gaps)
    jac_g = ca.jacobian(g, x)
    return Functions(
        x=x,
        p=p,
        energy=energy,
        piece=piece,
        gaps=gaps,
        closure=ca.Function("closure", [x, p], [g, jac_g]),
        local=ca.Function(
            "local", [x, p], [ca.gradient(energy, x), g, jac_g, gaps, ca.jacobian(gaps, x)]
        ),
        hessian=ca.Function("hessian", [x, p, weight, lam, mu], [ca.hessian(lagrangian, x)[0]]),
        rays=ca.Function("rays", [x, p], [ca.horzcat(*(ca.vertcat(*c) for c in piece.rays))]),
        lift=ca.Function("lift", [x, p], [piece.lift]),
        shift=shift,
        laws=laws,
    )


def _carried(held: int, facet: int, x: ca.SX, sectors: ca.SX, point: ca.SX) -> Any:
    """Where a point of a facet is, seen from the facet that is fixed."""
    n = x.shape[0]
    # from facet `held` to facet `facet` counter-clockwise: crease i + 1 parts facets i and i + 1
    chain = [(held + 1 + i) % n for i in range((facet - held) % n)]
    axes, flat = flat_points(chain, sectors, held, point, ca.cos, ca.sin)
    folds = [
        quat.fold(ca.cos(x[c] / 2), ca.sin(x[c] / 2), a) for c, a in zip(chain, axes, strict=True)
    ]
    return followed(axes, flat, folds)[1]


@lru_cache(maxsize=256)
def mapped(structure: Structure, name: str, count: int) -> Evaluate:
    """One function of `structure` for `count` states at once: arguments and results side by side, column by column."""
    # through buffers: as matrices of CasADi's own, ten states took eight times as long
    return evaluator(getattr(compile_structure(structure), name).map(count))
