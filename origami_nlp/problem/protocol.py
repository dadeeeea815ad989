"""What solvers and certificates see of a problem: energy, closure, contacts, and their derivatives.

`pattern_problem.PatternProblem` has all of this.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Protocol

import numpy as np

from origami_nlp.problem.contact import Contact, FoldLimits, Local, LoopClosure
from origami_nlp.problem.parameters import Parameters
from origami_nlp.problem.touching import ClosedContacts, ContactWords


class Problem(Protocol):
    """Shapes and units are those of `PatternProblem`, where each of these is described.

    What is `sparse` is too large for singular values and kernels: certificates use sparse matrices, and steps by their
    factors.  Rows of closure depend on each other as a rule.
    """

    scale: float

    @property
    def multiplicity(self) -> np.ndarray: ...  # noqa: D102
    @property
    def parameters(self) -> Parameters: ...  # noqa: D102
    @property
    def sparse(self) -> bool: ...  # noqa: D102
    @property
    def size(self) -> int: ...  # noqa: D102
    @property
    def equation_count(self) -> int: ...  # noqa: D102
    @property
    def dof(self) -> int: ...  # noqa: D102
    @property
    def symmetry(self) -> str: ...  # noqa: D102
    @property
    def root(self) -> np.ndarray: ...  # noqa: D102
    @property
    def has_limits(self) -> bool: ...  # noqa: D102
    @property
    def fold_limits(self) -> FoldLimits: ...  # noqa: D102
    @property
    def limits(self) -> tuple[Contact, ...]: ...  # noqa: D102

    def expand(self, x: np.ndarray) -> np.ndarray: ...  # noqa: D102
    def reduce(self, fold_angles: np.ndarray) -> np.ndarray: ...  # noqa: D102
    def energy(self, x: np.ndarray) -> float: ...  # noqa: D102
    def energies(self, x: np.ndarray) -> np.ndarray: ...  # noqa: D102
    def energy_change(self, x: np.ndarray, y: np.ndarray) -> float: ...  # noqa: D102
    def excess(self, x: np.ndarray) -> float: ...  # noqa: D102
    def check_time(self) -> None: ...  # noqa: D102
    def local(self, x: np.ndarray) -> Local: ...  # noqa: D102
    def loops(self, x: np.ndarray) -> list[LoopClosure]: ...  # noqa: D102
    def closure(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]: ...  # noqa: D102
    def constraints(  # noqa: D102
        self, x: np.ndarray, contacts: Sequence[Contact] = ()
    ) -> tuple[np.ndarray, np.ndarray]: ...
    def lagrangian_hessian(  # noqa: D102
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact] = (),
        weight: float = 1.0,
    ) -> np.ndarray: ...
    def lifts_to_one(self, x: np.ndarray) -> Any: ...  # noqa: D102
    def closed(self, x: np.ndarray, tolerance: float = ...) -> ClosedContacts: ...  # noqa: D102
    def about_to_close(self, x: np.ndarray, length: float) -> tuple[Contact, ...]: ...  # noqa: D102
    def crossed(self, x: np.ndarray) -> tuple[tuple[int, int], ...]: ...  # noqa: D102
    def beyond(self, x: np.ndarray, tolerance: float = ...) -> tuple[Contact, ...]: ...  # noqa: D102
    def refuses(self, x: np.ndarray, tolerance: float = ...) -> str: ...  # noqa: D102
    def doubt(self, x: np.ndarray) -> str: ...  # noqa: D102
    def admissible(self, x: np.ndarray, tolerance: float = ...) -> np.ndarray: ...  # noqa: D102
    def to_second_order(  # noqa: D102
        self, contacts: tuple[Contact, ...]
    ) -> tuple[Contact, ...]: ...

    def name(self, contact: Contact) -> str: ...  # noqa: D102
    def weight(self, contact: Contact) -> float: ...  # noqa: D102
    def words(self, contact: Contact, x: np.ndarray) -> ContactWords: ...  # noqa: D102
    def meeting(self, contact: Contact, x: np.ndarray) -> np.ndarray: ...  # noqa: D102
    def margin(self, contact: Contact, x: np.ndarray) -> float: ...  # noqa: D102
    def guess(  # noqa: D102
        self, x: np.ndarray, pull: np.ndarray
    ) -> tuple[Contact, ...]: ...
    def creases_of(self, variable: int) -> tuple[int, ...]: ...  # noqa: D102
    def loaded(self, load: np.ndarray) -> Any: ...  # noqa: D102
    def varied(self, parameters: Parameters) -> Any: ...  # noqa: D102
    def drift(  # noqa: D102
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact],
        change: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]: ...

    def jacobian(self, x: np.ndarray) -> Any: ...  # noqa: D102
    def hessian(self, x: np.ndarray, multipliers: np.ndarray) -> Any: ...  # noqa: D102
    def torque(self, x: np.ndarray) -> np.ndarray: ...  # noqa: D102
    def rank(self, x: np.ndarray) -> int: ...  # noqa: D102
    def along(self, x: np.ndarray, v: np.ndarray) -> np.ndarray: ...  # noqa: D102
    def project(  # noqa: D102
        self, x: np.ndarray, held: np.ndarray | None = None
    ) -> tuple[np.ndarray, float]: ...
    def multipliers(  # noqa: D102
        self, x: np.ndarray, held: Iterable[int] = ()
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
