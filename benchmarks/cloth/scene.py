"""The scene: a square of cloth above a ball."""

import time
from abc import abstractmethod

FRAME = 1 / 60  # s
SIZE, THICKNESS, DENSITY = 1.0, 0.005, 0.2  # m, m, kg/m^2
RADIUS, HEIGHT = 0.3, 0.65  # m: of the ball, which lies on the ground, and where the cloth begins
DAMPING = 0.5  # of velocities, 1/s


class Draped:
    """A cloth on a ball; a peer says how it advances."""

    @abstractmethod
    def advance(self, frames: int) -> None:
        """Advance by so many frames."""

    def cost(self, frames: int) -> float:
        """Return milliseconds of a frame, over so many."""
        started = time.perf_counter()
        self.advance(frames)
        return (time.perf_counter() - started) / frames * 1e3
