"""Puts a run together from its settings: task, surface, reconstructor, hand, session."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from encoders.correction import CorrectionSettings
from encoders.labels.belief import builtin_belief
from encoders.labels.labelling import Labeller, PaperLabels
from encoders.paalm.hand_reconstructor import HandReconstructor
from encoders.person.yaw_range import YawRange, YawWatch
from encoders.reconstruction.arrival import ArrivalSettings
from encoders.reconstruction.contact_tracker import TrackerSettings
from encoders.reconstruction.lift import LiftSettings
from encoders.reconstruction.personal import personal
from encoders.reconstruction.reconstructor import Reconstructor
from encoders.reconstruction.touch_reconstructor import ReconstructorSettings, TouchReconstructor
from encoders.regression.model_registry import find_model
from encoders.regression.trained import TrainedModel
from models.errors import CaptureError, InputError
from models.hand import Hand, finger_armature, is_calm
from models.limits import GENTLE, RateLimit
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.lsl.lsl_listening import Told
from sandbox.session.collision_gating import CollisionGatingRules
from sandbox.session.session import Recorder, Rig, Session
from sandbox.trial.device_makers import DeviceMakers, check_count
from sandbox.trial.settings import RunSettings
from sandbox.trial.surfaces import place_all
from tasks.registry import draw_task, find_task
from tasks.task import Task
from tasks.variation import vary

__all__ = [
    "build",
    "digests",
    "load_encoder",
    "make_labeller",
    "place_surface",
    "reconstructor_settings",
]

BELOW_TABLE = 0.015
"""m by which an upright surface reaches below the table's top, so that fingers beside a thing that
lies on the table are on the surface all the same."""


UPRIGHT_END = 0.0
"""m of the last links that are solid before an upright surface: nothing but the balls of the
fingertips. Fingers reach over what stands below and before what they hold, in a depth that nobody
sees."""


IN_AIR: dict[str, Any] = {"links": 2, "together": True}
"""What is solid of a hand in the air. A Leap sees where middle links are, and things that go
through them look wrong; `python -m benchmarks.in_air --links 1` tells the difference."""


def load_encoder(name: str) -> TrainedModel:
    """The model that `--encoder` names; one that has to be trained first says so on stderr.

    Raises:
        InputError: There is none, or it cannot be used.
    """
    return find_model(name, _tell)


def _tell(line: str) -> None:
    print(f"--encoder: {line}", file=sys.stderr)


def digests(settings: RunSettings) -> dict[str, str]:
    """Digests of what was learned: the encoder, and the belief over labels where it is used."""
    labels = "" if settings.labels == "paper" else builtin_belief().trained.digest
    return {"encoder": load_encoder(settings.encoder).digest, "labels": labels}


def reconstructor_settings(settings: RunSettings, lift_range: float = 0.0) -> ReconstructorSettings:
    """What takes part between touches and pose.

    Args:
        settings: Of the run.
        lift_range: m by which the task's lift control raises the hand.
    """
    tracker, arrival = TrackerSettings(), ArrivalSettings()
    if not settings.stitch:
        tracker = replace(tracker, grace=0.0, cancelled_grace=0.0)
    if not settings.smoothing:
        tracker = replace(tracker, low_pass=0.0)
    if not settings.arrival:
        arrival = replace(arrival, hover=0.0)
    chosen = ReconstructorSettings(
        tracker=tracker,
        arrival=arrival,
        # The trained hand rises less than the person's, as it is smaller in all directions. All
        # hands rise by what the first one's size says: earlier recordings depend on it.
        lift=LiftSettings(reach=lift_range / settings.hands[0].size),
        correction=CorrectionSettings() if settings.correction else None,
        encode=settings.encode,
        rate=GENTLE if is_calm(settings.impulse) else RateLimit(),
    )
    return chosen if settings.smoothing else replace(chosen, posture_tau=0.0)


def make_labeller(settings: RunSettings, model: TrainedModel) -> Labeller:
    """Who names the fingers; `device` falls back on history where the device does not know."""
    return PaperLabels(model) if settings.labels == "paper" else builtin_belief()


def place_surface(surface: Surface, task: type[Task]) -> Surface:
    """A task's surface in the world: flat over the table, or upright before the person.

    Flat or upright, `touch_height` is out of it what it is above the middle of the things: above
    the table, or in front of world y = 0, the depth at which things of an upright task are.
    """
    if task.plane == "front":
        return surface.stood_up(-task.touch_height, -BELOW_TABLE)
    return surface.centred_at((0.0, 0.0, task.touch_height))


def build(
    settings: RunSettings,
    makers: DeviceMakers,
    recorder: Recorder | None = None,
    wear: Callable[[Reconstructor], Reconstructor] | None = None,
) -> Session:
    """A session with its hands, ready for its first step.

    Args:
        settings: How it goes.
        makers: Open the devices, one for each of the settings' hands.
        recorder: Writes down inputs and states.
        wear: Puts another reconstructor in the place of the one that reconstructs from touches.
    """
    task_type = find_task(settings.task)
    placed = place_surface(settings.surface, task_type)
    whole, surfaces = place_all(placed, settings, task_type)
    task = vary(draw_task(task_type, settings.seed, whole), settings.variation, whole)
    turns = [hand.turn for hand in settings.hands]
    if placed.upright and any(turns):
        raise InputError(
            "before an upright surface one sits at its lower edge",
            where="--turn",
            got=max(turns),
            expected=f"0 for {settings.task}",
        )
    check_count(makers, settings)
    model = load_encoder(settings.encoder)
    reconstructors: list[Reconstructor | HandReconstructor] = []
    for hand, surface in zip(settings.hands, surfaces, strict=True):
        if hand.in_air is not None:
            rate = reconstructor_settings(settings).rate
            reconstructors.append(hand.in_air.reconstructor(hand.person, surface, rate))
            continue

        def trained_hand(surface: Surface) -> TouchReconstructor:
            return TouchReconstructor(
                model,
                make_labeller(settings, model),
                ADULT,
                surface,
                reconstructor_settings(settings, task.lift_range),
            )

        touched = personal(hand.person, surface, trained_hand)
        reconstructors.append(wear(touched) if wear else touched)
    rules = CollisionGatingRules(settings.ghost_until_clear, settings.distal_only)
    air_rules = replace(rules, **IN_AIR)
    friction = settings.variation.friction
    rigs: list[Rig] = []
    try:
        for hand, make, surface, reconstructor, model_hand in zip(
            settings.hands,
            makers,
            surfaces,
            reconstructors,
            _hands(settings, task_type),
            strict=True,
        ):
            yaw = None if hand.in_air else _yaw_watch(model)
            own_rules = air_rules if hand.in_air else None
            rigs.append(Rig(make(task, surface), reconstructor, model_hand, yaw, own_rules))
        session = Session(
            task, rigs, rules, settings.timestep, recorder, settings.contact, friction
        )
    except BaseException:
        for rig in rigs:
            rig.device.close()
        raise
    if isinstance(recorder, Told):
        recorder.watch(session)
    return session


def _hands(settings: RunSettings, task_type: type[Task]) -> list[Hand]:
    """The simulated hands."""
    return [
        Hand(
            name,
            hand.person.skeleton(ADULT),
            servo=settings.servo,
            impulse=settings.impulse,
            finger_armature=finger_armature(settings.impulse),
            solid_end=UPRIGHT_END if task_type.plane == "front" else None,
        )
        for name, hand in zip(settings.hand_names, settings.hands, strict=True)
    ]


def _yaw_watch(model: TrainedModel) -> YawWatch | None:
    """Who notices hands turned further than the model's training; None where it does not tell."""
    try:
        return YawWatch(YawRange.of(model.training_u))
    except CaptureError:
        return None
