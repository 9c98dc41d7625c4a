// A gamepad's sticks steer while they are held.

const DEAD = 0.25;  // Shares below this are rest.
const GRAIN = 4;    // Steps of a share, so coarse that tremor sends nothing.
const REST = { forward: 0, left: 0, turn: 0 };

export function startGamepad(page) {
  let before = JSON.stringify(REST);
  return () => {
    const pad = [...navigator.getGamepads?.() ?? []].find((one) => one?.connected);
    if (!pad) return;
    const share = (axis) => {
      const value = -Math.max(-1, Math.min(1, pad.axes[axis] || 0));
      return Math.abs(value) < DEAD ? 0 : Math.round(GRAIN * value) / GRAIN;
    };
    const stick = { forward: share(1), left: share(0), turn: share(2) };
    const now = JSON.stringify(stick);
    if (now === before) return;
    before = now;
    if (now === JSON.stringify(REST)) page.do("stop_walking");
    else page.do("walk", stick);
  };
}
