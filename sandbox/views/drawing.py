"""Drawing list of the scene for views: hand, objects, goals, contacts and the touch surface.

It works on copies of the model and its state, so that drawing cannot change a simulation. Goals and
contacts, which the model does not contain, are added as marks.

A ghost hand is drawn by blending two pictures, with and without the hand. If the hand itself were
drawn translucent, its far side would be visible through the near side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.frames import Contact
from models.objects import MechanismPart
from models.scene import TABLE, Scene
from models.skin.skin import PALE
from models.surface import Surface
from sandbox.session.messages import STRONGEST, HandView, Snapshot
from sandbox.views import palette
from sandbox.views.hand_appearance import HIDDEN_GROUP, part_colour, skinned_model
from sandbox.views.marks import Marks
from sandbox.views.palette import Colour
from tasks.task import Goal

FRONT, BACK, HALF_WIDTH, THICKNESS = -0.034, 0.16, 0.30, 0.014
"""The shelf in front of an upright surface, m: world y of its front and back edge, world x of its
sides, and its thickness. The front edge is just in front of the largest object."""
PANE = 0.040
"""Distance (m) in front of an upright touch surface at which touches are marked, so that objects do
not hide the marks."""

SHELF = (0.31, 0.37, 0.41)


def hide_table(model: mujoco.MjModel, group: int) -> None:
    """Hides the infinite table and the mat on it, by moving them to a group that is not drawn."""
    for name in (TABLE, "mat"):
        model.geom_group[model.geom(name).id] = group


def shelf() -> tuple[Array, Array]:
    """Returns half size (3,) and centre (3,) of the shelf that is drawn instead of the table, m."""
    half = np.array([HALF_WIDTH, (BACK - FRONT) / 2, THICKNESS / 2])
    return half, np.array([0.0, (BACK + FRONT) / 2, -THICKNESS / 2])


Hidden = Literal["ghosts", "hands"]
"""Hands that are left out of a picture: ghosts only, or all."""

MAX_GEOMS = 2000
"""Capacity of the drawing list; five contacts, two goals and two hands take about 400."""

RING_RADIUS, RING_WIDTH, RING_SIDES = 0.0100, 0.0016, 20
"""Radius (m), width (m) and number of straight pieces of the ring around a contact."""
ARC_RADIUS, ARC_WIDTH = 0.0130, 0.0014
"""Radius and width (m) of the arc around the ring that shows the force of a grip."""
EDGE_RADIUS, THREAD_RADIUS = 0.0008, 0.0006
"""Radii (m) of the edges of a goal and of the threads between touches and fingertips."""
PALM_RADIUS = 0.015
"""Radius (m) of the disc at a contact of a palm."""
LIFT = 0.0007
"""Height (m) of flat marks above the table. The mat is 0.2 mm above the table; marks closer to it
would flicker."""
OUTLINE_WIDTH = 0.0012
"""Width (m) of the line around the touch surface."""

ORTHOGRAPHIC_HEIGHT = 1.6
"""Visible height of a camera without perspective, in heights of the touch surface."""

SHADOW_REACH = 0.25
"""Shadows are drawn within this radius (m) around the table's centre. Smaller values give sharper
shadows."""

CASTER_WIDTH, CASTER_DEPTH = 0.62, 0.20
"""Width of a shadow caster relative to the finger's capsule, and its shift towards the finger pad,
in radii. It is shifted because the skin on the back of a bent finger is close to the bone."""


@dataclass(frozen=True)
class _GoalPart:
    """A geom of an object, in the object's frame; it is drawn again at the object's goal."""

    type: int
    size: Array
    position: Array
    rotation: Array
    mesh: int


class Drawing:
    """MuJoCo's drawing list for snapshots of one scene.

    Args:
        scene: The scene, whose model is copied.
        surface: The touch surface.
        rings_on_table: True marks contacts on the table below the touch surface, which looks
            natural from the side. False marks them on the touch surface itself, so that a mark is
            exactly under the pointer for any camera.

    Attributes:
        view: The drawing list, filled by `update`.
        model: The copy of the model that is drawn.
        appearances: Appearance of each hand that has a skin, by index of the hand.
        narrowness: Factor on the camera's visible height, for pictures higher than wide.
    """

    def __init__(self, scene: Scene, surface: Surface, rings_on_table: bool = True) -> None:
        self.surface = surface
        self.model, self.appearances = skinned_model(scene)
        self.narrowness = 1.0
        self._fovy = float(self.model.vis.global_.fovy)
        self.model.vis.map.shadowclip = SHADOW_REACH / self.model.stat.extent
        self.view = mujoco.MjvScene(self.model, MAX_GEOMS)
        self._marks = Marks(self.view)
        self._data = mujoco.MjData(self.model)
        hands = scene.spec.hands
        self._bones = {
            i: [self.model.body(b).id for b in (h.palm, *(link.body for link in h.links))]
            for i, h in enumerate(hands)
            if i in self.appearances
        }
        # Geoms of hands without a skin, and the groups in which they are visible.
        self._own_shapes = {
            i: (own, self.model.geom_group[own].copy())
            for i, h in enumerate(hands)
            if i not in self.appearances
            for own in [self._geoms_below(h.palm)]
        }
        self._option = mujoco.MjvOption()
        self._option.geomgroup[HIDDEN_GROUP:] = 0
        self._owners = {
            n: (i, part)
            for i, appearance in self.appearances.items()
            for part, n in appearance.parts.items()
        }
        self._parts = {n: self._parts_of(body) for n, body in scene.object_bodies.items()}
        # Parts of mechanisms get no ring at the goal: it would cover other parts.
        self._joined = {o.name for o in scene.spec.objects if isinstance(o, MechanismPart)}
        flat = surface.rotation[2, 2] > 0.999
        height = surface.origin[2] - LIFT if flat and rings_on_table else 0.0
        # Contacts are marked on a plane parallel to the surface, shifted to the table or the pane.
        pane = PANE if surface.upright and rings_on_table else 0.0
        self.drop = surface.rotation[:, 2] * (pane - height)
        ground = surface.origin[2] - LIFT if flat else 0.0
        self._outline_drop = surface.rotation[:, 2] * (pane - ground)
        if surface.upright:
            hide_table(self.model, HIDDEN_GROUP)

    def update(
        self,
        snapshot: Snapshot,
        camera: mujoco.MjvCamera,
        hidden: Hidden | None = None,
    ) -> None:
        """Fills the drawing list.

        Args:
            snapshot: The snapshot to draw.
            camera: The camera.
            hidden: Hands that are left out: `ghosts`, `hands` (all), or None.
        """
        model, data = self.model, self._data
        data.qpos[:] = snapshot.qpos
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
        drawn = [hidden is None or (hidden == "ghosts" and bool(h.solid)) for h in snapshot.hands]
        self._option.skingroup[:] = 0
        self._option.skingroup[: len(drawn)] = drawn
        for i, (own, groups) in self._own_shapes.items():
            model.geom_group[own] = groups if drawn[i] else HIDDEN_GROUP
        # For an orthographic camera, MuJoCo's `fovy` is the visible height in m.
        model.vis.global_.fovy = (
            self.narrowness * ORTHOGRAPHIC_HEIGHT * self.surface.size[1]
            if camera.orthographic
            else 2.0 * np.degrees(np.arctan(self.narrowness * np.tan(np.radians(self._fovy) / 2)))
        )
        mujoco.mjv_updateScene(
            model, data, self._option, None, camera, mujoco.mjtCatBit.mjCAT_ALL, self.view
        )
        self._finish_model(snapshot)
        self._draw_outline()
        if self.surface.upright:
            half, place = shelf()
            self._marks.box(half, place, np.eye(3), SHELF, 1.0)
        colour = goal_colour(snapshot)
        for goal in snapshot.goals:
            if goal.drawn:
                self._draw_goal(goal, snapshot, colour)
        for i, hand in enumerate(snapshot.hands):
            if drawn[i]:
                if i in self.appearances:
                    self._draw_casters(self.appearances[i].casters)
                self._draw_threads(hand)
            for contact, place in zip(hand.contacts, hand.places + self.drop, strict=True):
                self._draw_contact(contact, place, hand)
                self._draw_grip(contact, place, snapshot, i)

    def sees_sky(self) -> bool:
        """True if the picture shows anything above the horizon, so that the sky must be drawn."""
        camera = mujoco.mjv_averageCamera(self.view.camera[0], self.view.camera[1])
        if camera.orthographic:
            return bool(camera.forward[2] > -0.1)
        # The ray through the middle of the upper edge points highest.
        highest = camera.forward + camera.up * (camera.frustum_top / camera.frustum_near)
        return bool(highest[2] > 0.0)

    def held_back(self, snapshot: Snapshot) -> tuple[list[Array], list[Array]]:
        """Returns triangles of solid hands that objects keep from their commanded pose.

        It uses the snapshot of the last `update`.

        Returns:
            Two lists with an entry for each such hand: triangles (n, 3, 3) m of its displaced parts
            in the commanded pose, and triangles (m, 3, 3) m of the whole hand in the present pose.
        """
        away, here = [], []
        for i, appearance in self.appearances.items():
            if not snapshot.hands[i].solid:
                continue
            bones = self._data.xpos[self._bones[i]], self._data.xmat[self._bones[i]]
            there, whole = appearance.triangles(
                bones[0], bones[1].reshape(-1, 3, 3), snapshot.hands[i]
            )
            if len(there):
                away.append(there)
                here.append(whole)
        return away, here

    def _geoms_below(self, palm: str) -> NDArray[np.int64]:
        """Returns the geom numbers of a hand."""
        model, root = self.model, int(self.model.body(palm).id)
        return np.flatnonzero(model.body_rootid[model.geom_bodyid] == root)

    def _parts_of(self, body: int) -> list[_GoalPart]:
        model = self.model
        parts = []
        for g in np.flatnonzero(model.geom_bodyid == body):
            rotation = np.empty(9)
            mujoco.mju_quat2Mat(rotation, model.geom_quat[g])
            parts.append(
                _GoalPart(
                    int(model.geom_type[g]),
                    model.geom_size[g].copy(),
                    model.geom_pos[g].copy(),
                    rotation.reshape(3, 3),
                    int(model.geom_dataid[g]),
                )
            )
        return parts

    def _finish_model(self, snapshot: Snapshot) -> None:
        """Changes entries of the drawing list that the model does not define."""
        for i in range(self.view.ngeom):
            geom = self.view.geoms[i]
            if geom.type == mujoco.mjtGeom.mjGEOM_PLANE:
                # As a shadow caster, the infinite plane would only cause dark specks on itself.
                geom.category = mujoco.mjtCatBit.mjCAT_DECOR
            if geom.objtype == mujoco.mjtObj.mjOBJ_SKIN:
                geom.category = mujoco.mjtCatBit.mjCAT_DECOR
                if geom.objid in self._owners:
                    index, part = self._owners[geom.objid]
                    colour = part_colour(part, snapshot.hands[index])
                    if colour is not None:
                        geom.rgba[:3] = colour

    def _draw_casters(self, casters: list[int]) -> None:
        """Adds thin capsules, hidden inside the visible hand, that cast the hand's shadow.

        The skin itself casts none: with a coarse shadow map, a curved surface that casts a shadow
        on itself is covered with dark specks.
        """
        if not self.view.flags[mujoco.mjtRndFlag.mjRND_SHADOW]:
            return
        for g in casters:
            # A little shorter as well, so that the caster is not visible at the sleeve's end.
            size = self.model.geom_size[g] * np.array([CASTER_WIDTH, 0.98, 1.0])
            back = self._data.xmat[self.model.geom_bodyid[g]].reshape(3, 3)[:, 2]
            depth = CASTER_DEPTH * self.model.geom_size[g, 0]
            place, turn = self._data.geom_xpos[g] - depth * back, self._data.geom_xmat[g]
            caster = self._marks.shape(self.model.geom_type[g], size, place, turn, PALE, 1.0)
            if caster is not None:
                caster.category = mujoco.mjtCatBit.mjCAT_DYNAMIC
                # Lit like skin, so that it is inconspicuous where it is visible.
                caster.emission = 0.0

    def _draw_outline(self) -> None:
        width, height = self.surface.size
        corners = self.surface.to_world([[0, 0], [width, 0], [width, height], [0, height]])
        corners += self._outline_drop
        rotation = self.surface.rotation
        half = OUTLINE_WIDTH / 2
        for i, length in enumerate((width, height, width, height)):
            middle = (corners[i] + corners[(i + 1) % 4]) / 2
            along = [length / 2 + half, half] if i % 2 == 0 else [half, length / 2 - half]
            self._marks.box([*along, 1e-4], middle, rotation, palette.OUTLINE, 0.9)

    def _draw_goal(self, goal: Goal, snapshot: Snapshot, colour: Colour) -> None:
        cos, sin = np.cos(goal.yaw), np.sin(goal.yaw)
        rotation = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        position = np.asarray(goal.position)
        now = snapshot.objects.get(goal.object)
        off = np.inf if now is None else float(np.linalg.norm(now.position - position))
        # Faces that nearly coincide with those of the object would flicker: fade them near it.
        faces = 0.15 * float(np.clip((off - 0.004) / 0.016, 0.0, 1.0))
        done = snapshot.score.final or snapshot.score.held
        for part in self._parts[goal.object]:
            place, turn = position + rotation @ part.position, rotation @ part.rotation
            if faces > 0.0:
                size = part.size * 1.004
                self._marks.shape(part.type, size, place, turn, colour, faces, part.mesh)
            if part.type == mujoco.mjtGeom.mjGEOM_BOX:
                edge = EDGE_RADIUS * (1.8 if done else 1.0)
                self._marks.edges(part.size + 0.7 * edge, place, turn, colour, edge)
        if done and goal.object not in self._joined:
            ground = np.array([position[0], position[1], LIFT])
            reach = 1.9 * max(float(np.linalg.norm(p.size[:2])) for p in self._parts[goal.object])
            self._marks.ring(ground, np.eye(3), reach / 1.4, 0.003, 48, colour, 1.0)
            self._marks.disc(reach / 1.4, ground, np.eye(3), colour, 0.20)

    def _draw_threads(self, hand: HandView) -> None:
        """Adds a line from every touch to its fingertip, to show where the tip will land."""
        for contact, place in zip(hand.contacts, hand.places + self.drop, strict=True):
            if contact.label is not None and contact.state not in palette.NO_FINGER:
                colour = palette.finger_colour(contact.label)
                self._marks.line(place, hand.tips[contact.label], THREAD_RADIUS, colour, 0.9)

    def _draw_contact(self, contact: Contact, place: Array, hand: HandView) -> None:
        colour = palette.finger_colour(contact.label, contact.state)
        strength = 0.45 if contact.state == "lost" else 1.0
        rotation = self.surface.rotation
        if contact.state == "palm":
            self._marks.disc(PALM_RADIUS, place, rotation, colour, 0.12)
            return
        size = RING_RADIUS, RING_WIDTH, RING_SIDES
        self._marks.ring(place, rotation, *size, colour, strength, dashed=not contact.sure)
        filled = 0.55 if contact.label in hand.solid else 0.22
        self._marks.disc(RING_RADIUS, place, rotation, colour, filled * strength)

    def _draw_grip(self, contact: Contact, place: Array, snapshot: Snapshot, hand: int) -> None:
        """Adds an arc whose length shows the force of a grip in a finger.

        The arc is a full ring, and white, if the force is at its limit.
        """
        full = snapshot.at_limit(hand, contact.label)
        stored = snapshot.stored(hand, contact.label)
        if full or stored > 0.0:
            share = 1.0 if full else min(stored / STRONGEST, 1.0)
            colour = palette.TEXT if full else palette.finger_colour(contact.label, contact.state)
            rotation = self.surface.rotation
            self._marks.arc(place, rotation, ARC_RADIUS, ARC_WIDTH, share, colour)


def goal_colour(snapshot: Snapshot) -> Colour:
    """Returns the colour of the goal: green, bright green if reached, gold if it was held."""
    if snapshot.score.held:
        return palette.HELD
    return palette.REACHED if snapshot.score.final else palette.GOAL
