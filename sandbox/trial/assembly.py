"""Builds a session from the settings of a run: task, surfaces, reconstructors, hands, devices."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from typing import Any

from encoders.correction import CorrectionSettings
from encoders.labels.belief import BeliefLabels, builtin_population_belief
from encoders.labels.labelling import Labeller
from encoders.person.yaw_range import YawMonitor, YawRange
from encoders.reconstruction.arrival import ArrivalSettings, LiftSettings
from encoders.reconstruction.contact_tracker import TrackerSettings
from encoders.reconstruction.reconstructor import AirReconstructor, Reconstructor, personal
from encoders.reconstruction.touch_reconstructor import ReconstructorSettings, TouchReconstructor
from encoders.regression.model_registry import find_model
from encoders.regression.trained import TrainedModel
from models.errors import CaptureError, InputError
from models.hand import Hand, SceneHand, finger_armature, is_gentle
from models.pose import GENTLE, RateLimit
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.session.collision_gating import CollisionGatingRules
from sandbox.session.session import Recorder, Rig, Session
from sandbox.trial.open_devices import DeviceMakers, check_count
from sandbox.trial.settings import SOLID, HandSettings, Settings
from sandbox.trial.surfaces import place_all
from tasks.guarded import check_varied, draw_task
from tasks.registry import find_task
from tasks.task import Task, place_surface
from tasks.variation import vary

__all__ = [
    "build",
    "digests",
    "drawn",
    "load_encoder",
    "make_labeller",
    "reconstructor_settings",
]

UPRIGHT_END = 0.0
"""m, solid length of the last links before an upright surface: only the spheres at the fingertips
are solid. Otherwise fingers would push objects below or before the held one, in a depth that the
person cannot see."""


TIP_END = 0.012
"""m, solid length of the last links of a hand that is led out of things."""

IN_AIR: dict[str, Any] = {"links": 2, "together": True}
"""Collision gating of a hand in the air. A Leap measures where middle links are, and objects that
pass through them look wrong (measured at db485e42)."""


def load_encoder(name: str) -> TrainedModel:
    """The model that `--encoder` names.

    The training of an encoder that has no model yet is told on stderr.

    Raises:
        InputError: No model has this name, or it cannot be used.
    """
    return find_model(name, _print_progress)


def _print_progress(line: str) -> None:
    print(f"--encoder: {line}", file=sys.stderr)


def digests(settings: Settings) -> dict[str, str]:
    """Digests of the trained models: the encoder, and the belief over labels if it is used; and of
    a robot's hand."""
    belief = _belief(settings)
    labels = "" if belief is None else belief.trained.digest
    learned = {"encoder": load_encoder(settings.pipeline.encoder).digest, "labels": labels}
    if not settings.physics.robot:
        return learned
    from models.robot.known import find_robot
    from models.robot.robot_hand import RobotHand

    return {**learned, "robot": RobotHand("", find_robot(settings.physics.robot)).digest}


def reconstructor_settings(
    settings: Settings, lift_range: float = 0.0, size: float = 1.0
) -> ReconstructorSettings:
    """Settings of the reconstructor of touches.

    Args:
        settings: Settings of the run.
        lift_range: m by which the task's lift control raises the hand.
        size: Length of the person's hand relative to the trained hand.
    """
    tracker, arrival = TrackerSettings(), ArrivalSettings(hover=settings.pipeline.hover)
    if not settings.pipeline.stitch:
        tracker = replace(tracker, grace=0.0, cancelled_grace=0.0)
    if not settings.pipeline.smoothing:
        tracker = replace(tracker, low_pass=0.0)
    if not settings.pipeline.arrival:
        arrival = replace(arrival, hover=0.0)
    chosen = ReconstructorSettings(
        tracker=tracker,
        arrival=arrival,
        # The reconstructor works in the trained hand's scale.
        lift=LiftSettings(reach=lift_range / size),
        correction=CorrectionSettings() if settings.pipeline.correction else None,
        encode=settings.pipeline.encode,
        rate=GENTLE if is_gentle(settings.physics.impulse) else RateLimit(),
    )
    return chosen if settings.pipeline.smoothing else replace(chosen, posture_tau=0.0)


def make_labeller(
    settings: Settings, model: TrainedModel, hand: HandSettings | None = None
) -> Labeller:
    """The labeller that the settings name.

    `device` gives the labeller of `population`, for contacts that come without a label.

    Args:
        settings: Settings of the run.
        model: The encoder's model.
        hand: The hand whose known layouts are used; None uses none.
    """
    belief = _belief(settings, hand)
    if belief is not None:
        return belief
    from encoders.labels.paper import PaperLabels

    return PaperLabels(model)


def _belief(settings: Settings, hand: HandSettings | None = None) -> BeliefLabels | None:
    """The belief over labels that the settings name, about the fingers that a robot's hand has;
    None for the paper's rule."""
    belief = _any_belief(settings, hand)
    if belief and settings.physics.robot:
        from models.robot.known import find_robot

        belief.fingers = len(find_robot(settings.physics.robot).tips)
    return belief


def _any_belief(settings: Settings, hand: HandSettings | None = None) -> BeliefLabels | None:
    """The same for a hand with five fingers."""
    if settings.pipeline.labels == "paper":
        return None
    known = None
    if hand and hand.layouts:
        from sandbox.session.own_layouts import known_layouts

        known = known_layouts(hand.layouts, hand.size)
    return builtin_population_belief(known)


def drawn(settings: Settings, may_overlap: bool = False) -> tuple[Task, tuple[Surface, ...]]:
    """Draws and varies the trial of a run, and places the surface of every hand.

    Args:
        settings: Settings of the run.
        may_overlap: Things of a varied trial may overlap; otherwise they are refused.

    Raises:
        InputError: The task does not fit on the surface, it cannot be varied like that, or things
            of the varied trial overlap.
    """
    kind = find_task(settings.task)
    whole, surfaces = place_all(place_surface(settings.surface.rectangle, kind), settings, kind)
    plain = draw_task(kind, settings.seed, whole)
    task = vary(plain, settings.variation, whole)
    if task is not plain and not may_overlap:
        check_varied(task, f"{task.name}, seed {task.seed}, varied", plain)
    return task, surfaces


def build(
    settings: Settings,
    makers: DeviceMakers,
    recorder: Recorder | None = None,
    wrap_reconstructor: Callable[[Reconstructor], Reconstructor] | None = None,
    change_task: Callable[[Task], Task] | None = None,
    may_overlap: bool = False,
) -> Session:
    """Builds a session that is ready for its first step.

    Args:
        settings: Settings of the run.
        makers: Functions that open the devices, one for each of the settings' hands.
        recorder: Records inputs and states; None records nothing.
        wrap_reconstructor: Replaces or wraps each reconstructor of touches; None changes nothing.
        change_task: Changes the drawn trial; None changes nothing.
        may_overlap: Things of a varied trial may overlap at the start: it was played before, or a
            participant waits for it.

    Raises:
        InputError: The trial cannot be played with these settings; see `drawn`.
    """
    task_type = find_task(settings.task)
    task, surfaces = drawn(settings, may_overlap)
    task = change_task(task) if change_task else task
    turns = [hand.turn for hand in settings.hands]
    if surfaces[0].upright and any(turns):
        raise InputError(
            "an upright surface can only be used from its lower edge",
            where="--turn",
            got=max(turns),
            expected=f"0 for {settings.task}",
        )
    check_count(makers, settings)
    model = load_encoder(settings.pipeline.encoder)
    reconstructors: list[Reconstructor | AirReconstructor] = []
    for hand, surface in zip(settings.hands, surfaces, strict=True):
        if hand.in_air is not None:
            rate = reconstructor_settings(settings).rate
            reconstructors.append(hand.in_air.any_reconstructor(hand.person, surface, rate))
            continue

        labeller = make_labeller(settings, model, hand)
        known = model
        if hand.rest:
            from encoders.person.rest_posture import knowing_rest

            known = knowing_rest(model, hand.rest, hand.size)

        def trained_hand(
            surface: Surface,
            labeller: Labeller = labeller,
            known: TrainedModel = known,
            size: float = hand.size,
        ) -> TouchReconstructor:
            return TouchReconstructor(
                known,
                labeller,
                ADULT,
                surface,
                reconstructor_settings(settings, task.lift_range, size),
            )

        own = personal(hand.person, surface, trained_hand)
        reconstructors.append(wrap_reconstructor(own) if wrap_reconstructor else own)
    rules = CollisionGatingRules(
        settings.pipeline.ghost_until_clear,
        settings.pipeline.distal_only,
        # Tips that are not at their touches cannot be led; nor is there a need where a hand
        # becomes solid within things.
        lead=settings.pipeline.correction and settings.pipeline.ghost_until_clear,
        all_over=settings.physics.solid == SOLID[1],
    )
    air_rules = replace(rules, lead=False, **IN_AIR)
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
            device = make(task, surface)
            rigs.append(Rig(device, reconstructor, model_hand, yaw, own_rules))
        session = Session(
            task,
            rigs,
            rules,
            settings.physics.timestep,
            recorder,
            settings.physics.contact,
            friction,
        )
    except BaseException:
        with ExitStack() as closing:
            for rig in rigs:
                closing.callback(rig.device.close)
            raise
    return session


def _hands(settings: Settings, task_type: type[Task]) -> list[SceneHand]:
    """The simulated hands."""
    return [
        _hand(settings, name, hand, task_type)
        for name, hand in zip(settings.hand_names, settings.hands, strict=True)
    ]


def _hand(settings: Settings, name: str, hand: HandSettings, task_type: type[Task]) -> SceneHand:
    """One simulated hand: ours, or a robot's."""
    skeleton = hand.person.skeleton(ADULT)
    solid_end = _solid_end(settings, hand, task_type)
    if not settings.physics.robot:
        return Hand(
            name,
            skeleton,
            servo=settings.physics.servo,
            impulse=settings.physics.impulse,
            finger_armature=finger_armature(settings.physics.impulse),
            solid_end=solid_end,
            solid_palm=settings.physics.solid == SOLID[1],
        )
    from models.robot.known import find_robot
    from models.robot.robot_hand import RobotHand

    mapping = find_robot(settings.physics.robot)
    if mapping.side != hand.side:
        raise InputError(
            f"this robot's hand is a {mapping.side} one",
            where="--robot",
            got=f"{settings.physics.robot} for the {hand.side} hand",
            remedy=f"Use --hand {mapping.side}",
        )
    return RobotHand(
        name, mapping, skeleton, hand.size, settings.physics.impulse, solid_end=solid_end
    )


def _solid_end(settings: Settings, hand: HandSettings, task_type: type[Task]) -> float | None:
    """Solid length in m of the last links where only fingertips are solid; see `Hand`."""
    if settings.physics.solid == SOLID[1]:
        return None if hand.in_air is not None else TIP_END
    if task_type.plane == "front":
        return UPRIGHT_END
    return TIP_END if hand.in_air is None else None


def _yaw_watch(model: TrainedModel) -> YawMonitor | None:
    """Watch for hands turned further than in the training data; None if the model lacks a range."""
    try:
        return YawMonitor(YawRange.of(model.training_u))
    except CaptureError:
        return None
