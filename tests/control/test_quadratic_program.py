"""The QP solver against the optimality conditions of the programs given to it."""

import numpy as np
import pytest

from atlas_drake.control.whole_body.quadratic_program import (
    EQUALITY,
    INEQUALITY,
    SOFT,
    QuadraticProgram,
    solve,
)

VARIABLES, ROWS = 8, 6
SLACK = 1e-7
"""Distance from a bound below which it counts as active."""


def random_program(seed, kind=INEQUALITY):
    """A strictly convex program with the origin inside all its bounds."""
    random = np.random.default_rng(seed)
    root = random.normal(size=(VARIABLES, VARIABLES))
    size = VARIABLES + ROWS
    return QuadraticProgram(
        H=root @ root.T + 0.1 * np.eye(VARIABLES),
        f=5.0 * random.normal(size=VARIABLES),
        A=random.normal(size=(ROWS, VARIABLES)),
        lower=-random.uniform(0.05, 1.0, size),
        upper=random.uniform(0.05, 1.0, size),
        kind=np.full(size, kind, dtype=np.int32),
    )


def all_rows(problem):
    """Variables and rows as one matrix of constraints."""
    return np.vstack([np.eye(len(problem.f)), problem.A])


@pytest.mark.parametrize("seed", range(4))
def test_solution_meets_the_optimality_conditions(seed):
    problem = random_program(seed)
    answer = solve(problem)
    assert answer.found
    G = all_rows(problem)
    value = G @ answer.x
    assert (value >= problem.lower - SLACK).all()
    assert (value <= problem.upper + SLACK).all()
    # Stationarity: only active bounds hold the gradient, each pushing inwards.
    at_upper = value > problem.upper - SLACK
    at_lower = value < problem.lower + SLACK
    active = np.flatnonzero(at_upper | at_lower)
    assert active.size, "a program without active bounds tests nothing"
    gradient = problem.H @ answer.x + problem.f
    multiplier, *_ = np.linalg.lstsq(G[active].T, -gradient, rcond=None)
    np.testing.assert_allclose(G[active].T @ multiplier, -gradient, atol=1e-6)
    assert (np.where(at_upper[active], multiplier, -multiplier) > -1e-6).all()


def test_equality_rows_hold_exactly():
    problem = random_program(1)
    for row in (0, 1):
        index = VARIABLES + row
        problem.kind[index] = EQUALITY
        problem.lower[index] = problem.upper[index] = 0.03
    answer = solve(problem)
    assert answer.found
    np.testing.assert_allclose(problem.A[:2] @ answer.x, 0.03, atol=1e-9)


def test_soft_bounds_yield_where_hard_ones_contradict():
    problem = random_program(2)
    problem.lower[0] = problem.upper[0] = 0.5
    repeated = problem.A.copy()
    repeated[0] = 0.0
    repeated[0, 0] = 1.0
    row = VARIABLES
    problem.lower[row], problem.upper[row] = -0.5, -0.4
    problem.kind[row] = SOFT
    hard = np.full_like(problem.kind, INEQUALITY)
    arrays = problem.H, problem.f, repeated, problem.lower, problem.upper
    assert not solve(QuadraticProgram(*arrays, hard)).found
    yielding = solve(QuadraticProgram(*arrays, problem.kind))
    assert yielding.found
    assert yielding.x[0] == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize("index", [0, VARIABLES])
def test_crossed_bounds_are_noticed(index):
    problem = random_program(3)
    problem.lower[index], problem.upper[index] = 1.0, -1.0
    assert not solve(problem).found


@pytest.mark.parametrize("name", ["H", "f", "lower", "upper"])
def test_values_that_are_no_numbers_are_noticed(name):
    problem = random_program(5)
    getattr(problem, name).flat[0] = np.nan
    assert not solve(problem).found


def test_same_program_same_bits_and_inputs_untouched():
    problem = random_program(4)
    before = [array.copy() for array in vars(problem).values()]
    first = solve(problem)
    # Other programs in between must leave nothing behind.
    for seed in range(3):
        solve(random_program(seed))
    second = solve(problem)
    assert first.x.tobytes() == second.x.tobytes()
    assert first.iterations == second.iterations
    for array, kept in zip(vars(problem).values(), before, strict=True):
        np.testing.assert_array_equal(array, kept)
