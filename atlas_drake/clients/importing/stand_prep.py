"""The stand-prep pose of a robot: flat soles below its center of mass."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.math import RotationMatrix
from pydrake.multibody.inverse_kinematics import (
    ComPositionConstraint,
    InverseKinematics,
)
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.solvers import Solve

from atlas_drake.clients.importing.findings import (
    FOUND,
    LOST,
    Findings,
    ImportRefused,
)
from atlas_drake.clients.importing.joint_defaults import default_gains, rotor_inertias
from atlas_drake.robot import LEGS, Leg, RobotFile
from atlas_drake.robot.leg import read_legs
from atlas_drake.robot.parsing import parse
from atlas_drake.units import GRAVITY

FLEXION, LEAST_FLEXION = 0.7, 0.35
"""Flexion of the knees in the pose; the least with which the controller can stand
[rad]."""
KNEE_SHARE = 0.4
"""Share of its effort limit that a knee may need to stand on one leg [-]: a weak one is
bent less, down to ``LEAST_FLEXION``, and has the rest to walk with."""
STANCE_SHARE = 0.256
"""Greatest distance between the feet, in heights of the center of mass: Atlas' [-]."""
GAP = 0.05
"""Least distance between the soles, likewise [-]."""
CARRIES = 0.95
"""Share of its effort limit that a joint may need to stand [-]."""
MARGIN = 0.01
"""Distance of the pose from the end stops [rad]."""


def find_stand_prep(
    file: RobotFile, urdf: Path, findings: Findings
) -> tuple[RobotFile, dict[str, float]]:
    """Returns the file with pose and gains of its joints, and rotor inertias [kg·m²].

    ``file`` has its joints at zero; joints that need no rotor inertia are left out.
    """
    plant: Any = MultibodyPlant(time_step=0.0)
    parse(plant, urdf)
    plant.Finalize()
    legs = read_legs(plant, plant.GetBodyByName(file.pelvis), file)
    joints = [plant.GetJointByName(joint.name) for joint in file.joints]
    lower = np.array([joint.position_lower_limit() for joint in joints])
    upper = np.array([joint.position_upper_limit() for joint in joints])
    margin = np.minimum(MARGIN, 0.5 * (upper - lower))
    nominal = np.clip(0.0, lower + margin, upper - margin)
    weight = GRAVITY * plant.CalcTotalMass(plant.CreateDefaultContext())
    for leg in legs:
        knee = plant.GetJointActuatorByName(file.joints[leg.knee].name)
        # About a knee between hip and ankle in line above each other.
        lever = KNEE_SHARE * knee.effort_limit() / weight
        carried = 2.0 * math.asin(min(lever / leg.thigh_length, 1.0))
        flexion = min(FLEXION, max(carried, LEAST_FLEXION))
        _bend(leg, flexion, file, lower, upper, nominal)
    angles = _solve(plant, file, legs, joints, nominal, lower, upper)
    context = plant.CreateDefaultContext()
    for joint, angle in zip(joints, angles, strict=True):
        joint.set_angle(context, angle)
    _check_efforts(plant, context, file, joints, findings)
    height = _com_height(plant, context, file)
    mass = plant.CalcTotalMass(context)
    turned = np.diag(plant.CalcMassMatrix(context))
    inertias = [float(turned[joint.velocity_start()]) for joint in joints]
    gains = default_gains(file, legs, mass, height, inertias)
    findings.add(
        FOUND,
        f"{mass:.1f} kg, center of mass {height:.3f} m high, {len(joints)} joints",
    )
    rotors = rotor_inertias(file, mass * height**2, inertias, findings)
    posed = [
        replace(joint, stand_prep=round(float(angle), 5), kp=kp, kd=kd)
        for joint, angle, (kp, kd) in zip(file.joints, angles, gains, strict=True)
    ]
    return replace(file, joints=posed), rotors


def _bend(
    leg: Leg,
    flexion: float,
    file: RobotFile,
    lower: np.ndarray,
    upper: np.ndarray,
    nominal: np.ndarray,
) -> None:
    """Bends a leg of the nominal pose; refuses a knee that cannot."""
    knee, name = leg.knee, file.joints[leg.knee].name
    low, high = float(lower[knee]), float(upper[knee])
    most = max(leg.flexion(low), leg.flexion(high))
    flexion = min(flexion, most - MARGIN)
    if flexion < LEAST_FLEXION:
        raise ImportRefused(
            f"joint {name}: goes from {low:.3g} to {high:.3g} rad, and the stand-prep "
            f"pose needs {leg.knee_at(FLEXION):.2g}: shuffled limits, not the knee, or "
            "does the robot face another way (--faces)?"
        )
    nominal[knee] = leg.knee_at(flexion)
    for joint in (leg.hip_pitch, leg.ankle_pitch):
        places = [int(place) for place in leg.joints]
        sign = math.copysign(1.0, float(leg.axes[places.index(joint), 1]))
        # With all joints at zero the soles are level, whatever the knee's bend then.
        wanted = -0.5 * (flexion - leg.flexion(0.0)) * sign
        if not lower[joint] - 0.2 <= wanted <= upper[joint] + 0.2:
            raise ImportRefused(
                f"joint {file.joints[joint].name}: goes from {lower[joint]:.3g} to "
                f"{upper[joint]:.3g} rad, and the stand-prep pose needs about "
                f"{wanted:.2g}: shuffled limits?"
            )
        nominal[joint] = min(max(wanted, lower[joint]), upper[joint])


def _solve(
    plant: Any,
    file: RobotFile,
    legs: tuple[Leg, Leg],
    joints: list[Any],
    nominal: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
) -> np.ndarray:
    """Solves for flat soles side by side below the center of mass."""
    context = plant.CreateDefaultContext()
    for joint, angle in zip(joints, nominal, strict=True):
        joint.set_angle(context, angle)
    height = _com_height(plant, context, file)
    hips = float(legs[0].p_PT[1] - legs[1].p_PT[1])
    width = max(min(hips, STANCE_SHARE * height), file.sole.width + GAP * height)
    ik = InverseKinematics(plant)
    q, program = ik.q(), ik.prog()
    level, world = RotationMatrix(), plant.world_frame()
    pelvis = plant.GetFrameByName(file.pelvis)
    ik.AddOrientationConstraint(world, level, pelvis, level, 0.0)
    for foot, side in zip(file.feet, (0.5, -0.5), strict=True):
        sole = plant.GetFrameByName(foot.sole_frame)
        place = np.array([0.0, side * width, 0.0])
        ik.AddPositionConstraint(sole, np.zeros(3), world, place, place)
        ik.AddOrientationConstraint(world, level, sole, level, 0.0)
    com = program.NewContinuousVariables(3, "com")
    far = np.array([0.0, 0.0, math.inf])
    program.AddBoundingBoxConstraint(-far, far, com)
    constraint = ComPositionConstraint(plant, None, world, ik.context())
    program.AddConstraint(constraint, np.concatenate([q, com]))
    in_legs = {int(place) for leg in legs for place in leg.joints}
    for index, joint in enumerate(joints):
        variable = q[joint.position_start()]
        low, high = lower[index] + MARGIN, upper[index] - MARGIN
        if index not in in_legs:
            low = high = nominal[index]
        program.AddBoundingBoxConstraint(low, high, variable)
        program.AddQuadraticCost((variable - nominal[index]) ** 2, is_convex=True)
    start = plant.GetPositions(context)
    sole = plant.GetFrameByName(file.feet[0].sole_frame).CalcPoseInWorld(context)
    start[4:7] = 0.0, 0.0, -float(sole.translation()[2])
    program.SetInitialGuess(q, start)
    program.SetInitialGuess(com, np.array([0.0, 0.0, height]))
    result = Solve(program)
    found = result.GetSolution(q)
    angles = np.array([found[joint.position_start()] for joint in joints])
    if not result.is_success():
        left = np.minimum(angles - lower, upper - angles)
        stops = [
            f"{file.joints[k].name} ({lower[k]:.3g} to {upper[k]:.3g} rad)"
            for k in sorted(in_legs)
            if left[k] < 2.0 * MARGIN
        ]
        at = f"; at their stops are {', '.join(stops)}" if stops else ""
        raise ImportRefused(
            f"no pose has flat soles {width:.2f} m apart below the center of mass{at}"
        )
    return angles


def _com_height(plant: Any, context: Any, file: RobotFile) -> float:
    soles = [
        plant.GetFrameByName(foot.sole_frame).CalcPoseInWorld(context).translation()[2]
        for foot in file.feet
    ]
    com = plant.CalcCenterOfMassPositionInWorld(context)
    return float(com[2] - np.mean(soles))


def _check_efforts(
    plant: Any, context: Any, file: RobotFile, joints: list[Any], findings: Findings
) -> None:
    """Refuses a robot whose legs or back cannot carry it in its pose."""
    weak = []
    load = np.array([0.0, 0.0, 0.5 * GRAVITY * plant.CalcTotalMass(context)])
    torque = -plant.CalcGravityGeneralizedForces(context)
    world = plant.world_frame()
    for foot in file.feet:
        sole = plant.GetFrameByName(foot.sole_frame)
        J = plant.CalcJacobianTranslationalVelocity(
            context, JacobianWrtVariable.kV, sole, np.zeros(3), world, world
        )
        torque = torque - J.T @ load
    for entry, joint in zip(file.joints, joints, strict=True):
        has = plant.GetJointActuatorByName(joint.name()).effort_limit()
        needed = abs(float(torque[joint.velocity_start()]))
        if needed <= CARRIES * has:
            continue
        if entry.limb not in (*LEGS, "back"):
            weak.append(f"{joint.name()} {has:.3g} of {needed:.3g} N·m")
        else:
            raise ImportRefused(
                f"joint {joint.name()}: has {has:.3g} N·m, and standing on both feet "
                f"needs {needed:.3g}: shuffled efforts?"
            )
    findings.add_about(weak, LOST, "the pose of joints too weak for it")
