"""The hand as URDF, with the masses of our own model, and as a body in Bullet that follows poses.

The URDF is written from the compiled MuJoCo model, bone by bone, so that both engines move the same
masses. URDF has no armature, the inertia that MuJoCo adds at a joint. At the root the armature is
equal to a heavier carriage and a larger inertia of the palm, and is always written so. At a ball
joint between two bones there is no equal: `loaded` adds it to the inertia of the bone, which is the
closest approximation.
"""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from models.arithmetic import Array
from models.errors import InputError
from models.hand import ROOT_INERTIA, ROOT_MASS, Hand
from models.rotations import quaternion_exp, quaternion_log
from models.scene import Scene, SceneSpec

LIGHT_MASS, LIGHT_INERTIA = 1e-6, 1e-9
"""Mass (kg) and inertia (kg m2) of the two carriages that URDF needs between the three slides of
the root."""
SLIDES = ("root_x", "root_y", "root_z")


class Inertia:
    """Mass of one body, its centre, and the axes in which its inertia is diagonal.

    Attributes:
        mass: Mass (kg).
        place: (3,) centre of mass (m) in the body's frame.
        axes: (3, 3) rotation from the principal axes to the body's frame.
        principal: (3,) moments of inertia (kg m2) about the principal axes.
    """

    def __init__(self, model: mujoco.MjModel, body: str, added: float) -> None:
        self.mass = float(model.body(body).mass[0])
        self.place = np.array(model.body(body).ipos)
        w, x, y, z = model.body(body).iquat
        axes = Rotation.from_quat([x, y, z, w]).as_matrix()
        tensor = axes @ np.diag(model.body(body).inertia) @ axes.T
        self.principal = np.diag(tensor).copy()
        self.axes = np.eye(3)
        if np.abs(tensor - np.diag(self.principal)).max() > 1e-6 * self.principal.max():
            self.principal, self.axes = np.linalg.eigh(tensor)
            self.axes[:, 0] *= np.linalg.det(self.axes)
        self.principal += added


def inertias(hand: Hand, loaded: bool) -> dict[str, Inertia]:
    """Returns masses and inertias of the palm and of every bone of a hand, by name.

    Args:
        hand: The hand.
        loaded: Adds each ball joint's armature to the inertia of the bone beyond the joint.
    """
    model = Scene(SceneSpec((hand,))).model
    found = {"palm": Inertia(model, hand.element_name("palm"), ROOT_INERTIA)}
    for bone in hand.skeleton.bones:
        added = bone.armature if loaded else 0.0
        found[bone.name] = Inertia(model, hand.element_name(bone.name), added)
    return found


def hand_urdf(hand: Hand, loaded: bool = False) -> str:
    """Returns the URDF of a hand: three slides, then a ball joint for the root and one per bone.

    The joints are named `root_x_joint`, `root_y_joint`, `root_z_joint`, `root_joint` and, for each
    of `Skeleton.bones`, the bone's name with `_joint`. The bodies have no collision shape and no
    visual shape.

    Args:
        hand: The hand.
        loaded: See `inertias`.
    """
    robot = Element("robot", {"name": "hand"})
    bodies = inertias(hand, loaded)
    # Bullet would give a link without mass 1 kg, with a warning on every start.
    _link(robot, "ground", LIGHT_MASS, np.zeros(3), np.eye(3), np.full(3, LIGHT_INERTIA))
    parent = "ground"
    for name, axis in zip(SLIDES, np.eye(3), strict=True):
        # The last carriage moves along all three axes: its mass is the root's armature of each.
        mass = ROOT_MASS if name == SLIDES[-1] else LIGHT_MASS
        _link(robot, name, mass, np.zeros(3), np.eye(3), np.full(3, LIGHT_INERTIA))
        joint = _joint(robot, name, "prismatic", parent, name, np.zeros(3), np.eye(3))
        next(joint.iter("axis")).set("xyz", _text(axis))
        SubElement(
            joint,
            "limit",
            {
                "lower": "-10",
                "upper": "10",
                "effort": "1e6",
                "velocity": "1e3",
            },
        )
        parent = name
    joints = [("root", "palm", parent, np.zeros(3), np.eye(3))]
    last: dict[int, str] = {}
    for bone in hand.skeleton.bones:
        before = last.get(bone.finger, "palm")
        joints.append((bone.name, bone.name, before, np.array(bone.anchor), bone.rest))
        last[bone.finger] = bone.name
    for name, child, before, place, rest in joints:
        body = bodies[child]
        _link(robot, child, body.mass, body.place, body.axes, body.principal)
        _joint(robot, name, "spherical", before, child, place, rest)
    indent(robot)
    return tostring(robot, encoding="unicode")


def _link(
    robot: Element, name: str, mass: float, place: Array, axes: Array, inertia: Array
) -> None:
    inertial = SubElement(SubElement(robot, "link", {"name": name}), "inertial")
    _origin(inertial, place, axes)
    SubElement(inertial, "mass", {"value": _text([mass])})
    moments = {f"i{a}{b}": "0" for a, b in ("xy", "xz", "yz")}
    moments |= {f"i{a}{a}": _text([i]) for a, i in zip("xyz", inertia, strict=True)}
    SubElement(inertial, "inertia", moments)


def _joint(
    robot: Element, name: str, kind: str, parent: str, child: str, place: Array, rest: Array
) -> Element:
    joint = SubElement(robot, "joint", {"name": f"{name}_joint", "type": kind})
    SubElement(joint, "parent", {"link": parent})
    SubElement(joint, "child", {"link": child})
    _origin(joint, place, rest)
    # A ball joint has no axis, but Bullet's reader warns if the element is missing.
    SubElement(joint, "axis", {"xyz": "1 0 0"})
    return joint


def _origin(element: Element, place: Array, axes: Array) -> None:
    rpy = Rotation.from_matrix(axes).as_euler("xyz")
    SubElement(element, "origin", {"xyz": _text(place), "rpy": _text(rpy)})


def _text(values: Any) -> str:
    return " ".join(f"{float(v):.12g}" for v in values)


@cache
def bullet_world() -> Any:
    """Returns the Bullet engine of this process, connected once.

    Raises:
        InputError: pybullet is not installed.
    """
    try:
        import pybullet
    except ImportError:
        raise InputError(
            "pybullet is not installed", remedy='pip install "hand-sandbox[bullet]"'
        ) from None
    pybullet.connect(pybullet.DIRECT)
    return pybullet


class BulletHand:
    """The hand in Bullet's world: in free air, without gravity and other bodies, like ours.

    A new `BulletHand` removes the one before it from the world.

    Args:
        hand: The hand. Its `force_limit` limits every motor (N or N m).
        rate: Number of steps a second.
        gain: Share of the remaining rotation or distance that every motor corrects in one step.
        loaded: See `inertias`.
        erp: ERP of Bullet's world. The motors of its ball joints multiply their gain by it.

    Raises:
        InputError: pybullet is not installed.
    """

    def __init__(
        self, hand: Hand, rate: float, gain: float = 1.0, loaded: bool = True, erp: float = 1.0
    ) -> None:
        self._world = pybullet = bullet_world()
        self._world.resetSimulation()
        self._world.setGravity(0.0, 0.0, 0.0)
        self._world.setPhysicsEngineParameter(fixedTimeStep=1.0 / rate, numSubSteps=0, erp=erp)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "hand.urdf"
            path.write_text(hand_urdf(hand, loaded))
            self._body = self._world.loadURDF(
                str(path), useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE
            )
        self._mode = pybullet.POSITION_CONTROL
        count = self._world.getNumJoints(self._body)
        index = {self._world.getJointInfo(self._body, i)[12].decode(): i for i in range(count)}
        self._slides = [index[name] for name in SLIDES]
        self._balls = [index["palm"], *(index[b.name] for b in hand.skeleton.bones)]
        # Bullet gives a ball joint's rotation in the principal axes of the body beyond it.
        self._axes = np.stack([body.axes for body in inertias(hand, loaded).values()])
        for i in range(-1, count):
            self._world.changeDynamics(
                self._body, i, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0
            )
        self._limit = hand.force_limit
        self._gain = gain

    def place(self, q: Array) -> None:
        """Sets the pose (48,) of the hand, at rest."""
        for i, value in zip(self._slides, q[:3], strict=True):
            self._world.resetJointState(self._body, i, value, 0.0)
        for i, turn in zip(self._balls, self._turns(q), strict=True):
            self._world.resetJointStateMultiDof(self._body, i, turn, [0.0, 0.0, 0.0])

    def command(self, q: Array) -> None:
        """Sets the target pose (48,) of all motors."""
        for i, value in zip(self._slides, q[:3], strict=True):
            self._world.setJointMotorControl2(
                self._body,
                i,
                self._mode,
                targetPosition=value,
                targetVelocity=0.0,
                positionGain=self._gain,
                velocityGain=1.0,
                force=self._limit,
            )
        n = len(self._balls)
        self._world.setJointMotorControlMultiDofArray(
            self._body,
            self._balls,
            self._mode,
            targetPositions=self._turns(q),
            targetVelocities=[[0.0] * 3] * n,
            positionGains=[self._gain] * n,
            velocityGains=[1.0] * n,
            forces=[[self._limit] * 3] * n,
        )

    def step(self) -> tuple[Array, Array, Array]:
        """Simulates one step.

        Returns:
            Pose (48,), forces (3,) of the slides (N), and torques (15, 3) of the ball joints (N m).
        """
        self._world.stepSimulation()
        slides = self._world.getJointStates(self._body, self._slides)
        balls = self._world.getJointStatesMultiDof(self._body, self._balls)
        turns = np.array([s[0] for s in balls])[:, [3, 0, 1, 2]]
        vectors = (self._axes @ quaternion_log(turns)[..., None])[..., 0]
        pose = np.concatenate([[s[0] for s in slides], vectors.ravel()])
        return pose, np.array([s[3] for s in slides]), np.array([s[3] for s in balls])

    def joints(self) -> Array:
        """Returns the positions (14, 3) of the ball joints in the world, m."""
        states = self._world.getLinkStates(
            self._body, self._balls[1:], computeForwardKinematics=True
        )
        return np.array([state[4] for state in states])

    def _turns(self, q: Array) -> list[list[float]]:
        """Returns the quaternions (x, y, z, w) of the root and the ball joints in Bullet's axes."""
        vectors = (np.swapaxes(self._axes, 1, 2) @ q[3:].reshape(-1, 3)[..., None])[..., 0]
        return [list(map(float, v)) for v in quaternion_exp(vectors)[:, [1, 2, 3, 0]]]
