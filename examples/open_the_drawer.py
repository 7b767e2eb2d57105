"""A drawer to pull open by its handle, and one finger that hooks behind it and pulls.

sandbox run examples/open_the_drawer.py --seed 3
"""

from models import Contact, Mechanism, TouchFrame
from tasks import CustomTask, Goal, judge

DESK = """<mujoco><worldbody><body>
  <geom type="box" size=".040 .030 .002" pos="0 0 .002" rgba=".55 .37 .22 1"/>
  <geom type="box" size=".040 .030 .002" pos="0 0 .042" rgba=".55 .37 .22 1"/>
  <body name="drawer" pos="0 0 .022">
    <joint type="slide" axis="0 -1 0" range="0 .05" frictionloss="1" damping="5" armature=".1"/>
    <geom type="box" size=".036 .028 .016" rgba=".80 .60 .38 1"/>
    <geom type="box" size=".010 .003 .003" pos="0 -.049 .004" rgba=".74 .77 .80 1"/>
    <geom type="box" size=".003 .010 .003" pos=".012 -.038 .004" rgba=".74 .77 .80 1"/>
  </body>
</body></worldbody></mujoco>"""  # 1 N of friction holds the drawer.


class Hook:
    """Lands between drawer and handle, and pulls towards the person until the trial is done."""

    def __init__(self, configuration, surface, seed):
        self.surface, self.finger, self.done = surface, None, False

    def observe(self, sight):
        x, y, _ = sight.objects["desk/drawer"].position
        self.done = sight.done
        self.finger = self.finger or (x, y - 0.037)
        if sight.solid and not sight.done:
            self.finger = self.finger[0], self.finger[1] - 0.0005

    def touch(self, now):
        if self.finger is None or self.done:
            return TouchFrame(now)
        x, y = self.surface.to_surface([*self.finger, 0.0])
        return TouchFrame(now, (Contact(1, x, y),))


class OpenTheDrawer(CustomTask):
    """Success: the drawer is out by 4 cm or more, at rest, for 0.5 s within 30 s.
    History: version 1."""

    name, touch_height, user = "my-lab-open-the-drawer", 0.020, Hook

    @classmethod
    def place(cls, rng, surface):
        x, y, _ = surface.to_world(surface.size * rng.uniform((0.35, 0.25), (0.65, 0.35)))
        desk = Mechanism("desk", DESK, (x, y, 0.0))
        position, yaw = desk.part("drawer").placed(0.05)
        return desk.parts, [Goal("desk/drawer", position, yaw)]

    def measure(self, sensing):
        out = sensing.joint("desk/drawer")
        far = f"the drawer is out by {1000 * out.position:.0f} mm"
        return judge(out.share, (out.position < 0.04, far), (abs(out.speed) > 0.01, "it moves"))
