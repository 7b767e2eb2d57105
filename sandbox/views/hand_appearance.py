"""Appearance of hands: skin, nails and cuff in a copy of the model for views.

The simulated model has no skin, so that pictures cannot change the physics. The copy is compiled
from the same text, so its joints are the same and in the same order.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.frames import FINGERS
from models.hand import SceneHand
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.scene import Scene
from models.skeleton import Skeleton
from models.skin.skin import CUFF, NAIL, SLEEVE, Skin, frames, tone_colours
from sandbox.session.messages import HandView
from sandbox.views import palette
from sandbox.views.palette import Colour

HIDDEN_GROUP = 3
"""Geom group of the simulation's capsules; the views do not draw this group."""

GLOSS: dict[str, tuple[float, float]] = {
    "skin": (0.16, 0.30),
    "nail": (0.25, 0.55),
    "cuff": (0.05, 0.10),
    "sleeve": (0.04, 0.10),
}
"""Material -> specular reflection and shininess."""
PALETTE_SIZE = 64
"""Number of colours along each side of the palette of skin tones."""
TARGET_OFF = 0.004
"""Points of the skin that are farther than this (m) from their position in the commanded pose are
outlined in that position."""


@dataclass(frozen=True)
class HandAppearance:
    """Appearance of one hand in the copied model.

    Attributes:
        skeleton: Skeleton of the hand.
        skin: Skin, fitted to the skeleton.
        parts: MuJoCo's skin number of each part, by name.
        casters: Numbers of the geoms at whose poses shadow casters are drawn.
    """

    skeleton: Skeleton
    skin: Skin
    parts: dict[str, int]
    casters: list[int]

    def triangles(self, positions: Array, rotations: Array, hand: HandView) -> tuple[Array, Array]:
        """Returns triangles of the displaced parts of the skin and of the whole skin.

        Args:
            positions: (15, 3) m, positions of palm and bones.
            rotations: (15, 3, 3), rotations of palm and bones.
            hand: The hand, with its commanded pose.

        Returns:
            (n, 3, 3) m, displaced triangles in the commanded pose; (m, 3, 3) m, all triangles in
            the present pose.
        """
        part = self.skin.part("skin")
        corners = self.skin.triangles[part.triangles] - part.vertices.start
        here = self.skin.posed(positions, rotations)[part.vertices]
        there = self.skin.posed(*frames(self.skeleton, hand.target))[part.vertices]
        off = np.linalg.norm(here - there, axis=1) > TARGET_OFF
        return there[corners[off[corners].all(axis=1)]], here[corners]


def skinned_model(scene: Scene) -> tuple[mujoco.MjModel, dict[int, HandAppearance]]:
    """Returns a copy of a scene's model with skins, and the appearance of each hand, by index.

    The capsules of a hand with a skin are hidden. A hand without a skeleton has no skin, and is
    drawn as in its MJCF.
    """
    spec = mujoco.MjSpec.from_string(scene.xml)
    _materials(spec)
    appearances: dict[int, HandAppearance] = {}
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
        appearances[index] = HandAppearance(hand.skeleton, skin, numbers, [])
    model = spec.compile()
    for index, appearance in appearances.items():
        root = int(model.body(scene.spec.hands[index].palm).rootid[0])
        mine = model.body_rootid[model.geom_bodyid] == root
        # Casters are the simulation's capsules, which have names, and the sleeve's cylinders.
        named = np.array([bool(model.geom(g).name) for g in range(model.ngeom)])
        sleeve = model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER
        appearance.casters.extend(np.flatnonzero(mine & (named | sleeve)).tolist())
        model.geom_group[mine] = HIDDEN_GROUP
    return model, appearances


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


def _add_skin(
    spec: mujoco.MjSpec, hand: SceneHand, skin: Skin, part: str, name: str, group: int
) -> None:
    chosen = skin.part(part)
    triangles = skin.triangles[chosen.triangles] - chosen.vertices.start
    kind = part.partition("_")[0]
    made = spec.add_skin(name=name, material=f"hand {kind}", group=group)
    made.vert = skin.rest[chosen.vertices].ravel().tolist()
    made.face = triangles.ravel().tolist()
    if kind == "skin":
        # Use the centres of the palette's pixels, so that neighbouring colours are not blended in.
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
    """Returns the sRGB palette (64, 64, 3): warmth increases to the right, brightness downwards."""
    share = np.linspace(0.0, 1.0, PALETTE_SIZE)
    tones = np.stack(np.meshgrid(share, share), axis=-1)
    return np.asarray(np.round(255 * tone_colours(tones)), np.uint8)


def part_colour(part: str, hand: HandView) -> Colour | None:
    """Returns the colour of a part; None for skin.

    The nail of a touching finger has the colour of the finger.
    """
    kind, _, finger = part.partition("_")
    if kind == "skin":
        return None
    if kind != "nail":
        return CUFF if kind == "cuff" else SLEEVE
    label = FINGERS.index(finger)
    touching = {c.label for c in hand.contacts if c.state not in palette.NO_FINGER}
    return palette.finger_colour(label) if label in touching else NAIL
