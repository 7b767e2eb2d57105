"""The control loop: devices -> reconstruction -> servo targets -> physics -> score -> views.

All timing follows simulated time, not the clock. One call of `advance` is one control period. A
session with a person calls it at real time, a headless run as fast as possible. Nothing here reads
a clock, so that equal inputs give bit-identical states.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from hashlib import blake2b
from math import isfinite
from typing import TYPE_CHECKING, Any, Protocol

import mujoco
import numpy as np

from encoders.person.natural_layout import YawMonitor
from encoders.reconstruction.hand_motion import Phase
from encoders.reconstruction.reconstructor import (
    AirReconstructor,
    Reconstruction,
    Reconstructor,
    takes_touches,
)
from models.arithmetic import Array, squared_lengths
from models.errors import DivergenceError
from models.frames import Frame, TouchFrame
from models.hand import SceneHand
from models.message import Message
from models.scene import BodyPoses, Scene, StillPoses
from models.surface import Surface, enclosing
from sandbox.devices.device import AnyDevice, LatestFrame
from sandbox.session.collision_gating import (
    CollisionGate,
    CollisionGatingRules,
    ContactMode,
    ContactModes,
    contact_mode,
)
from sandbox.session.contact_forces import FingerLoads
from sandbox.session.messages import HandLoad, HandView, ObjectView, Snapshot
from sandbox.session.respawn import Respawn
from sandbox.session.tip_offsets import TipOffsets
from tasks.guarded import build_scene
from tasks.score import Scorer, Status, measure
from tasks.sensing import Sensing
from tasks.task import Task

if TYPE_CHECKING:
    from sandbox.session.collision_avoidance import CollisionAvoidance, SolidLinks

NOTICE_TIME = 2.0
"""Duration of the notice about an object that was put back, s."""

OUT_OF_REACH = "a finger is where this robot's hand cannot reach"
"""Notice in English only, until translations exist that were checked by back-translation."""

STATE = mujoco.mjtState.mjSTATE_INTEGRATION
"""The parts of MuJoCo's state that must be stored so that a continued simulation gives
bit-identical results. `FULLPHYSICS` lacks the solver's warm start: a simulation continued from it
differs at the first step."""


@dataclass
class Rig:
    """A device, the reconstructor of its frames, and the hand they drive.

    Attributes:
        device: Source of touch frames or hand frames.
        reconstructor: Turns frames into poses.
        hand: The simulated hand that follows the poses.
        yaw: Warns about hands that are turned too far, without changing a pose; None never warns.
        rules: Collision gating of this hand; None uses the session's rules.
    """

    device: AnyDevice
    reconstructor: Reconstructor | AirReconstructor
    hand: SceneHand
    yaw: YawMonitor | None = None
    rules: CollisionGatingRules | None = None


class Recorder(Protocol):
    """Contract of a session's recorders. A recorder must not block, and must never lose data."""

    def input(self, step: int, hand: int, frame: Frame, state_hash: str) -> None:
        """Records a frame, the step at which it takes effect, and the state's hash before this
        step."""
        ...

    def event(self, step: int, what: str, **details: Any) -> None:
        """Records an event other than a frame, such as a change of the contact mode, at a step."""
        ...

    def state(
        self,
        step: int,
        state: Array,
        state_hash: str,
        qpos: Array,
        solid: Sequence[frozenset[int]],
    ) -> None:
        """Records the state at the beginning of a control period.

        The session overwrites the arrays afterwards, so a recorder must copy what it stores.
        """
        ...


class Session:
    """One trial of a task with its rigs.

    Args:
        task: The task, with the start and goals of one trial already drawn at random.
        rigs: One rig per hand.
        rules: Collision gating of hands without rules of their own; None uses the defaults.
        timestep: Physics time step, s.
        recorder: Records inputs and states; None records nothing.
        contact: Initial contact mode.
        friction: Factor on every coefficient of sliding friction.

    Attributes:
        diverged: Reason of a divergence; empty without one.
        shown: False leaves the loads out of snapshots, for runs without views.
    """

    def __init__(
        self,
        task: Task,
        rigs: Sequence[Rig],
        rules: CollisionGatingRules | None = None,
        timestep: float = 0.002,
        recorder: Recorder | None = None,
        contact: str = ContactMode.HARD,
        friction: float = 1.0,
    ) -> None:
        self.task, self.rigs = task, tuple(rigs)
        gating = [
            replace(rig.rules or rules or CollisionGatingRules(), from_above=task.pressed)
            for rig in rigs
        ]
        hands = tuple(rig.hand for rig in rigs)
        all_over = [own.all_over for own in gating]
        self.scene = build_scene(task, hands, timestep, all(all_over))
        self.scene.model.geom_friction[:, 0] *= friction
        self.data = mujoco.MjData(self.scene.model)
        surfaces = [rig.reconstructor.surface for rig in rigs]
        # Reconstructors of hands driven by touches; None for hands in the air.
        self._touched = [
            rig.reconstructor if takes_touches(rig.reconstructor) else None for rig in rigs
        ]
        parts, self._avoidance = self._whole_hands(all_over, surfaces)
        self._gates = [
            CollisionGate(self.scene, i, own, part)
            for i, (own, part) in enumerate(zip(gating, parts, strict=True))
        ]
        self._tip_offsets = [
            TipOffsets(self.scene, i, surface, gate) if touched and own.lead else None
            for i, (touched, own, surface, gate) in enumerate(
                zip(self._touched, gating, surfaces, self._gates, strict=True)
            )
        ]
        self._hands = [(s.tips, on) for s, on in zip(self._gates, surfaces, strict=True)]
        self._contact = ContactModes(self.scene, contact_mode(contact))
        self._asked: ContactMode | None = None
        self._loads = FingerLoads(self.scene)
        goals = [goal.position for goal in task.goals if goal.shown and goal.on is None]
        self._respawn = Respawn(self.scene, surfaces, goals)
        self._respawn_notice: tuple[float, str] = (-np.inf, "")
        self.diverged, self.shown = "", True
        self._followers = [rig.hand.follower() for rig in rigs]
        # Control periods with touches, for robot hands only; and the number of these periods in
        # which a fingertip could not reach its touch.
        self._followed = self._missed = 0
        self._latest_frames = [LatestFrame(rig.reconstructor.empty) for rig in rigs]
        self._recorder = recorder
        self.step = 0
        self._begin()
        self._sensing = Sensing(self.scene, self.data)
        # An invalid measure of the task is reported before the trial begins.
        measure(task, self._sensing)
        self.scorer = Scorer(task)
        self._state = np.empty(mujoco.mj_stateSize(self.scene.model, STATE))
        self._hash = b""
        self._chain()
        # Before the first step, views show the hand at its start.
        self.reconstructions = [
            Reconstruction(r.reconstructor.commanded, Phase.AWAY, frozenset(), None, 1.0, 0.0)
            for r in self.rigs
        ]

    @property
    def first_rig(self) -> Rig:
        """The rig of the first hand, which is the hand of the person at the window or the page."""
        return self.rigs[0]

    @property
    def time(self) -> float:
        """Simulated time since the trial began, s."""
        return self.step * self.scene.spec.timestep

    @property
    def whole_surface(self) -> Surface:
        """The smallest surface that encloses the surfaces of all hands."""
        return enclosing([rig.reconstructor.surface for rig in self.rigs])

    @property
    def over(self) -> bool:
        """True once the trial has ended."""
        return self.scorer.over

    @property
    def state_hash(self) -> str:
        """Chained BLAKE2b of the integration states at all control steps so far, hexadecimal."""
        return self._hash.hex()

    @property
    def contact(self) -> ContactMode:
        """The current contact mode."""
        return self._contact.mode

    @property
    def respawned(self) -> int:
        """Number of times that an object was returned to the workspace."""
        return sum(self._respawn.counts.values())  # any order: sums of integers are exact

    @property
    def unreached(self) -> float | None:
        """Share of the control periods in which a fingertip is 5 mm or more from its touch.

        Only control periods with labelled touches of robot hands count. None without a robot hand.
        """
        if not any(self._followers):
            return None
        return self._missed / self._followed if self._followed else 0.0

    def solid(self, hand: int) -> frozenset[int]:
        """Labels of a hand's fingers that can collide now."""
        return self._gates[hand].solid

    def _whole_hands(
        self, all_over: Sequence[bool], surfaces: Sequence[Surface]
    ) -> tuple[list[SolidLinks | None], list[CollisionAvoidance | None]]:
        """Creates the links and the collision avoidance of hands that are solid all over."""
        parts: list[SolidLinks | None] = [None] * len(self.rigs)
        avoidance: list[CollisionAvoidance | None] = [None] * len(self.rigs)
        if not any(all_over):
            return parts, avoidance
        # Imported only when needed: most trials have only hands whose fingertips alone are solid.
        from sandbox.session.collision_avoidance import (
            CollisionAvoidance,
            HandDistances,
            SolidLinks,
        )

        for i, (rig, surface) in enumerate(zip(self.rigs, surfaces, strict=True)):
            if all_over[i]:
                distances = HandDistances(self.scene, i)
                parts[i] = SolidLinks(self.scene, i, distances)
                skeleton = rig.hand.skeleton
                # The pose of a hand in the air is measured completely. Only a pose derived from
                # touches is partly free, and may be changed to avoid objects.
                if self._touched[i] and skeleton:
                    avoidance[i] = CollisionAvoidance(self.scene, i, skeleton, surface, distances)
        return parts, avoidance

    def correction(self, hand: int) -> Array | None:
        """Correction (48,) added to a hand's pose to clear objects, m and rad; None without one."""
        avoidance = self._avoidance[hand]
        return None if avoidance is None else avoidance.offset

    def latest_frame(self, hand: int) -> Frame:
        """Returns the latest frame of a hand's device, stamped with session time."""
        return self._latest_frames[hand].frame

    def lift(self, hand: int) -> float | None:
        """Position of the lift control of a hand's device, 0 to 1; None if it has none."""
        frame = self._latest_frames[hand].frame
        return frame.lift if isinstance(frame, TouchFrame) else None

    def tips(self, hand: int, data: mujoco.MjData) -> Array:
        """Returns the fingertips (5, 3) of a hand in a state of this session's model, m."""
        return self._gates[hand].tips(data)

    def loads(self) -> list[HandLoad]:
        """Returns the current loads of each hand's fingers and palm.

        The load of a palm is the share of its force limit that the most loaded servo uses.

        Call it in the session's thread. States do not depend on it.
        """
        return self._loads.read(self.data)

    def set_contact(self, mode: str) -> None:
        """Requests another contact mode, from any thread. The mode changes with the next step.

        The request does not change the current state. After the mode `none`, a finger inside an
        object stays a ghost until it is out.

        Raises:
            InputError: No contact mode has this name.
        """
        self._asked = contact_mode(mode)

    def advance(self) -> Snapshot:
        """Runs one control period.

        Raises:
            DivergenceError: The simulation diverged; the trial's score is already `diverged`.
        """
        if self.step == 0:
            self._record_state()
        self._switch()
        self.reconstructions = [self._command(i) for i in range(len(self.rigs))]
        # The state was checked at the end of the last period.
        wrong = command_error(self.data)
        if not wrong:
            mujoco.mj_step(self.scene.model, self.data, self.scene.substeps)
            wrong = state_error(self.scene, self.data)
        self.step += self.scene.substeps
        if not wrong:
            self._bring_back()
        self._chain()
        if wrong:
            self._diverge(wrong)
        self.scorer.update(self.time, measure(self.task, self._sensing))
        if all(rig.device.finished for rig in self.rigs):
            self.scorer.abort(
                Status.INPUT_ENDED,
                Message("input_ended", "the input ended before the task was done"),
            )
        snapshot = self.snapshot()
        if not self.over:
            # Record now the state with which the next period begins. Recording it after the wait
            # for real time would take three times as long, and would delay a touch.
            self._record_state()
        return snapshot

    def snapshot(self) -> Snapshot:
        """Returns a snapshot for views; hands, objects, goals and loads are computed on first use.

        The snapshot has no reference to the session. Devices store snapshots, and a reference cycle
        would keep MuJoCo's memory after the trial. Its data do not change, so any thread may read
        it.
        """
        poses = StillPoses(self.data.xpos.copy(), self.data.xmat.copy())
        fingers = [(gate.solid, gate.inside) for gate in self._gates]
        loaded = self.shown and any(gate.fingers for gate in self._gates)
        return Snapshot(
            self.time,
            self.step,
            self.data.qpos.copy(),
            self.scorer.score,
            partial(_hands, poses, self._hands, self.reconstructions, fingers),
            partial(_objects, self.scene, self.task, poses),
            self.task.goals,
            tuple(self._notices()),
            self.contact,
            self._loads.keep(self.data) if loaded else tuple,
        )

    def close(self) -> None:
        """Closes every device, even if closing another device raises an error."""
        with ExitStack() as closing:
            for rig in self.rigs:
                closing.callback(rig.device.close)

    def _notices(self) -> list[str]:
        notices = [rig.yaw.notice for rig in self.rigs if rig.yaw and rig.yaw.notice]
        notices += [OUT_OF_REACH for follower in self._followers if follower and follower.missed]
        if any(gate.inside for gate in self._gates):
            notices += sorted({gate.notice for gate in self._gates if gate.notice})
        inputs: list[str] = []
        for rig in self.rigs:
            inputs += rig.device.notices
            inputs.append(rig.reconstructor.notice)
        if any(inputs):
            notices += dict.fromkeys(notice for notice in inputs if notice)
        since, respawned = self._respawn_notice
        return [*notices, respawned] if self.time - since < NOTICE_TIME else notices

    def _record_state(self) -> None:
        if self._recorder:
            solid = [s.solid for s in self._gates]
            self._recorder.state(self.step, self._state, self.state_hash, self.data.qpos, solid)

    def _switch(self) -> None:
        """Changes the contact mode if a person or a recording requested it."""
        # Read and clear the request in one statement. A request that another thread makes after
        # this statement waits for the next step.
        asked, self._asked = self._asked, None
        for rig in self.rigs:
            # A device that plays a recording also plays the recorded changes of mode.
            for mode in rig.device.mode_requests(self.time):
                asked = contact_mode(mode)
        if asked is not None and asked is not self._contact.mode:
            self._contact.mode = asked
            if self._recorder:
                self._recorder.event(self.step, "contact", mode=str(asked))
        self._contact.step()

    def _bring_back(self) -> None:
        """Puts objects that have left the workspace back into it."""
        names = self._respawn.step(self.data, self._balls)
        if names:
            self._respawn_notice = (
                self.time,
                Message("put_back", "out of reach, and put back: {objects}", objects=list(names)),
            )
            if self._recorder:
                self._recorder.event(self.step, "respawn", objects=names)

    def _balls(self) -> tuple[Array, Array]:
        """Returns balls that cover all parts that can be solid; see `CollisionGate.balls`."""
        middles, radii = zip(*(gate.balls(self.data) for gate in self._gates), strict=True)
        return np.concatenate(middles), np.concatenate(radii)

    def _begin(self) -> None:
        for i, rig in enumerate(self.rigs):
            rig.reconstructor.reset()
            if rig.yaw:
                rig.yaw.reset()
            pose = rig.reconstructor.commanded
            self.data.qpos[self.scene.qpos_slice(i)] = self.scene.pose_to_qpos(i, pose)
            self._follow(i, pose, frozenset())
            self.scene.set_solid(i, frozenset())
        mujoco.mj_forward(self.scene.model, self.data)

    def _command(self, i: int) -> Reconstruction:
        """Reads the frames of a device, and sets the servo targets of its hand."""
        rig = self.rigs[i]
        frame = self._latest(i)
        reconstruction = rig.reconstructor.step(frame)
        avoidance = self._avoidance[i]
        if avoidance:
            reconstruction = avoidance.step(self.data, reconstruction, self._contact.ghost)
        if rig.yaw:
            rig.yaw.step(self.time, reconstruction.u)
        self._follow(i, reconstruction.q, reconstruction.fingers)
        tip_offsets, touched = self._tip_offsets[i], self._touched[i]
        ghost = self._contact.ghost
        releases = tip_offsets.releases(self.data, reconstruction, ghost) if tip_offsets else False
        self._gates[i].update(self.data, reconstruction, ghost or releases)
        if tip_offsets and touched:
            touched.set_tip_offsets(tip_offsets.step(self.data, reconstruction))
        return reconstruction

    def _follow(self, i: int, q: Array, fingers: frozenset[int]) -> None:
        """Sets the servo targets of a hand, given its pose (48,) and the fingers that touch."""
        follower = self._followers[i]
        if follower is None:
            controls = self.rigs[i].hand.controls(q)
        else:
            controls = follower(q, fingers)
            self._followed += bool(fingers)
            self._missed += bool(fingers and follower.missed)
        self.data.ctrl[self.scene.control_slice(i)] = controls

    def _latest(self, i: int) -> Any:
        """Polls a device, and returns its latest frame, a touch frame or a hand frame."""
        latest = self._latest_frames[i]
        if latest.take(self.rigs[i].device.poll(self.time), self.time) and self._recorder:
            self._recorder.input(self.step, i, latest.frame, self.state_hash)
        return latest.frame

    def _chain(self) -> None:
        mujoco.mj_getState(self.scene.model, self.data, self._state, STATE)
        # The set of colliding fingers affects the next step and is not part of MuJoCo's state.
        solid = b"".join([s.signature for s in self._gates])
        chained = blake2b(self._hash, digest_size=16)
        chained.update(self._state.data)
        chained.update(solid + self._contact.signature)
        self._hash = chained.digest()

    def _diverge(self, wrong: str) -> None:
        """Marks the trial as diverged and raises."""
        self.diverged = wrong
        self._record_state()
        where = f"{self.time:.3f} s"
        self.scorer.abort(
            Status.DIVERGED,
            Message(
                "diverged", "the simulation diverged at {where}: {why}", where=where, why=wrong
            ),
        )
        raise DivergenceError(
            "the simulation diverged",
            where=where,
            got=wrong,
            remedy="Use a smaller impulse limit or a smaller time step",
        )


def _hands(
    poses: BodyPoses,
    hands: Sequence[tuple[Callable[[BodyPoses], Array], Surface]],
    reconstructions: Sequence[Reconstruction],
    fingers: Sequence[tuple[frozenset[int], frozenset[int]]],
) -> tuple[HandView, ...]:
    """Returns the hands of a snapshot.

    Args:
        poses: Poses of all bodies.
        hands: For each hand, the function that computes its fingertips, and the surface of its
            touches.
        reconstructions: The reconstruction of each hand; the list is never modified.
        fingers: For each hand, its solid fingers, and its fingers inside an object.
    """
    return tuple(
        HandView(
            reconstruction.q,
            tips(poses),
            solid,
            reconstruction.phase.value,
            reconstruction.contacts,
            inside,
            surface,
            reconstruction.probability,
        )
        for reconstruction, (solid, inside), (tips, surface) in zip(
            reconstructions, fingers, hands, strict=True
        )
    )


def _objects(scene: Scene, task: Task, poses: BodyPoses) -> dict[str, ObjectView]:
    """Returns the objects of a snapshot by name."""
    return {thing.name: ObjectView(*scene.object_pose(poses, thing.name)) for thing in task.objects}


FASTEST = 50.0
"""Highest speed of an object, m/s. At this speed it moves 10 cm in a step of 2 ms, more than its
own width, and passes through other objects without a detected contact."""
FASTEST_TURN = 5000.0
"""Highest angular speed of a hand's joint or an object, rad/s: more than a turn in 2 ms."""

_SLOW = 40.0
"""Norm of joint velocities, m/s and rad/s, below which all objects are slower than `FASTEST`."""

_WARNINGS = {
    mujoco.mjtWarning.mjWARN_BADQPOS: "positions are not finite",
    mujoco.mjtWarning.mjWARN_BADQVEL: "velocities are not finite",
    mujoco.mjtWarning.mjWARN_BADQACC: "accelerations are not finite",
    mujoco.mjtWarning.mjWARN_BADCTRL: "the commanded pose is not finite",
}
"""Warnings of MuJoCo that mean divergence; MuJoCo also counts numbers beyond 1e10 as not finite."""


def command_error(data: mujoco.MjData) -> str:
    """Describes an error in the commanded pose; empty if the pose is valid."""
    ctrl = data.ctrl
    if isfinite(ctrl.dot(ctrl)) or np.all(np.isfinite(ctrl)):  # any order: only finiteness counts
        return ""
    return "the commanded pose is not finite"


def state_error(scene: Scene, data: mujoco.MjData) -> str:
    """Describes an error in the state of a simulation; empty if the state is valid."""
    # Fast path for the usual, valid state: a dot product is finite only if all numbers are, and no
    # object is fast while all joint velocities are small.
    qpos, qvel = data.qpos, data.qvel
    slow = isfinite(qpos.dot(qpos)) and qvel.dot(qvel) < _SLOW**2  # any order: only a coarse test
    if slow and not any(data.warning.number.tolist()):
        return ""
    for kind, words in _WARNINGS.items():
        if data.warning[kind].number:
            return words
    if not (np.all(np.isfinite(data.qpos)) and np.all(np.isfinite(data.qvel))):
        return "the state is not finite"
    for name, body in scene.object_bodies.items():
        # Spatial velocity about the subtree's centre of mass: turn, then straight motion.
        turn, speed = np.sqrt(squared_lengths(data.cvel[body].reshape(2, 3)))
        if speed > FASTEST:
            return f"{name} moves at {speed:.0f} m/s"
        if turn > FASTEST_TURN:
            return f"{name} turns at {turn:.0f} rad/s"
    if np.max(np.abs(data.qvel), initial=0.0) > FASTEST_TURN:
        return f"a joint of a hand turns at {np.max(np.abs(data.qvel)):.0f} rad/s"
    return ""
