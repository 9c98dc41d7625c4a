"""Compares QP solvers on the programs of the whole-body controller.

Records the programs of a walking robot and solves them with every installed dense
solver. Each starts cold, as the controller requires: a warm start would be state hidden
from the Context.
"""

from __future__ import annotations

import argparse
import logging
import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
from campaigns.walking import STANDING, plan
from report import command_line, write_figures

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation
from atlas_drake.control.whole_body import qp as whole_body_qp
from atlas_drake.control.whole_body import quadratic_program
from atlas_drake.control.whole_body.quadratic_program import SOFT, QuadraticProgram
from atlas_drake.robot import load_robot

INFINITE = 1e20
"""Bounds beyond this count as infinite."""
EVERY = 10
"""Interval of the kept programs: neighbors are similar."""
WALKING = 4.0
"""Simulated time in which programs are recorded [s]."""
SOFT_TOLERANCE = 1e-4
"""Violation of a soft bound on an acceleration below which it counts as met
[rad/s²]."""
REPEATS = 3
"""Number of solutions of each program, of which the fastest counts."""

Solver = Callable[[QuadraticProgram], np.ndarray]


def record_programs() -> list[QuadraticProgram]:
    """Programs of the first steps of a walk, whose soft bounds hold.

    Solvers without soft bounds may then treat them as hard ones.
    """
    sim = AtlasSimulation()
    sim.advance(STANDING)
    steps, _ = plan(sim)
    command = AtlasSimInterfaceCommand()
    command.behavior = command.WALK
    command.walk_params.step_queue[:] = steps[:4]
    sim.publish(command)
    programs: list[QuadraticProgram] = []
    solve = quadratic_program.solve
    count = 0

    def watch(problem: QuadraticProgram):
        nonlocal count
        answer = solve(problem)
        count += 1
        if count % EVERY == 0 and answer.found and _soft_bounds_hold(problem, answer.x):
            copies = {name: np.array(value) for name, value in vars(problem).items()}
            programs.append(QuadraticProgram(**copies))
        return answer

    whole_body_qp.solve = watch
    try:
        sim.advance(WALKING)
    finally:
        whole_body_qp.solve = solve
    return programs


def _soft_bounds_hold(problem: QuadraticProgram, x: np.ndarray) -> bool:
    values = np.concatenate([x, problem.A @ x])
    soft = problem.kind == SOFT
    return bool(
        (values[soft] > problem.lower[soft] - SOFT_TOLERANCE).all()
        and (values[soft] < problem.upper[soft] + SOFT_TOLERANCE).all()
    )


# ---- solvers -----------------------------------------------------------------


def solve_daqp(problem: QuadraticProgram) -> np.ndarray:
    """Solves with daqp, as the controller calls it."""
    return quadratic_program.solve(problem).x


def make_quadprog() -> Solver:
    """Goldfarb and Idnani's dual active-set method."""
    import quadprog

    def solve(problem: QuadraticProgram) -> np.ndarray:
        rows = np.vstack([np.eye(len(problem.f)), problem.A])
        below, above = problem.lower > -INFINITE, problem.upper < INFINITE
        C = np.vstack([rows[below], -rows[above]])
        b = np.concatenate([problem.lower[below], -problem.upper[above]])
        return quadprog.solve_qp(problem.H, -problem.f, C.T, b)[0]

    return solve


def make_proxsuite(accuracy: float) -> Solver:
    """The proximal augmented Lagrangian method of ProxQP."""
    import proxsuite

    def solve(problem: QuadraticProgram) -> np.ndarray:
        n, m = len(problem.f), len(problem.A)
        qp = proxsuite.proxqp.dense.QP(n, 0, m, True)
        qp.settings.eps_abs = accuracy
        qp.settings.eps_rel = 0.0
        lower = np.clip(problem.lower, -INFINITE, INFINITE)
        upper = np.clip(problem.upper, -INFINITE, INFINITE)
        qp.init(
            problem.H,
            problem.f,
            None,
            None,
            problem.A,
            lower[n:],
            upper[n:],
            lower[:n],
            upper[:n],
        )
        qp.solve()
        return np.array(qp.results.x)

    return solve


def make_pydrake(name: str) -> Solver:
    """A solver that comes with Drake; building the program is part of its time."""
    from pydrake.solvers import ClarabelSolver, MathematicalProgram, OsqpSolver

    solver = {"OSQP": OsqpSolver, "Clarabel": ClarabelSolver}[name]()

    def solve(problem: QuadraticProgram) -> np.ndarray:
        n = len(problem.f)
        program = MathematicalProgram()
        x = program.NewContinuousVariables(n)
        program.AddQuadraticCost(problem.H, problem.f, x, is_convex=True)
        lower = np.where(problem.lower < -INFINITE, -np.inf, problem.lower)
        upper = np.where(problem.upper > INFINITE, np.inf, problem.upper)
        program.AddBoundingBoxConstraint(lower[:n], upper[:n], x)
        program.AddLinearConstraint(problem.A, lower[n:], upper[n:], x)
        return solver.Solve(program).GetSolution(x)

    return solve


SOLVERS: dict[str, Callable[[], Solver]] = {
    "daqp": lambda: solve_daqp,
    "quadprog": make_quadprog,
    "proxsuite 1e-5": lambda: make_proxsuite(1e-5),
    "proxsuite 1e-8": lambda: make_proxsuite(1e-8),
    "OSQP (Drake)": lambda: make_pydrake("OSQP"),
    "Clarabel (Drake)": lambda: make_pydrake("Clarabel"),
}


def compare(programs: list[QuadraticProgram], num_joints: int) -> dict[str, dict]:
    """Times every solver and compares its efforts with daqp's."""
    references = [solve_daqp(problem) for problem in programs]
    results = {}
    for name, make in SOLVERS.items():
        try:
            solve = make()
        except ImportError:
            print(f"{name:18} not installed")
            continue
        times, deviations, failures = [], [], 0
        for problem, reference in zip(programs, references, strict=True):
            walls = []
            try:
                for _ in range(REPEATS):
                    begin = time.perf_counter()
                    x = solve(problem)
                    walls.append(time.perf_counter() - begin)
            except ValueError:
                failures += 1
                continue
            times.append(1e6 * min(walls))
            # The first rows of A are those of the efforts.
            deviation = problem.A[:num_joints] @ (x - reference)
            deviations.append(float(np.abs(deviation).max()))
        results[name] = {
            "median_us": statistics.median(times),
            "p99_us": float(np.percentile(times, 99)),
            "largest_effort_deviation_nm": max(deviations),
            "failures": failures,
        }
        print(
            f"{name:18} {results[name]['median_us']:7.0f} µs median"
            f" {results[name]['p99_us']:7.0f} µs p99"
            f"  {max(deviations):8.1e} N·m  {failures} failures",
            flush=True,
        )
    return results


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    options = command_line(parser)
    logging.getLogger("drake").setLevel(logging.ERROR)
    programs = record_programs()
    if not programs:
        print("No program was recorded.")
        return 1
    sizes = sorted({problem.A.shape for problem in programs})
    shapes = ", ".join(f"{n} unknowns and {m} rows" for m, n in sizes)
    print(f"{len(programs)} programs of a walk: {shapes}")
    num_joints = load_robot().num_joints
    results = compare(programs, num_joints)
    write_figures(options.json, {"programs": len(programs), "solvers": results})
    return 0


if __name__ == "__main__":
    sys.exit(main())
