"""The draft of a report: only what is filled in is made."""

import pytest

from atlas_drake.behaviors.report_draft import ReportDraft
from atlas_drake.messages import AtlasSimInterfaceState, Behavior
from atlas_drake.messages.controller_status import REPORTED


def test_what_nobody_fills_in_is_the_blank_of_all_drafts():
    first, second = ReportDraft(), ReportDraft()
    first.walk_feedback.t_step_rem = 0.4
    first.walk_feedback.step_queue_saturated[1].step_index = 7
    first.current_behavior = Behavior.WALK
    blank = AtlasSimInterfaceState()
    parts, others = first.parts(REPORTED), second.parts(REPORTED)
    assert set(parts) == set(others) == set(REPORTED)
    for name in REPORTED:
        assert others[name] == getattr(blank, name)
    changed = {name for name in REPORTED if parts[name] != others[name]}
    assert changed == {"walk_feedback", "current_behavior"}
    assert parts["walk_feedback"].step_queue_saturated[1].step_index == 7
    # Nobody can change what they share.
    assert parts["step_feedback"] is others["step_feedback"]
    with pytest.raises(AttributeError, match="snapshot"):
        parts["step_feedback"].t_step_rem = 1.0


def test_a_draft_takes_what_a_report_takes():
    draft = ReportDraft()
    assert draft.k_effort == []
    with pytest.raises(AttributeError, match="walk_feedback"):
        draft.walk_feedbak = None
    with pytest.raises(AttributeError, match="no field 'nothing'"):
        _ = draft.nothing
