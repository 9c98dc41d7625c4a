"""Detection of a fall from the posture."""

import dataclasses

import numpy as np
import pytest

from atlas_drake.behaviors.fall import FallLimits, posture_of, sign_of_fall

LIMITS = FallLimits(tilt=0.8, height=0.6)


@pytest.fixture
def terms(observe):
    return observe().terms


@pytest.fixture
def nominal(model):
    return model.robot.com_height


def tilted(terms, angle):
    """Turned about the y axis by an angle [rad], the rest as it was."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return dataclasses.replace(terms, R_WP=R)


def lowered(terms, height):
    """With the center of mass at a height above the left sole [m], the lower one."""
    left, right = terms.feet
    raised = right._replace(p_WF=left.p_WF + np.array([0.0, -0.2, 0.3]))
    com = np.array([*terms.com[:2], left.p_WF[2] + height])
    return dataclasses.replace(terms, com=com, feet=(left, raised))


def sign(terms, nominal):
    return sign_of_fall(posture_of(terms), nominal, LIMITS)


@pytest.mark.parametrize(
    ("angle", "falls"),
    [(0.0, False), (0.79, False), (-0.79, False), (0.81, True), (-0.81, True)],
)
def test_a_tilted_pelvis_falls(terms, nominal, angle, falls):
    text = f"pelvis tilted by {abs(angle):.2f} rad" if falls else ""
    assert sign(tilted(terms, angle), nominal) == text


def test_the_height_counts_from_the_lower_sole(terms, nominal):
    assert sign(lowered(terms, 0.61 * nominal), nominal) == ""
    text = sign(lowered(terms, 0.59 * nominal), nominal)
    assert text.startswith(f"center of mass only {0.59 * nominal:.2f} m")
