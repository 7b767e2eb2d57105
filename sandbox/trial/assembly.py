"""Builds a session from the settings of a run: task, surfaces, reconstructors, hands, devices.

`build` is the entry point. `place_all` places the surfaces of all hands in the world. A device
maker is a function that opens the device of one hand, for a drawn task on a placed surface.
Settings name one device for each hand, or one device that both hands share. `with_lift` adds a lift
control if the task needs one.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from typing import Any, cast

import numpy as np

from encoders.correction import CorrectionSettings
from encoders.labels.belief import BeliefLabels, builtin_population_belief
from encoders.labels.labelling import Labeller, odds_of_first, odds_of_sets, parse_finger_sets
from encoders.labels.pair_network import USUAL_SETS
from encoders.person.natural_layout import YawMonitor, YawRange
from encoders.reconstruction.contact_tracker import TrackerSettings
from encoders.reconstruction.hand_motion import GENTLE, ArrivalSettings, LiftSettings, RateLimit
from encoders.reconstruction.reconstructor import AirReconstructor, Reconstructor, personal
from encoders.reconstruction.touch_reconstructor import ReconstructorSettings, TouchReconstructor
from encoders.regression.model_registry import find_model
from encoders.regression.trained import TrainedModel
from models.arithmetic import Array
from models.errors import CaptureError, InputError
from models.frames import FINGERS
from models.hand import Hand, SceneHand, finger_armature, is_gentle
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.devices.device import AnyDevice, Device, Place, Sees
from sandbox.devices.registry import kind_of
from sandbox.devices.simulated import NEXT_PERSON
from sandbox.session.collision_gating import CollisionGatingRules
from sandbox.session.session import Recorder, Rig, Session
from sandbox.trial.settings import SOLID, HandSettings, Settings
from tasks.guarded import check_varied, draw_task
from tasks.registry import find_task, hands_of
from tasks.task import Task, place_surface
from tasks.variation import vary


def place_all(
    placed: Surface, settings: Settings, kind: type[Task]
) -> tuple[Surface, tuple[Surface, ...]]:
    """Places the surface that a task is drawn on, and the surface of every hand.

    In a task for two hands, the surfaces of the two hands lie side by side (see `sides_of`). If two
    hands play a task for one hand, their surfaces coincide: two people, each with a screen, play at
    one table.

    Args:
        placed: A single surface, placed for the task.
        settings: Settings of the run.
        kind: Class of the task.

    Returns:
        The surface that the task is drawn on, and one surface per hand.

    Raises:
        InputError: The task needs more hands than there are, or two upright surfaces.
    """
    hands = len(settings.hands)
    if hands < hands_of(kind):
        raise InputError(
            "this task needs two hands, and only one is given",
            where=kind.name,
            expected="a device for each hand, or two hands on one device",
            remedy=f"sandbox run {kind.name} --device simulated --device simulated",
        )
    if hands == 1 or hands_of(kind) == 1 or settings.surface.shared:
        return placed, (placed,) * hands
    if placed.upright:
        raise InputError("two upright surfaces are not supported", where=kind.name)
    width, middle = float(placed.size[0]), placed.to_world(placed.size / 2)
    whole = replace(placed, width_in=2 * placed.width_in).centred_at(middle)
    sides = [
        placed.centred_at(np.add(middle, (0.5 * side * width, 0.0, 0.0)))
        for side in sides_of(settings)
    ]
    return whole, tuple(sides)


def sides_of(settings: Settings) -> tuple[int, int]:
    """Sides of the two hands: 1 is right, -1 left.

    The first hand is on the right, unless it is a left hand and the second a right hand.
    """
    first, second = (hand.person.left for hand in settings.hands)
    return (-1, 1) if first and not second else (1, -1)


def home(hand: int, settings: Settings, surface: Surface) -> Array:
    """(2,) m in the world, centre of a hand's part of its surface.

    Args:
        hand: Index of the hand.
        settings: Settings of the run.
        surface: Surface of the hand.
    """
    if not settings.surface.shared or len(settings.hands) == 1:
        return np.asarray(surface.to_world(surface.size / 2)[:2])
    return np.asarray(surface.to_world(homes(settings, surface)[hand])[:2])


def homes(settings: Settings, surface: Surface) -> Array:
    """(2, 2) m on a surface that two hands share, centre of each hand's half."""
    return np.array([surface.size * [0.5 + 0.25 * side, 0.5] for side in sides_of(settings)])


DeviceMaker = Callable[[Task, Surface], Device]
"""Function that opens a device for a drawn task on a placed surface."""

DeviceMakers = tuple[DeviceMaker, ...]
"""One maker per hand, in the order of `Settings.hands`."""

Around = Callable[[DeviceMaker], DeviceMaker]
"""Function from a maker to a maker whose devices are wrapped."""


def device_makers(settings: Settings, around: Around = lambda make: make) -> DeviceMakers:
    """Makers of the devices that settings name, one for each hand.

    Args:
        settings: Settings of the run.
        around: Wraps the first hand's device. Wrappers that degrade or share the device are outside
            this wrapper.

    Raises:
        InputError: A device does not exist, or its file cannot be read.
    """
    name, second = settings.device.name, settings.second_device
    first = _degraded(around(_maker(settings, 0)), settings, 0)
    if len(settings.hands) == 1:
        return (first,)
    sees = kind_of(name).sees
    if second is None:
        return shared_makers(first, settings, sees)
    other = _degraded(_maker(settings, 1), settings, 1)
    one_leap = sees is Sees.LEAP and second.name == name
    one_screen = name == "simulated" and settings.surface.shared
    if one_leap or one_screen:
        return shared_by_users((first, other), settings, sees)
    return first, other


def place_of(settings: Settings, hand: int, task: Task, surface: Surface) -> Place:
    """Place of a hand's device: its surface, task and person.

    Args:
        settings: Settings of the run.
        hand: Index of the hand.
        task: The drawn task.
        surface: Surface of the device, placed in the world.
    """
    whose, kind = settings.hands[hand], kind_of(settings.device_of(hand).name)
    served = settings.hands if settings.shares_device else (whose,)
    return Place(
        surface,
        hand=hand,
        sides=tuple(each.side for each in served),
        person=whose.person,
        task=task,
        seed=settings.seed,
        labels=kind.labels and settings.pipeline.labels == "device",
        home=home(hand, settings, surface),
        at=(0.0, 0.0, 0.0) if whose.in_air is None else whose.in_air.at,
    )


def shared_makers(make: DeviceMaker, settings: Settings, sees: Sees) -> DeviceMakers:
    """Makers for two hands that open one device and share it.

    Args:
        make: Opens the device.
        settings: Settings of the run.
        sees: Kind of input of the device, which determines how its frames are divided.
    """
    # Most trials have one hand.
    from sandbox.devices.wrappers.shared import SharedDevice, Split, SplitByPlace

    def split(surface: Surface) -> Split:
        if sees is Sees.TOUCHES:
            return SplitByPlace(homes(settings, surface))
        if sees is Sees.LEAP:
            from sandbox.devices.leap.two_hands import SplitBySide

            return SplitBySide([hand.side for hand in settings.hands])
        return Split()

    parts: list[Device] = []

    def first(task: Task, surface: Surface) -> Device:
        parts[:] = SharedDevice(make(task, surface), split(surface)).parts
        return parts[0]

    def second(task: Task, surface: Surface) -> Device:
        return parts[1]

    return first, second


def shared_by_users(makers: DeviceMakers, settings: Settings, sees: Sees) -> DeviceMakers:
    """Device makers for two simulated users who share one device.

    Args:
        makers: Open the device of each user.
        settings: Settings of the run.
        sees: Kind of input of the device.
    """
    return shared_makers(_merged(makers, sees), settings, sees)


def with_first(makers: DeviceMakers, change: Around) -> DeviceMakers:
    """The makers, with a changed maker for the first hand, the hand of the person at the screen."""
    first, *others = makers
    return (change(first), *others)


def check_count(makers: DeviceMakers, settings: Settings) -> None:
    """Checks that there is one maker per hand.

    Raises:
        InputError: The numbers of makers and hands differ.
    """
    if len(makers) != len(settings.hands):
        raise InputError(
            "every hand needs its own device, or a share of one",
            where=settings.task,
            got=f"{len(makers)} for {len(settings.hands)} hands",
        )


def is_live(settings: Settings) -> bool:
    """True if a person or another program drives the run, so that it must be in real time."""
    devices = filter(None, (settings.device, settings.second_device))
    return any(kind_of(device.name).live for device in devices)


def _maker(settings: Settings, hand: int) -> DeviceMaker:
    """The maker of the device of one hand."""
    device = settings.device_of(hand)

    def make(task: Task, surface: Surface) -> Device:
        return cast(Device, device.open(place_of(settings, hand, task, surface)))

    return make


def _merged(makers: DeviceMakers, sees: Sees) -> DeviceMaker:
    """A maker of one device that merges the input of two simulated users."""

    def make(task: Task, surface: Surface) -> Device:
        devices: list[AnyDevice] = [maker(task, surface) for maker in makers]
        if sees is Sees.LEAP:
            from sandbox.devices.leap.two_hands import MergedLeaps

            return MergedLeaps(devices)
        from sandbox.devices.wrappers.shared import MergedTouches

        return MergedTouches(devices)

    return make


def _degraded(make: DeviceMaker, settings: Settings, hand: int) -> DeviceMaker:
    """A maker whose device has the disturbances of the settings' variation."""
    variation, name = settings.variation, settings.device_of(hand).name
    if not variation.degrades_touches:
        return make
    from sandbox.devices.wrappers.degraded import DegradedDevice
    from sandbox.recording.recorded_device import RecordedDevice

    # Only simulated users and 3-D devices have random numbers that differ between hands.
    kind = kind_of(name)
    person = hand if kind.in_air or kind.simulated else 0

    def open_device(task: Task, surface: Surface) -> Device:
        device = make(task, surface)
        # Recorded touches were degraded when they were recorded.
        if isinstance(device, RecordedDevice):
            return device
        return DegradedDevice(device, variation, surface, settings.seed + person * NEXT_PERSON)

    return open_device


def lifts(settings: Settings) -> bool:
    """True if a trial needs a lift control: its task has one, and a hand touches a surface."""
    return find_task(settings.task).lift_range > 0 and not settings.in_air


def with_lift(makers: DeviceMakers, keys: bool) -> DeviceMakers:
    """Makers that add a lift control to devices without one, if the task needs it.

    The returned makers raise `InputError` if the task needs a lift control and none is available.

    Args:
        makers: Functions that open the devices.
        keys: True if a window's keys can serve as a lift control.
    """

    # Imported here, since few tasks have a lift control.
    from sandbox.devices.wrappers.playing import LiftKeys

    controls: list[LiftKeys] = []

    def lifted(maker: DeviceMaker, task: Task, surface: Surface) -> Device:
        device = maker(task, surface)
        if task.lift_range <= 0 or device.lift:
            return device
        if keys:
            controls.append(LiftKeys(device, controls[0] if controls else None))
            return controls[-1]
        device.close()
        raise InputError(
            "this task needs a lift control, and this device has none",
            where=task.name,
            got=device.name,
            expected="a device with a lift control: simulated, web or a recording",
            remedy=f"`sandbox play {task.name}` lifts with the keys up and down, with any device",
        )

    def first(task: Task, surface: Surface) -> Device:
        controls.clear()
        return lifted(makers[0], task, surface)

    return (first, *(partial(lifted, maker) for maker in makers[1:]))


UPRIGHT_END = 0.0
"""Solid length (m) of the last links in front of an upright surface: only the spheres at the
fingertips are solid. Otherwise fingers would push objects below or in front of the held object, at
a depth that the person cannot see."""


TIP_END = 0.012
"""Solid length (m) of the last links of a hand whose fingertips are offset out of objects."""

IN_AIR: dict[str, Any] = {"links": 2, "together": True}
"""Collision gating of a hand in the air. A Leap measures where the middle links are, and it looks
wrong if objects pass through them (measured at db485e42)."""


def load_encoder(name: str) -> TrainedModel:
    """The model that `--encoder` names.

    An encoder without a model is trained now, with a notice on stderr.

    Raises:
        InputError: No model has this name, or it cannot be used.
    """
    return find_model(name, _print_progress)


def _print_progress(line: str) -> None:
    print(f"--encoder: {line}", file=sys.stderr)


def digests(settings: Settings) -> dict[str, str]:
    """Digests of the encoder, of the labeller's model, and of the robot hand if there is one.

    The labeller's digest is empty for labels by the paper's rule, which have no model.
    """
    belief = _belief(settings)
    labels = "" if belief is None else belief.trained.digest
    learned = {"encoder": load_encoder(settings.pipeline.encoder).digest, "labels": labels}
    if not settings.physics.robot:
        return learned
    from models.robot.mapping import find_robot
    from models.robot.robot_hand import RobotHand

    return {**learned, "robot": RobotHand("", find_robot(settings.physics.robot)).digest}


def reconstructor_settings(
    settings: Settings, lift_range: float = 0.0, size: float = 1.0
) -> ReconstructorSettings:
    """Settings of the reconstructor of touches.

    Args:
        settings: Settings of the run.
        lift_range: Height by which the task's lift control raises the hand, m.
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

    For the setting `device`, it is the labeller `population`, which labels the contacts that the
    device does not label.

    Args:
        settings: Settings of the run.
        model: The encoder's model.
        hand: The hand whose stored layouts are used; None uses none.
    """
    belief = _belief(settings, hand)
    if belief is not None:
        return belief
    from encoders.labels.paper import PaperLabels

    return PaperLabels(model)


def _belief(settings: Settings, hand: HandSettings | None = None) -> BeliefLabels | None:
    """The labeller with a belief over labels, for the fingers that are in use.

    Returns:
        The labeller; None for labels by the paper's rule.

    Raises:
        InputError: A set of `finger_sets` has a finger that the robot hand lacks.
    """
    belief = _any_belief(settings, hand)
    if belief is None:
        return None
    fingers = len(FINGERS)
    if settings.physics.robot:
        from models.robot.mapping import find_robot

        fingers = len(find_robot(settings.physics.robot).tips)
        belief.odds = odds_of_first(fingers)
    if settings.pipeline.finger_sets:
        sets = parse_finger_sets(settings.pipeline.finger_sets)
        lacking = {finger for each in sets for finger in each if finger >= fingers}
        if lacking:
            raise InputError(
                "the robot hand lacks this finger",
                where="finger_sets",
                got=FINGERS[min(lacking)],
                expected=f"sets of {', '.join(FINGERS[:fingers])}",
            )
        belief.odds = odds_of_sets(sets, USUAL_SETS)
    return belief


def _any_belief(settings: Settings, hand: HandSettings | None = None) -> BeliefLabels | None:
    """The labeller with a belief over labels, for a hand with five fingers."""
    if settings.pipeline.labels == "paper":
        return None
    known = None
    if hand and hand.layouts:
        from sandbox.session.own_layouts import known_layouts

        known = known_layouts(hand.layouts, hand.size)
    return builtin_population_belief(known)


def _check_finger_sets(settings: Settings, kind: type[Task]) -> None:
    """Raises an error if a task cannot be played with the fingers of the declared sets."""
    if not settings.pipeline.finger_sets:
        return
    fingers = {f for each in parse_finger_sets(settings.pipeline.finger_sets) for f in each}
    if len(fingers) < kind.fewest_fingers:
        raise InputError(
            f"{kind.name} cannot be played with so few fingers",
            where="finger_sets",
            got=settings.pipeline.finger_sets,
            expected=f"sets with {kind.fewest_fingers} different fingers",
            remedy="Leave out --finger-sets, or name the other fingers too",
        )


def drawn(settings: Settings, may_overlap: bool = False) -> tuple[Task, tuple[Surface, ...]]:
    """Draws and varies the trial of a run, and places the surface of every hand.

    Args:
        settings: Settings of the run.
        may_overlap: True if objects of a varied trial may overlap; otherwise overlaps are refused.

    Raises:
        InputError: The task does not fit on the surface, it cannot be varied in this way, or
            objects of the varied trial overlap.
    """
    kind = find_task(settings.task)
    _check_finger_sets(settings, kind)
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
        may_overlap: True if objects of a varied trial may overlap at the start, because the trial
            was played before, or because a participant waits for it.

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
        # Without the correction, tips are not at their touches and cannot be offset. A hand that
        # may become solid inside objects needs no offsets.
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
    """One simulated hand: a human hand, or a robot hand."""
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
    from models.robot.mapping import find_robot
    from models.robot.robot_hand import RobotHand

    mapping = find_robot(settings.physics.robot)
    if mapping.side != hand.side:
        raise InputError(
            f"this robot hand is a {mapping.side} hand",
            where="--robot",
            got=f"{settings.physics.robot} for the {hand.side} hand",
            remedy=f"Use --hand {mapping.side}",
        )
    return RobotHand(
        name, mapping, skeleton, hand.size, settings.physics.impulse, solid_end=solid_end
    )


def _solid_end(settings: Settings, hand: HandSettings, task_type: type[Task]) -> float | None:
    """Solid length of the last links, m; None if the whole links are solid; see `Hand`."""
    if settings.physics.solid == SOLID[1]:
        return None if hand.in_air is not None else TIP_END
    if task_type.plane == "front":
        return UPRIGHT_END
    return TIP_END if hand.in_air is None else None


def _yaw_watch(model: TrainedModel) -> YawMonitor | None:
    """Monitor of hands that are turned further than in the training data; None without data."""
    try:
        return YawMonitor(YawRange.of(model.training_u))
    except CaptureError:
        return None
