"""Why a whole-body QP had no solution, as far as its parts show.

Asked only after a QP has failed: it looks at every number again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.control.whole_body.constraints import Constraint, TaskBounds
from atlas_drake.control.whole_body.quadratic_program import QuadraticProgram
from atlas_drake.control.whole_body.tasks import Task, task_name
from atlas_drake.control.whole_body.terms import WholeBodyTerms

MAX_WEIGHT = 1e7
"""Weight beyond which the solver loses the other tasks to rounding; it fails at 1e8."""
MAX_TARGET = 1e9
"""Likewise of targets, whatever their unit."""
MAX_REASONS = 3
"""Number of reasons that are given: one fault often has several traces."""


def why_unsolved(
    terms: WholeBodyTerms,
    command: WholeBodyCommand,
    program: QuadraticProgram,
    constraints: Sequence[Constraint],
) -> str:
    """Returns what is wrong with the parts of a QP in words; empty if nothing shows."""
    if not all(np.isfinite(part).all() for part in (terms.q, terms.v, terms.M)):
        return "the state of the robot is not finite"
    reasons = [*_of_tasks(terms, command), *_of_constraints(program, constraints)]
    if not reasons and any(
        isinstance(constraint, TaskBounds) and not constraint.soft
        for constraint in command.constraints
    ):
        reasons = ["the hard bounds of the command may contradict others"]
    return "; ".join(islice(dict.fromkeys(reasons), MAX_REASONS))


def _of_tasks(terms: WholeBodyTerms, command: WholeBodyCommand) -> Iterator[str]:
    posture = command.posture
    yield from _of_numbers("the command's posture", posture.target, posture.weight)
    if (posture.weight <= 0.0).any():
        yield "weight of the command's posture is not positive"
    for task in command.tasks:
        name = task_name(task)
        yield from _of_numbers(name, task.target, task.weight)
        yield from _of_rows(name, task, terms, command)


def _of_numbers(name: str, target: object, weight: object) -> Iterator[str]:
    for field, given, largest in (
        ("target", target, MAX_TARGET),
        ("weight", weight, MAX_WEIGHT),
    ):
        values = np.asarray(given, dtype=float)
        if not np.isfinite(values).all():
            yield f"{field} of {name} is not finite"
        elif np.abs(values).max(initial=0.0) > largest:
            yield f"{field} of {name} is {np.abs(values).max():g}, too large"
    if (np.asarray(weight, dtype=float) < 0.0).any():
        yield f"weight of {name} is negative"


def _of_rows(
    name: str, task: Task, terms: WholeBodyTerms, command: WholeBodyCommand
) -> Iterator[str]:
    rows = task.rows(terms, command.contacts)
    for field, part in zip(("A", "b", "G"), rows, strict=True):
        if part is not None and not np.isfinite(part).all():
            yield f"{field} of {name} is not finite"


def _of_constraints(
    program: QuadraticProgram, constraints: Sequence[Constraint]
) -> Iterator[str]:
    size = len(program.f)
    crossed = ~(program.lower <= program.upper)
    if crossed[:size].any():
        yield "bounds of the joint limits contradict each other"
    end = 0
    for constraint in constraints:
        start, end = end, end + constraint.num_rows
        name = type(constraint).__name__
        if isinstance(constraint, TaskBounds):
            name += f" of {task_name(constraint.task)}"
        if crossed[size + start : size + end].any():
            yield f"bounds of {name} contradict each other, or are no numbers"
        if not np.isfinite(program.A[start:end]).all():
            yield f"rows of {name} are not finite"
