"""What every panel uses: the desk, its viewer, and orders."""

from __future__ import annotations

from collections.abc import Coroutine, Sequence
from typing import Any

from atlas_drake.cockpit.page.desk import Desk, Refused, Viewer
from atlas_drake.cockpit.state import RunCard


class Operating:
    """The desk as one viewer uses it."""

    def __init__(self, desk: Desk, viewer: Viewer) -> None:
        """Sits a viewer down at the desk."""
        self.desk, self.viewer = desk, viewer

    @property
    def card(self) -> RunCard:
        """Card of the present run; panels are built when there is one."""
        assert self.desk.card is not None
        return self.desk.card

    async def order(self, control: str, **values: Any) -> Any:
        """Sends an order; tells the user why it is refused, and then returns None."""
        return await self._told(self.desk.order(self.viewer, control, **values))

    async def plot(self, names: Sequence[str]) -> None:
        """Has columns sampled for this viewer; tells the user why if they are not."""
        await self._told(self.desk.plot(self.viewer, names))

    async def _told(self, order: Coroutine[Any, Any, Any]) -> Any:
        try:
            return await order
        except Refused as refused:
            self.viewer.tell(str(refused))
            return None
