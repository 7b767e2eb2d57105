"""Forward kinematics of one pose at a time, for the loop that reconstructs at every control step.

MuJoCo places the bones and differentiates fingertips and joints. So the result depends only on
MuJoCo's version and the system's libm: NumPy adds and multiplies element by element, which every
processor rounds alike. Results agree with those of `Kinematics` up to rounding. Captures and
training use `Kinematics`, so their digests do not depend on this module.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import mujoco
import numpy as np
from numpy.lib.stride_tricks import as_strided

from models.arithmetic import Array
from models.frames import FINGERS
from models.pose import JOINTS, POSE_SIZE, ROOT_ROTATION
from models.rotations import matrix_to_quaternion
from models.skeleton import Skeleton

_TINY = 1e-24
"""rad2, added to squared angles to avoid 0/0 in the closed forms. It does not change results: terms
that lose digits by cancellation are multiplied by the square of the same small vector."""

_FIRST_BONE = 2
"""Index of the first bone's body, after the world's and the root's."""

_TERMS = np.array([[9, 5, 7], [8, 9, 3], [4, 6, 9]])
"""Index of each element of a I - b skew(w) in the ten numbers of a rotation: c w, b w, -b w, a."""


class SinglePose:
    """Fingertips of single poses of one skeleton, and their derivative.

    Buffers are reused for every pose, so an object serves one thread at a time; returned arrays are
    new.

    Args:
        skeleton: The hand's skeleton.
        fingers: Labels of the k fingers, in the order of the results. The result for a finger does
            not depend on the other fingers, to the bit.
    """

    def __init__(self, skeleton: Skeleton, fingers: Sequence[int] = range(len(FINGERS))) -> None:
        self._model = model = _compiled(skeleton)
        self._data = data = mujoco.MjData(model)
        self._at_rest = model.qpos0.copy()
        self._qpos = data.qpos
        self._sites = [int(f) for f in fingers]
        self._site_xpos = data.site_xpos
        self._chosen = None if self._sites == list(range(len(FINGERS))) else np.array(self._sites)
        # MuJoCo's derivative with respect to rotations in the bones' own frames, three rows per
        # fingertip.
        self._raw = np.zeros((3 * len(self._sites), POSE_SIZE))
        self._rows = [(self._raw[3 * i : 3 * i + 3], site) for i, site in enumerate(self._sites)]
        # Rotation vectors w, and the vector parts w sin(t/2) / t of MuJoCo's quaternions. Rotations
        # are the last axis everywhere, so that NumPy's loops are long.
        turns = (POSE_SIZE - ROOT_ROTATION.start) // 3
        quaternions = data.qpos[3:].reshape(turns, 4)
        self._cosine, self._sine = quaternions[:, 0], quaternions[:, 1:].T
        self._factor, self._products = np.empty((2, 3, turns)), np.empty((2, 3, turns))
        self._sums = np.empty((2, turns))
        self._tiny = np.tile([[_TINY], [0.5 * _TINY]], turns)
        self._one = np.ones(turns)
        # For every rotation: c, b and -b, and the numbers c w, b w, -b w and a.
        self._scales, self._numbers = np.empty((3, turns)), np.empty((10, turns))
        # Block diagonal: 1 for the root's position, then the right Jacobian of every rotation.
        self._right = np.eye(POSE_SIZE)
        start = ROOT_ROTATION.start
        rotations = self._right[start:, start:]
        row, column = rotations.strides
        self._blocks = as_strided(rotations, (3, 3, turns), (row, column, 3 * (row + column)))
        self._outer, self._rest = np.empty((2, 3, 3, turns))
        # Views of the arrays above, created once: creating a view takes as long as a product.
        self._w, self._v = self._factor
        self._vectors = self._w.T
        self._x, self._y, self._z = np.moveaxis(self._products, 1, 0)
        self._t2, self._half = self._sums
        self._c, self._b, self._minus_b = self._scales
        self._a = self._numbers[9]
        self._scaled = self._numbers[:9].reshape(3, 3, turns)
        self._each_scale, self._column = self._scales[:, None], self._scaled[0][:, None]
        self._placed = b""
        # The bodies of the bones, whose origins are the joints.
        self._bodies = range(_FIRST_BONE, model.nbody)
        self._raw_joints = np.zeros((3 * len(self._bodies), POSE_SIZE))

    def tips(self, q: Array) -> Array:
        """Centres (k, 3) m of the fingertips of a pose (48,)."""
        self._place(q)
        tips: Array = (
            self._site_xpos.copy()
            if self._chosen is None
            else self._site_xpos.take(self._chosen, axis=0)
        )
        return tips

    def tips_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Fingertips (k, 3) m of a pose (48,), and their derivative (k, 3, 48) with respect to the
        pose."""
        tips = self.tips(q)
        return tips, self.jacobian(q)

    def jacobian(self, q: Array) -> Array:
        """Derivative (k, 3, 48) of the fingertips with respect to the pose.

        Args:
            q: (48,), the pose that was placed last.
        """
        mujoco.mj_comPos(self._model, self._data)
        for rows, site in self._rows:
            mujoco.mj_jacSite(self._model, self._data, rows, None, site)
        self._set_right_jacobians(q)
        # exp(w + d) = exp(w) exp(R d) with the right Jacobian R. The rotation R d is in the bone's
        # own frame.
        jacobian = np.empty(self._raw.shape)
        mujoco.mju_mulMatMat(jacobian, self._raw, self._right)
        return jacobian.reshape(-1, 3, POSE_SIZE)

    def joint_positions(self) -> Array:
        """Joint positions (63,) of the pose that was placed last: three slides and 15 quaternions,
        as in MuJoCo's `qpos` of `models.hand.Hand`."""
        return self._qpos.copy()

    def by_pose(self, by_turns: Array) -> Array:
        """Converts derivatives with respect to rotations in the bones' own frames to derivatives
        with respect to the pose, both (n, 48).

        The pose is that of the last call of `jacobian`.
        """
        by_pose = np.empty(by_turns.shape)
        mujoco.mju_mulMatMat(by_pose, by_turns, self._right)
        return by_pose

    def joints_and_tips(self, q: Array) -> tuple[Array, Array]:
        """Joints (14, 3) m, in the order of the skeleton's bones, and fingertips (k, 3)."""
        tips = self.tips(q)
        return self._data.xpos[_FIRST_BONE:].copy(), tips

    def joints_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Joints and then fingertips (14 + k, 3) m, and their derivative (14 + k, 3, 48).

        Unlike in the other methods, the derivative with respect to the root's rotation is for a
        rotation d in the root's own frame: exp(w) becomes exp(w) exp(d). A hand that faces the
        camera has a rotation vector near pi. It needs no special treatment with this derivative.
        """
        tips = self.tips(q)
        mujoco.mj_comPos(self._model, self._data)
        for rows, site in self._rows:
            mujoco.mj_jacSite(self._model, self._data, rows, None, site)
        self._set_right_jacobians(q)
        self._right[ROOT_ROTATION, ROOT_ROTATION] = np.eye(3)
        for i, body in enumerate(self._bodies):
            rows = self._raw_joints[3 * i : 3 * i + 3]
            mujoco.mj_jacBody(self._model, self._data, rows, None, body)
        everything = np.concatenate([self._raw_joints, self._raw])
        turned = np.empty(everything.shape)
        mujoco.mju_mulMatMat(turned, everything, self._right)
        points = np.concatenate([self._data.xpos[_FIRST_BONE:], tips])
        return points, turned.reshape(-1, 3, POSE_SIZE)

    def _place(self, q: Array) -> None:
        """Places all bones, unless they are already in this pose."""
        pose = q.tobytes()
        if pose == self._placed:
            return
        self._placed = pose
        self._qpos[:] = self._at_rest
        # From rest, one unit of time at the speed q ends in the pose q.
        mujoco.mj_integratePos(self._model, self._qpos, q, 1.0)
        mujoco.mj_kinematics(self._model, self._data)

    def _set_right_jacobians(self, q: Array) -> None:
        """Sets the right Jacobians of the rotation vectors of the pose that has been placed.

        They are a I - b skew(w) + c w w', with angle t, a = sin t / t, b = (1 - cos t) / t2 and
        c = (1 - a) / t2.
        """
        w, sums, t2, half, a, b, c = (
            self._w,
            self._sums,
            self._t2,
            self._half,
            self._a,
            self._b,
            self._c,
        )
        self._vectors[:] = q[ROOT_ROTATION.start :].reshape(-1, 3)
        self._v[:] = self._sine
        np.multiply(self._factor, w, self._products)
        # Sums of three numbers: x x + y y + z z, in this order.
        np.add(self._x, self._y, sums)
        sums += self._z
        sums += self._tiny
        half /= t2
        twice = half + half
        np.multiply(twice, self._cosine, a)
        np.subtract(self._one, a, c)
        c /= t2
        np.multiply(twice, half, b)
        np.negative(b, self._minus_b)
        np.multiply(self._each_scale, w, self._scaled)
        np.multiply(self._column, w, self._outer)
        self._outer += self._numbers.take(_TERMS, 0, self._rest, "clip")
        self._blocks[:] = self._outer


def tips_and_jacobians(hand: SinglePose, q: Array) -> tuple[Array, Array]:
    """Fingertips (n, k, 3) m of poses (n, 48), and their derivative (n, k, 3, 48) with respect to
    the poses.

    Every pose is computed separately, so that the result of a trial does not depend on trials that
    run side by side with it.
    """
    if len(q) == 1:
        tips, jacobian = hand.tips_and_jacobian(q[0])
        return tips[None], jacobian[None]
    each = [hand.tips_and_jacobian(row) for row in q]
    return np.array([tips for tips, _ in each]), np.array([jacobian for _, jacobian in each])


def _compiled(skeleton: Skeleton) -> mujoco.MjModel:
    """MuJoCo's model of a skeleton: bodies without shapes, and a site at every fingertip.

    The bodies are the root, which moves freely, and then the bones in the skeleton's order, each on
    a ball joint.
    """
    key = tuple(
        (b.name, b.finger, tuple(b.anchor), tuple(np.ravel(b.rest).tolist()), b.length)
        for b in skeleton.bones
    )
    return _compiled_bones(key)


@cache
def _compiled_bones(
    bones: tuple[tuple[str, int, tuple[float, ...], tuple[float, ...], float], ...],
) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    root = spec.worldbody.add_body(name="root")
    root.add_freejoint()
    _weigh(root)
    before: dict[int, mujoco.MjsBody] = {}
    ends: dict[int, tuple[mujoco.MjsBody, float]] = {}
    for name, finger, anchor, rest, length in bones:
        quaternion = matrix_to_quaternion(np.reshape(rest, (3, 3)))
        bone = before.get(finger, root).add_body(name=name, pos=anchor, quat=quaternion)
        bone.add_joint(type=mujoco.mjtJoint.mjJNT_BALL)
        _weigh(bone)
        before[finger], ends[finger] = bone, (bone, length)
    for finger, (bone, length) in ends.items():
        bone.add_site(name=FINGERS[finger], pos=(0.0, length, 0.0))
    model = spec.compile()
    bodies = [model.body(name).id for name, *_ in bones]
    sites = [model.site(name).id for name in FINGERS if name in {FINGERS[f] for f in ends}]
    assert bodies == list(range(_FIRST_BONE, _FIRST_BONE + len(bones))) and sites == list(
        range(len(ends))
    )
    assert model.nv == POSE_SIZE and JOINTS.stop == POSE_SIZE
    return model


def _weigh(body: mujoco.MjsBody) -> None:
    """Gives a moving body the mass that MuJoCo requires; positions do not depend on it."""
    body.explicitinertial = True
    body.mass, body.inertia = 1.0, (1.0, 1.0, 1.0)
