"""Hands as they are seen: skin, nails and cuff in a copy of the model that only views have.

The simulated model never has a skin, so that a picture cannot change the physics; the copy is
compiled from the same text, with the same joints in the same order.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.scene import Scene
from models.scene_hand import SceneHand
from models.skeleton import Skeleton
from models.skin.colours import CUFF, NAIL, SLEEVE, tone_colours
from models.skin.skin import Skin, frames
from sandbox.session.messages import HandView
from sandbox.views import palette
from sandbox.views.palette import Colour

HIDDEN_GROUP = 3
"""Geom group of the simulation's own capsules, which MuJoCo does not show."""
TARGET_GROUP = 5
"""Skin group of the hands that show where a hand should be; the hands' own are 0 and 1."""

GLOSS: dict[str, tuple[float, float]] = {
    "skin": (0.16, 0.30),
    "nail": (0.25, 0.55),
    "cuff": (0.05, 0.10),
    "sleeve": (0.04, 0.10),
}
"""Specular and shininess: skin is dull, a nail is not."""
PALETTE_SIZE = 64
"""Colours along each side of the palette of tones."""
TARGET_OFF, TARGET_THIN = 0.012, 0.0012
"""m between a fingertip and its target from which the target is shown (fingers that hold something
are always commanded a little into it), and how much thinner it is, so that it hides where it is in
place."""


@dataclass(frozen=True)
class Look:
    """One hand of the copy.

    Attributes:
        skeleton: Bones of the hand.
        skin: Fitted to them.
        parts: MuJoCo's number of the skin of each part.
        target: Number of the skin that shows the commanded pose.
        casters: Geoms in whose place the hand's shadow is cast.
    """

    skeleton: Skeleton
    skin: Skin
    parts: dict[str, int]
    target: int
    casters: list[int]

    def is_held_back(self, hand: HandView) -> bool:
        """True if any fingertip is visibly away from its place in the commanded pose."""
        tips = Kinematics(self.skeleton).tips(hand.target)
        return bool(np.max(np.linalg.norm(hand.tips - tips, axis=1)) > TARGET_OFF)

    def commanded(self, hand: HandView) -> tuple[Array, Array]:
        """Vertices and normals (n, 3) of the skin at the commanded pose."""
        part = self.skin.part("skin").vertices
        bones = frames(self.skeleton, hand.target)
        normals = self.skin.normals(*bones)[part]
        return self.skin.posed(*bones)[part] - TARGET_THIN * normals, normals


def skinned_model(scene: Scene) -> tuple[mujoco.MjModel, dict[int, Look]]:
    """A copy of a scene's model with skins on its hands, and their looks by number of the hand.

    The capsules of a hand with a skin are hidden. A hand without a skeleton has no skin, and is
    drawn as its own MJCF shows it.
    """
    spec = mujoco.MjSpec.from_string(scene.xml)
    _materials(spec)
    looks: dict[int, Look] = {}
    count = 0
    for index, hand in enumerate(scene.spec.hands):
        if hand.skeleton is None:
            continue
        skin = Skin.builtin().fitted(hand.skeleton)
        numbers = {}
        for part in skin.parts:
            _add_skin(spec, hand, skin, part.name, f"{hand.name}_{part.name}", index)
            numbers[part.name] = count
            count += 1
        _add_skin(spec, hand, skin, "skin", f"{hand.name}_target", TARGET_GROUP)
        looks[index] = Look(hand.skeleton, skin, numbers, count, [])
        count += 1
    model = spec.compile()
    for index, look in looks.items():
        root = int(model.body(scene.spec.hands[index].palm).rootid[0])
        mine = model.body_rootid[model.geom_bodyid] == root
        # The simulation's own capsules have names; of the rest, the sleeve's cylinders count.
        named = np.array([bool(model.geom(g).name) for g in range(model.ngeom)])
        sleeve = model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER
        look.casters.extend(np.flatnonzero(mine & (named | sleeve)).tolist())
        model.geom_group[mine] = HIDDEN_GROUP
    return model, looks


def _materials(spec: mujoco.MjSpec) -> None:
    tones = tone_palette()
    spec.add_texture(
        name="skin tones",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        width=PALETTE_SIZE,
        height=PALETTE_SIZE,
        nchannel=3,
        data=tones.ravel().tolist(),
    )
    for kind, (specular, shininess) in GLOSS.items():
        material = spec.add_material(name=f"hand {kind}", specular=specular, shininess=shininess)
        material.rgba = [0.96, 0.96, 0.96, 1.0] if kind == "skin" else [1.0, 1.0, 1.0, 1.0]
        if kind == "skin":
            material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "skin tones"
    spec.add_material(name="hand target", specular=0.0, rgba=[*palette.TARGET, 1.0], emission=0.3)


def _add_skin(
    spec: mujoco.MjSpec, hand: SceneHand, skin: Skin, part: str, name: str, group: int
) -> None:
    chosen = skin.part(part)
    triangles = skin.triangles[chosen.triangles] - chosen.vertices.start
    target = group == TARGET_GROUP
    kind = "target" if target else part.partition("_")[0]
    made = spec.add_skin(name=name, material=f"hand {kind}", group=group)
    made.vert = skin.rest[chosen.vertices].ravel().tolist()
    made.face = triangles.ravel().tolist()
    if kind == "skin":
        # The middle of a palette's colour, so that none of the neighbours bleeds in.
        tone = skin.tone[chosen.vertices] * (1 - 1 / PALETTE_SIZE) + 0.5 / PALETTE_SIZE
        made.texcoord = tone.ravel().tolist()
    shares = skin.shares[chosen.vertices]
    used = np.flatnonzero(shares.any(axis=0))
    assert hand.skeleton is not None
    bodies = [hand.palm, *(link.body for link in hand.links)]
    places, turns = frames(hand.skeleton, np.zeros(POSE_SIZE))
    made.bodyname = [bodies[b] for b in used]
    made.bindpos = places[used].ravel().tolist()
    made.bindquat = matrix_to_quaternion(turns[used]).ravel().tolist()
    ids = [np.flatnonzero(shares[:, b]) for b in used]
    made.vertid = [i.tolist() for i in ids]
    made.vertweight = [shares[i, b].tolist() for b, i in zip(used, ids, strict=True)]


def tone_palette() -> NDArray[np.uint8]:
    """(64, 64, 3) sRGB: warmth to the right, brightness downwards."""
    share = np.linspace(0.0, 1.0, PALETTE_SIZE)
    tones = np.stack(np.meshgrid(share, share), axis=-1)
    return np.asarray(np.round(255 * tone_colours(tones)), np.uint8)


def part_colour(part: str, hand: HandView) -> Colour | None:
    """The colour of a part, None for skin: nails have that of a finger that touches."""
    kind, _, finger = part.partition("_")
    if kind == "skin":
        return None
    if kind != "nail":
        return CUFF if kind == "cuff" else SLEEVE
    label = FINGERS.index(finger)
    touching = {c.label for c in hand.contacts if c.state != "ignored"}
    return palette.finger_colour(label) if label in touching else NAIL
