"""A lift as the robot of LRP programs."""

from __future__ import annotations

from lrp_jupyter import Bridge

HEIGHT = 3.0  # metres from floor to floor


class Lift(Bridge):
    """A lift in a house with some floors.

    Parameters
    ----------
    floors : int
        How many there are above the ground.
    """

    name = "lift"
    hardware = False  # it is computed here
    time_step = 0.01

    def __init__(self, floors: int = 4) -> None:
        super().__init__()
        self.top = floors * HEIGHT
        self.height = self.speed = 0.0

    def open_interface(self) -> None:
        """Add the members of the lift; there is nothing to connect to."""
        self.add_variable("floor.data", lambda: self.height / HEIGHT, "0 on the ground", "floors")
        self.add_method("move", self.move, "up, in m/s", limits={"linear": 2.0})

    def move(self, linear: float = 0.0) -> None:
        """Go up (m/s; negative: down) until the next command."""
        self.speed = linear

    def stop(self) -> None:
        """Stand still."""
        self.speed = 0.0

    def advance(self, seconds: float) -> None:
        """Advance the lift by this time."""
        self.height = min(self.top, max(0.0, self.height + self.speed * seconds))

    def moment(self) -> tuple[float, float]:
        """Return everything that changes."""
        return self.height, self.speed

    def rewind(self, moment: tuple[float, float]) -> None:
        """Go back to a moment."""
        self.height, self.speed = moment
