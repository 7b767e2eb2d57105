"""A lab's own task with its own simulated user: one finger pushes a puck to its goal.

sandbox run examples/push_the_puck.py --seed 3 --film puck.webp
sandbox regress --tasks examples/push_the_puck.py --seeds 0:20
"""

import numpy as np

from models import Contact, MjcfObject, TouchFrame
from tasks import CustomTask, Goal, judge, two_places

PUCK = """<mujoco><worldbody><body>
  <geom type="cylinder" size=".025 .015" rgba=".85 .55 .20 1" friction="1"/>
</body></worldbody></mujoco>"""


class OneFinger:
    """Lands behind the puck, pushes it towards its goal, and lands again when it slips away."""

    def __init__(self, configuration, surface, seed):
        self.configuration, self.surface = configuration, surface
        self.finger, self.aim, self.id = None, None, 0

    def observe(self, sight):
        """Reads the picture's state: puck, goal, and drawn hand. Chooses where the finger goes."""
        puck, goal = sight.objects["puck"].position[:2], sight.goals[0].position[:2]
        way = goal - puck
        far = np.linalg.norm(way)
        if sight.done or far < 0.006:
            self.finger = None  # there: let go
        elif self.finger is None or np.dot(puck - self.finger, way) < 0.7 * 0.034 * far:
            self.finger, self.id = puck - 0.045 * way / far, self.id + 1
            self.aim = self.finger
        elif sight.solid:
            self.aim = goal - 0.034 * way / far

    def touch(self, now):
        """Returns the touches at the time `now` (s); called 60 times a second."""
        if self.finger is None:
            return TouchFrame(now)
        self.finger = self.finger + np.clip(self.aim - self.finger, -0.001, 0.001)
        x, y = self.surface.to_surface([*self.finger, 0.0])
        return TouchFrame(now, (Contact(self.id, x, y),))


class PushThePuck(CustomTask):
    """A puck of 100 g, 4 to 8 cm from its goal. Success: within 1 cm, at rest, for 0.5 s in 30 s.

    History: version 1.
    """

    name = "my-lab-push-the-puck"
    user = OneFinger

    @classmethod
    def place(cls, rng, surface):
        start, end = two_places(rng, surface, apart=(0.04, 0.08), border=0.06)
        puck = MjcfObject.on_table("puck", PUCK, 0.1, start, 0.0)
        return [puck], [Goal("puck", (end[0], end[1], puck.height), 0.0)]

    def measure(self, sensing):
        puck, goal, start = sensing.object("puck"), self.goals[0], self.objects[0]
        far = np.linalg.norm(np.subtract(puck.position, goal.position))
        way = np.linalg.norm(np.subtract(start.position, goal.position))
        return judge(
            1 - far / way,
            (far > 0.01, f"the puck is {1000 * far:.0f} mm from its place"),
            (puck.speed > 0.01, "the puck is still moving"),
        )
