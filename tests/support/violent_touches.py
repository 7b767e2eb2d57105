"""Violent random touches on a task: what becomes of hands and objects.

Touches land on and beside objects, jump, swap their ids, vanish and come back inside of things,
come as palms and by the dozen, and the lift control jumps with them. Penetrations are read at every
physics step. A trial begins anew every 30 s of simulated time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import ceil

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.errors import DivergenceError
from models.frames import Contact, TouchFrame
from models.scene import CONTROL_PERIOD
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.session.collision_gating import FINGERTIP
from sandbox.session.messages import Snapshot
from sandbox.session.respawn import AWAY, FLOOR
from sandbox.session.session import Session
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings

TRIAL = 30.0
"""s of simulated time, after which another seed begins."""

PATIENCE = AWAY + 1.0
"""s out of reach after which an object counts as lost for good."""

DEEPEST = 0.004
"""m, aim for `safe`."""


class Violent(Device):
    """A device with the worst of hands on it.

    Args:
        surface: Where it touches.
        seed: Seed of its random numbers.
    """

    name = "violent"
    finished = False

    def __init__(self, surface: Surface, seed: int) -> None:
        self._surface, self._rng = surface, np.random.default_rng([seed, 66])
        self._contacts: list[Contact] = []
        self._things: Array = np.zeros((0, 2))
        self._until = 0.0
        self._ids = 0

    def show(self, snapshot: Snapshot) -> None:
        """Sees where the objects are, to land on them."""
        self._things = np.array(
            [self._surface.to_surface(o.position) for o in snapshot.objects.values()]
        )

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The touches now."""
        if now >= self._until:
            self._act(now)
        lift = float(self._rng.random()) if self._rng.random() < 0.3 else None
        cancelled = frozenset({self._ids + 1}) if self._rng.random() < 0.05 else frozenset()
        return [TouchFrame(now, tuple(self._contacts), lift, cancelled)]

    def close(self) -> None:
        """Nothing to give back."""

    def _act(self, now: float) -> None:
        """The next thing to do; having landed, the touches rest until the hand is down."""
        rng = self._rng
        self._until = now + float(rng.uniform(0.02, 0.4))
        match int(rng.choice(7, p=(0.12, 0.25, 0.25, 0.18, 0.08, 0.06, 0.06))):
            case 0:
                self._land(int(rng.integers(1, 6)))
                self._until = now + float(rng.uniform(0.6, 1.2))
            case 1:
                # All of them jump to or through an object, and stay the same contacts.
                shift = self._middle() - self._mean() + rng.uniform(-0.05, 0.05, 2)
                self._contacts = [self._moved(c, shift) for c in self._contacts]
            case 2:
                # Together, through whatever lies between, or apart.
                middle = self._mean() if rng.random() < 0.3 else self._middle()
                share = rng.uniform(-0.5, 1.0)
                self._contacts = [
                    self._moved(c, share * (middle - np.array([c.x, c.y]))) for c in self._contacts
                ]
            case 3:
                # The same places under each other's ids, or under new ones.
                ids = [c.id for c in self._contacts]
                if rng.random() < 0.5:
                    ids = rng.permutation(ids).tolist()
                else:
                    ids = [self._new() for _ in ids]
                self._contacts = [
                    replace(c, id=int(i)) for c, i in zip(self._contacts, ids, strict=True)
                ]
            case 4:
                keep = rng.random(len(self._contacts)) < 0.5
                self._contacts = [c for c, k in zip(self._contacts, keep, strict=True) if k]
            case 5:
                self._contacts = []
                self._until = now + float(rng.uniform(0.02, 0.2))
            case _:
                # A forearm on the screen.
                self._land(int(rng.integers(6, 13)))

    def _land(self, count: int) -> None:
        """Touches around an object, or anywhere."""
        rng, size = self._rng, self._surface.size
        angles = rng.uniform(-np.pi, np.pi, count)
        # Mostly around the object, where fingers become solid, and sometimes on it.
        far = rng.uniform(0.0 if rng.random() < 0.2 else 0.035, 0.08, count)
        places = self._middle() + far[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
        palm = 0.05 if rng.random() < 0.1 else None
        self._contacts = [
            Contact(self._new(), x, y, size=palm) for x, y in np.clip(places, 0.0, size).tolist()
        ]

    def _middle(self) -> Array:
        """(2,) m, of an object, or a place anywhere."""
        if len(self._things) and self._rng.random() < 0.8:
            return np.asarray(self._things[self._rng.integers(len(self._things))])
        return self._rng.uniform(0.0, 1.0, 2) * self._surface.size

    def _mean(self) -> Array:
        """(2,) m, the middle of the touches."""
        return np.mean([(c.x, c.y) for c in self._contacts] or [(0.0, 0.0)], axis=0)

    def _moved(self, contact: Contact, shift: Array) -> Contact:
        x, y = np.clip(np.array([contact.x, contact.y]) + shift, 0.0, self._surface.size).tolist()
        return replace(contact, x=x, y=y)

    def _new(self) -> int:
        self._ids += 1
        return self._ids


@dataclass
class Found:
    """Result of violent touches.

    Attributes:
        diverged: Seeds of trials that diverged, with the reasons.
        lost: Objects that were out of reach and did not come back, with the seeds.
        respawned: Number of objects that came back.
        hand_table: Number of contacts between hand and table.
        steps: Number of physics steps.
        deepest: Deepest penetration of hand and objects, m.
    """

    diverged: list[str] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)
    respawned: int = 0
    hand_table: int = 0
    steps: int = 0
    deepest: float = 0.0


class Contacts:
    """Reads the contacts of every physics step, through MuJoCo's control callback."""

    def __init__(self, session: Session, found: Found) -> None:
        model = session.scene.model
        self._hand = np.zeros(model.ngeom, bool)
        for hand in session.scene.spec.hands:
            palm = model.body(hand.palm).id
            self._hand |= model.body_rootid[model.geom_bodyid] == palm
        self._fixed = model.geom_bodyid == 0
        self._found = found

    def __call__(self, _model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._found.steps += 1
        hand = self._hand[data.contact.geom].any(axis=1)
        table = self._fixed[data.contact.geom].any(axis=1)
        self._found.hand_table += int(np.sum(hand & table))
        depths = -data.contact.dist[hand & ~table]
        self._found.deepest = max(self._found.deepest, float(depths.max(initial=0.0)))


def soak(task: str, seconds: float, first_seed: int, **settings: object) -> Found:
    """Violent touches on a task.

    Args:
        task: Its name.
        seconds: Simulated time, s.
        first_seed: Seed of the first trial; each trial has the next one.
        settings: Settings other than the defaults.
    """
    found = Found()
    for trial in range(ceil(seconds / TRIAL)):
        rest = min(TRIAL, seconds - trial * TRIAL)
        _trial(Settings(task, first_seed + trial).changed(**settings), rest, found)
    return found


def _out(session: Session, bodies: list[int], reach: Array) -> NDArray[np.bool_]:
    """(n,) True for objects whose middle is farther off the surface than `reach` (n,), m, or below
    the table. Once a trial is over, nothing is put back."""
    surface, position = session.whole_surface, session.data.xpos[bodies]
    xy = surface.to_surface(position)
    beside = np.maximum(-xy, xy - surface.size).max(axis=1)
    out: NDArray[np.bool_] = (beside > reach) | (position[:, 2] < FLOOR)
    return out & (not session.over)


def _trial(settings: Settings, seconds: float, found: Found) -> None:
    devices: list[Violent] = []

    def device(_task: object, surface: Surface) -> Violent:
        devices.append(Violent(surface, settings.seed))
        return devices[-1]

    session = build(settings, (device,))
    names = list(session.scene.object_bodies)
    bodies = list(session.scene.object_bodies.values())
    away = np.zeros(len(names))
    reach = np.array([session.scene.object_radius(name) for name in names]) + FINGERTIP
    mujoco.set_mjcb_control(Contacts(session, found))
    try:
        for _ in range(round(seconds / CONTROL_PERIOD)):
            # A trial that is over goes on: nothing is to break then, either.
            devices[0].show(session.advance())
            away = np.where(_out(session, bodies, reach), away + CONTROL_PERIOD, 0.0)
            gone = np.flatnonzero(away > PATIENCE)
            found.lost += [f"{names[i]}, seed {settings.seed}" for i in gone]
            away[gone] = -np.inf
    except DivergenceError as error:
        found.diverged.append(f"seed {settings.seed}: {error.got}")
    finally:
        mujoco.set_mjcb_control(None)
        session.close()
    found.respawned += session.respawned
