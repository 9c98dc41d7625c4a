"""The walker of walker.py with its QP written out, for Drake's MathematicalProgram.

    python examples/walker_qp.py

Everything but stage 5 is that of ``walker.py``. The QP of the project
(``atlas_drake/control/whole_body``) eliminates the pelvis' acceleration and the torques
first, and limits the joints' motion. This one has all unknowns as they stand in the
textbook: for reading, and for trying out costs and constraints.
"""

import argparse
import sys
from pathlib import Path
from runpy import run_path
from types import SimpleNamespace

import numpy as np
from pydrake.solvers import ClarabelSolver, MathematicalProgram

from atlas_drake import AtlasSimulation

Walker = run_path(str(Path(__file__).with_name("walker.py")))["Walker"]
BASE = 6  # velocities of the free pelvis, ahead of those of the n joints


class WrittenOut:
    """min Σ ½ ‖A v̇ + b + G λ - target‖²_weight over v̇, λ and τ, subject to physics."""

    def solve(self, terms, command, bounds):
        """Find the torques of one tick.

        Args:
            terms: Model at this state: M, h, and J of every frame.
            command: Tasks, posture and contacts.
            bounds: Limits of the torques [N·m].
        """
        n, contacts = len(terms.q), command.contacts
        program = MathematicalProgram()
        vd = program.NewContinuousVariables(BASE + n, "vd")  # [rad/s²; m/s²]
        wrench = program.NewContinuousVariables(6 * len(contacts), "w")  # [N·m; N]
        torque = program.NewContinuousVariables(n, "tau")  # [N·m]

        # Dynamics: M v̇ + h = Sᵀ τ + Jᵀ λ.
        J = np.vstack([terms.frame(contact.frame).J_WF for contact in contacts])
        S = np.hstack([np.zeros((n, BASE)), np.eye(n)])
        program.AddLinearEqualityConstraint(
            np.hstack([terms.M, -J.T, -S.T]), -terms.h, [*vd, *wrench, *torque]
        )
        # Motors: |τ| ≤ τ_max.
        program.AddBoundingBoxConstraint(bounds.lower, bounds.upper, torque)

        # Contacts: friction and center of pressure, C λ ≤ 0, and a normal force that
        # only pushes. The rows of C are in axes of F, and the wrench is in W.
        for contact, w in zip(contacts, np.split(wrench, len(contacts)), strict=True):
            R_FW = terms.frame(contact.frame).R_WF.T
            C = contact.patch.cone @ np.kron(np.eye(2), R_FW)
            limit = np.zeros(len(C))
            limit[-1] = contact.max_normal_force
            least = np.full(len(C), -np.inf)
            least[-1] = contact.min_normal_force
            program.AddLinearConstraint(C, least, limit, w)
            small = [contact.moment_weight] * 3 + [contact.force_weight] * 3
            program.AddQuadraticCost(np.diag(small), np.zeros(6), w, is_convex=True)

        # Tasks: A v̇ + b + G λ → target.
        for task in command.tasks:
            A, b, G = task.rows(terms, contacts)
            A = np.zeros((len(b), len(vd))) if A is None else A
            G = np.zeros((len(b), len(wrench))) if G is None else G
            self._add(program, np.hstack([A, G]), [*vd, *wrench], b, task)
        self._add(program, np.eye(n), vd[BASE:], np.zeros(n), command.posture)

        result = ClarabelSolver().Solve(program)
        if not result.is_success():
            raise RuntimeError(
                f"the QP has no solution: {result.get_solution_result()}"
            )
        return SimpleNamespace(effort=result.GetSolution(torque))

    def _add(self, program, rows, variables, b, task):
        """Add ½ ‖rows x + b - target‖²_weight to the cost."""
        root = np.sqrt(0.5 * np.broadcast_to(task.weight, b.shape))
        program.Add2NormSquaredCost(
            root[:, None] * rows, root * (task.target - b), variables
        )


class WrittenOutWalker(Walker):
    """The walker, with this QP."""

    def __init__(self, robot, scenario):
        super().__init__(robot, scenario)
        self.qp = WrittenOut()


controller = WrittenOutWalker  # what --with takes from this file


def main():
    """Walk four steps, and say whether the robot stands."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    options = parser.parse_args()
    with AtlasSimulation(controller=WrittenOutWalker, view=not options.headless) as sim:
        sim.advance(6.4)
    print("Atlas fell." if sim.has_fallen else "Atlas stands.")
    sys.exit(sim.has_fallen)


if __name__ == "__main__":
    main()
