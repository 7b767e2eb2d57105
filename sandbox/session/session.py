"""The one loop: devices -> reconstruction -> servo targets -> physics -> score -> views.

Physics time decides. One call of `advance` is one control period; who drives a person's session
calls it at real time, who runs headless as fast as it goes. The same input gives the same states to
the bit, because nothing in here looks at a clock.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import blake2b
from typing import Any, Protocol

import mujoco
import numpy as np

from encoders.person.yaw_range import YawWatch
from encoders.reconstruction.arrival import Phase
from encoders.reconstruction.reconstructor import HandFrameReconstructor, Reconstructor
from encoders.reconstruction.touch_reconstructor import Reconstruction
from models.arithmetic.arrays import Array
from models.errors import DivergenceError
from models.frames import Frame, TouchFrame
from models.scene import Scene, SceneSpec, StillPoses
from models.scene_hand import SceneHand
from models.surface import Surface, enclosing
from sandbox.session.collision_gating import CollisionGate, CollisionGatingRules
from sandbox.session.contact_modes import ContactMode, ContactModes, contact_mode
from sandbox.session.device import AnyDevice
from sandbox.session.divergence import command_error, state_error
from sandbox.session.latest_frame import LatestFrame
from sandbox.session.messages import ContactView, HandView, ObjectView, Snapshot
from sandbox.session.pose_track import bits
from sandbox.session.respawn import Respawn
from tasks.checks import measure
from tasks.goals import place
from tasks.score import Scorer, Status
from tasks.sensing import Sensing
from tasks.task import Task

NOTICE_TIME = 2.0
"""s for which a person is told that an object came back."""

STATE = mujoco.mjtState.mjSTATE_INTEGRATION
"""What has to be stored so that a simulation goes on to the bit: `FULLPHYSICS` lacks the solver's
warm start, and diverges at the first step."""


@dataclass
class Rig:
    """A device, the reconstructor of its frames, and the hand they drive.

    Attributes:
        device: Where touches, or the places of fingers in the air, come from.
        reconstructor: Makes poses of them.
        hand: Is driven by the poses.
        yaw: Notices hands that are turned too far; None notices nothing. It changes no pose.
        rules: When this hand is solid; None goes by the session's.
    """

    device: AnyDevice
    reconstructor: Reconstructor | HandFrameReconstructor
    hand: SceneHand
    yaw: YawWatch | None = None
    rules: CollisionGatingRules | None = None


class Recorder(Protocol):
    """Contract of recorders of a session, which must not block and never lose data."""

    def input(self, step: int, hand: int, frame: Frame, state_hash: str) -> None:
        """A frame that takes effect at a physics step, and the state's hash before it."""
        ...

    def event(self, step: int, what: str, **details: Any) -> None:
        """Something else that takes effect, or has happened, at a physics step."""
        ...

    def state(
        self,
        step: int,
        state: Array,
        state_hash: str,
        qpos: Array,
        solid: Sequence[frozenset[int]],
    ) -> None:
        """The simulation at the beginning of a control period; arrays change afterwards."""
        ...


class Session:
    """One trial of a task with its rigs.

    Args:
        task: A drawn trial.
        rigs: One per hand.
        rules: When hands are solid.
        timestep: s of physics.
        recorder: Writes down inputs and states; None records nothing.
        contact: How hands and objects touch at the start.
        friction: Factor on every coefficient of sliding friction.

    Attributes:
        diverged: Why the simulation cannot go on; empty while it can.
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
        rules = rules or CollisionGatingRules()
        hands = tuple(rig.hand for rig in rigs)
        self.scene = Scene(SceneSpec(hands, task.objects, task.table_friction, timestep))
        self.scene.model.geom_friction[:, 0] *= friction
        self.data = mujoco.MjData(self.scene.model)
        self._gates = [CollisionGate(self.scene, i, r.rules or rules) for i, r in enumerate(rigs)]
        surfaces = [rig.reconstructor.surface for rig in rigs]
        self._hands = [(s.tips, on) for s, on in zip(self._gates, surfaces, strict=True)]
        self._contact = ContactModes(self.scene, contact_mode(contact))
        self._asked: ContactMode | None = None
        self._respawn = Respawn(self.scene, surfaces)
        self._back: tuple[float, str] = (-np.inf, "")
        self.diverged = ""
        self._newest = [LatestFrame(rig.reconstructor.empty) for rig in rigs]
        self._recorder = recorder
        self.step = 0
        self._begin()
        self._sensing = Sensing(self.scene, self.data)
        # A measure that is none is told before the trial begins.
        measure(task, self._sensing)
        self.scorer = Scorer(task)
        self._state = np.empty(mujoco.mj_stateSize(self.scene.model, STATE))
        self._hash = b""
        self._chain()
        # Before the first step the hand waits where it starts; who looks sees it there.
        self.reconstructions = [
            Reconstruction(r.reconstructor.commanded, Phase.AWAY, frozenset(), None, 1.0, 0.0, ())
            for r in self.rigs
        ]

    @property
    def first_rig(self) -> Rig:
        """The rig of the first hand: that of the person before the window, or on the page."""
        return self.rigs[0]

    @property
    def time(self) -> float:
        """s of simulated time since the trial began."""
        return self.step * self.scene.spec.timestep

    @property
    def whole_surface(self) -> Surface:
        """Where all hands touch: around the surfaces of all of them."""
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
        return sum(self._respawn.counts.values())

    def solid(self, hand: int) -> frozenset[int]:
        """Labels of a hand's fingers that can touch things now."""
        return self._gates[hand].fingers

    def heard(self, hand: int) -> Frame:
        """The newest frame of a hand's device, stamped with session time."""
        return self._newest[hand].frame

    def lift(self, hand: int) -> float | None:
        """Where the lift control of a hand's device is, 0 to 1; None where it has none."""
        frame = self._newest[hand].frame
        return frame.lift if isinstance(frame, TouchFrame) else None

    def tips(self, hand: int, data: mujoco.MjData) -> Array:
        """(5, 3) m, fingertips of a hand in a state of this session's model."""
        return self._gates[hand].tips(data)

    def set_contact(self, mode: str) -> None:
        """Asks for another contact mode, from any thread; it takes effect with the next step.

        The state does not change by it, only what comes next. A finger that is inside an object
        when its hand is no ghost any more stays one until it is out.

        Raises:
            InputError: There is no such mode.
        """
        self._asked = contact_mode(mode)

    def advance(self) -> Snapshot:
        """One control period.

        Raises:
            DivergenceError: The simulation left the region where its numbers mean something; the
                trial is marked before it is raised.
        """
        if self.step == 0:
            self._record_state()
        self._switch()
        self.reconstructions = [self._command(i) for i in range(len(self.rigs))]
        # The state has been looked at when the last period ended.
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
            self.scorer.abort(Status.INPUT_ENDED, "the input ended before the task was done")
        snapshot = self.snapshot()
        if not self.over:
            # What the next period begins with is recorded now: after a pause for real time that
            # takes three times as long, and a touch would wait for it.
            self._record_state()
        return snapshot

    def snapshot(self) -> Snapshot:
        """Snapshot for views; most of its fields are computed only on access."""
        poses = StillPoses(self.data.xpos.copy(), self.data.xmat.copy())
        # Devices keep what they were shown: were the session in it, each would keep the other, and
        # with them MuJoCo's memory, after the trial.
        scene, task, hands = self.scene, self.task, self._hands
        found, solid = tuple(self.reconstructions), [s.fingers for s in self._gates]

        def work_out() -> dict[str, Any]:
            objects = {
                thing.name: ObjectView(*scene.object_pose(poses, thing.name))
                for thing in task.objects
            }
            return {
                "hands": tuple(
                    _hand_view(reconstruction, fingers, tips(poses), surface)
                    for reconstruction, fingers, (tips, surface) in zip(
                        found, solid, hands, strict=True
                    )
                ),
                "objects": objects,
                "goals": place(task.goals, objects),
            }

        return Snapshot.later(
            work_out,
            time=self.time,
            step=self.step,
            qpos=self.data.qpos.copy(),
            score=self.scorer.score,
            notices=tuple(self._notices()),
            contact=self.contact,
        )

    def close(self) -> None:
        """Closes the devices."""
        for rig in self.rigs:
            rig.device.close()

    def _notices(self) -> list[str]:
        found = [rig.yaw.notice for rig in self.rigs if rig.yaw and rig.yaw.notice]
        found += sorted({s.notice for s in self._gates if s.notice})
        told = (part.notice for rig in self.rigs for part in (rig.device, rig.reconstructor))
        found += dict.fromkeys(notice for notice in told if notice)
        since, back = self._back
        return [*found, back] if self.time - since < NOTICE_TIME else found

    def _record_state(self) -> None:
        if self._recorder:
            solid = [s.fingers for s in self._gates]
            self._recorder.state(self.step, self._state, self.state_hash, self.data.qpos, solid)

    def _switch(self) -> None:
        """Changes the contact mode where a person or a recording asks for it."""
        # One read: another thread may ask again meanwhile, and is heard with the next step.
        asked, self._asked = self._asked, None
        for rig in self.rigs:
            # What plays a recording has its switches, too.
            for mode in rig.device.switches(self.time):
                asked = contact_mode(mode)
        if asked is not None and asked is not self._contact.mode:
            self._contact.mode = asked
            if self._recorder:
                self._recorder.event(self.step, "contact", mode=str(asked))
        self._contact.step()

    def _bring_back(self) -> None:
        """Puts objects that have left back into the workspace."""
        names = self._respawn.step(
            self.data, lambda: np.concatenate([s.links(self.data) for s in self._gates])
        )
        if names:
            self._back = (self.time, f"out of reach, and put back: {', '.join(names)}")
            if self._recorder:
                self._recorder.event(self.step, "respawn", objects=names)

    def _begin(self) -> None:
        for i, rig in enumerate(self.rigs):
            rig.reconstructor.reset()
            if rig.yaw:
                rig.yaw.reset()
            pose = rig.reconstructor.commanded
            self.data.qpos[self.scene.qpos_slice(i)] = self.scene.pose_to_qpos(i, pose)
            self.data.ctrl[self.scene.control_slice(i)] = rig.hand.controls(pose)
            self.scene.set_solid(i, frozenset())
        mujoco.mj_forward(self.scene.model, self.data)

    def _command(self, i: int) -> Reconstruction:
        """Takes in what a device has to say, and sets the targets of its hand."""
        rig = self.rigs[i]
        frame = self._latest(i)
        reconstruction = rig.reconstructor.step(frame)
        if rig.yaw:
            rig.yaw.step(self.time, reconstruction.u)
        self.data.ctrl[self.scene.control_slice(i)] = rig.hand.controls(reconstruction.q)
        self._gates[i].update(self.data, reconstruction, self._contact.ghost)
        return reconstruction

    def _latest(self, i: int) -> Any:
        """The newest frame of a device, of the kind that its reconstructor takes."""
        newest = self._newest[i]
        if newest.take(self.rigs[i].device.poll(self.time), self.time) and self._recorder:
            self._recorder.input(self.step, i, newest.frame, self.state_hash)
        return newest.frame

    def _chain(self) -> None:
        mujoco.mj_getState(self.scene.model, self.data, self._state, STATE)
        # What is solid is no part of MuJoCo's state, and decides as much about what comes next.
        solid = bytes([bits(s.fingers) for s in self._gates])
        chained = blake2b(self._hash, digest_size=16)
        chained.update(self._state.data)
        chained.update(solid + self._contact.signature)
        self._hash = chained.digest()

    def _diverge(self, wrong: str) -> None:
        """Marks the trial and gives up."""
        self.diverged = wrong
        self._record_state()
        where = f"{self.time:.3f} s"
        self.scorer.abort(Status.DIVERGED, f"the simulation diverged at {where}: {wrong}")
        raise DivergenceError(
            "the simulation diverged",
            where=where,
            got=wrong,
            remedy="A smaller impulse limit, or a smaller time step, helps",
        )


def _hand_view(
    reconstruction: Reconstruction, solid: frozenset[int], tips: Array, surface: Surface
) -> HandView:
    found = reconstruction.contacts
    places = surface.to_world([c.xy for c in found]) if found else ()
    contacts = tuple(
        ContactView(c.id, place, c.label, c.state) for c, place in zip(found, places, strict=True)
    )
    return HandView(reconstruction.q, tips, solid, reconstruction.phase.value, contacts)
