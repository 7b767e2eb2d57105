"""A lab's own task: push the mug to its goal and turn its handle to the goal's direction.

sandbox run examples/push_the_mug.py --seed 3 --record mug.jsonl && sandbox replay mug.jsonl
sandbox play examples/push_the_mug.py
sandbox regress --tasks examples/push_the_mug.py --seeds 0:20
"""

import numpy as np

from models import MjcfObject
from tasks import CustomTask, Goal, judge, two_places

MUG = """<mujoco><worldbody><body>
  <geom type="cylinder" size=".021 .025" rgba=".25 .45 .60 1" friction="1"/>
  <geom type="capsule" size=".004" fromto=".020 0 .014 .036 0 .010" rgba=".25 .45 .60 1"/>
  <geom type="capsule" size=".004" fromto=".036 0 .010 .036 0 -.010" rgba=".25 .45 .60 1"/>
  <geom type="capsule" size=".004" fromto=".036 0 -.010 .020 0 -.014" rgba=".25 .45 .60 1"/>
</body></worldbody></mujoco>"""


class PushTheMug(CustomTask):
    """A mug of 80 to 200 g, 4 to 8 cm from its goal and turned by up to 30 degrees; friction 0.3.

    Success: within 1 cm and 15 degrees, upright, at rest and let go of, for 0.5 s within 30 s.
    History: version 1.
    """

    name = "my-lab-push-the-mug"

    @classmethod
    def place(cls, rng, surface):
        start, end = two_places(rng, surface, apart=(0.04, 0.08), border=0.05)
        yaw, turn = rng.uniform(-np.pi, np.pi), rng.uniform(-1, 1) * np.deg2rad(30)
        mug = MjcfObject.on_table("mug", MUG, rng.uniform(0.08, 0.20), start, yaw)
        return [mug], [Goal("mug", (end[0], end[1], mug.height), yaw + turn)]

    def measure(self, sensing):
        mug, goal, began = sensing.object("mug"), self.goals[0], self.objects[0]
        far = np.linalg.norm(np.subtract(mug.position, goal.position))
        way = np.linalg.norm(np.subtract(began.position, goal.position))
        turn = abs((mug.yaw - goal.yaw + np.pi) % (2 * np.pi) - np.pi)
        return judge(
            1 - far / way,
            (far > 0.01, f"the mug is {1000 * far:.0f} mm from its place"),
            (turn > np.deg2rad(15), f"the handle is off by {np.rad2deg(turn):.0f} degrees"),
            (mug.tilt > np.deg2rad(10), "the mug is not upright"),
            (mug.held, "a hand still touches the mug"),
            (mug.speed > 0.01, "the mug is still moving"),
        )
