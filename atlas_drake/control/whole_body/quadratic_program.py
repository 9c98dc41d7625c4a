"""A dense quadratic program as a value, and its solver.

Nothing here is specific to robots. The solver is DAQP (Arnström, Bemporad, Axehill, "A
dual active-set solver for embedded quadratic programming using recursive LDLᵀ updates",
TAC 2022) with a cold start: exact, deterministic, and without hidden state.
"""

from __future__ import annotations

from dataclasses import dataclass

import daqp
import numpy as np

INEQUALITY, EQUALITY, SOFT = 0, 5, 8
"""Kinds of constraint: a bound on both sides, an equality, a bound that yields."""


@dataclass(frozen=True)
class QuadraticProgram:
    """Minimise ½ xᵀHx + fᵀx subject to lower ≤ [x; A x] ≤ upper."""

    H: np.ndarray  # Positive definite Hessian, shape (n, n)
    f: np.ndarray  # Linear cost, shape (n,)
    A: np.ndarray  # Constraint rows, shape (m, n)
    lower: np.ndarray  # Lower bounds of the variables, then of the rows, shape (n + m,)
    upper: np.ndarray  # Upper bounds, likewise
    kind: np.ndarray  # INEQUALITY, EQUALITY or SOFT of each bound, int32, (n + m,)


@dataclass(frozen=True)
class QpSolution:
    """Result of the solver."""

    x: np.ndarray  # The minimiser, shape (n,)
    found: bool  # False: contradicting bounds, no end, or a NaN
    iterations: int  # Active-set changes


def solve(problem: QuadraticProgram) -> QpSolution:
    """Solves one program from a cold start."""
    if not (problem.lower <= problem.upper).all():
        # The solver treats some crossed bounds, and bounds that are NaN, as satisfied.
        return QpSolution(x=np.zeros(len(problem.f)), found=False, iterations=0)
    x, _, flag, info = daqp.solve(
        problem.H,
        problem.f,
        problem.A,
        problem.upper,
        problem.lower,
        problem.kind,
        eps_prox=0.0,
        iter_limit=400,
    )
    found = flag > 0 and bool(np.isfinite(x).all())
    return QpSolution(x=x, found=found, iterations=info["iterations"])
