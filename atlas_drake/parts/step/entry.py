"""The entry of STEP."""

from atlas_drake.behaviors.entry import entry_of
from atlas_drake.messages import Behavior
from atlas_drake.parts.step.config import StepConfig
from atlas_drake.parts.step.step import Step

STEP = entry_of(
    Behavior.STEP, make=Step, config=StepConfig(), lifts_feet=True, recovers=True
)
