"""The entry of MANIPULATE."""

from __future__ import annotations

from atlas_drake.behaviors.base import BehaviorProtocol
from atlas_drake.behaviors.entry import BehaviorTools, entry_of
from atlas_drake.messages import Behavior
from atlas_drake.parts.manipulate.manipulate import Manipulate, ManipulateConfig


def _make(tools: BehaviorTools, config: ManipulateConfig) -> BehaviorProtocol:
    return tools.guarded(Manipulate(tools, config))


MANIPULATE = entry_of(
    Behavior.MANIPULATE, make=_make, config=ManipulateConfig(), recovers=True
)
