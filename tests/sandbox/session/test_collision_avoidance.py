"""A hand that is solid all over keeps its free parts clear of things, and pushes none of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import mujoco
import numpy as np
import pytest

from models.arithmetic import Array
from models.frames import Contact
from models.hand import Hand
from models.objects import Box
from models.pose import JOINTS
from models.scene import Scene, SceneSpec
from models.single_pose import SinglePose
from models.skeleton import ADULT
from sandbox.session import collision_avoidance
from sandbox.session.collision_avoidance import REACH, HandDistances
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.corrections import Changes
from tests.support.scripted import box_xy, run, scripted
from tests.support.simulation import put


def beside_box(solid: Literal["fingertips", "hand"], far: float = 0.0) -> Session:
    """Thumb and index touch before the box, so that free fingers would be inside of it.

    Args:
        solid: What collides.
        far: m farther from the box, to the left and towards the person, of the touches.
    """
    empty = scripted(lambda now: (), seed=1)
    x, y = box_xy(empty)
    empty.close()

    def touch(now: float) -> list[Contact]:
        at = [(x - 0.075 - far, y + 0.015 + far), (x - 0.045 - far, y - 0.015 + far)]
        return [Contact(i, float(a), float(b), label=i) for i, (a, b) in enumerate(at)]

    return scripted(touch, seed=1, labels="device", solid=solid)


def near_parts(session: Session) -> dict[str, float]:
    """m from things, of the parts of the hand that are near, by the names of their geoms."""
    model = session.scene.model
    parts, distances, _ = HandDistances(fresh(session), 0).near(session.data)
    names = [model.geom(part).name for part in parts]
    return {
        name: min(d for n, d in zip(names, distances, strict=True) if n == name) for name in names
    }


def fresh(session: Session) -> Scene:
    """The scene as it was compiled."""
    return Scene(session.scene.spec)


def free_parts(near: dict[str, float], free: str) -> list[float]:
    return [far for name, far in near.items() if free in name]


def test_without_avoidance_a_free_finger_is_inside_the_box() -> None:
    """The scene of the next tests asks something of them."""
    session = beside_box("fingertips")
    run(session, 1.0)
    assert min(free_parts(near_parts(session), "ring")) < -0.001
    session.close()


def test_a_free_finger_keeps_its_distance_and_the_touching_tips_stay() -> None:
    session = beside_box("hand")
    before = session.scene.object_pose(session.data, "box")[0]
    run(session, 1.0)
    near = near_parts(session)
    assert min([*free_parts(near, "ring"), REACH]) > 0.001
    after = session.scene.object_pose(session.data, "box")[0]
    assert np.abs(after - before).max() < 0.0005
    hand = session.snapshot().hands[0]
    touches = hand.places[:, :2]
    assert np.abs(hand.tips[:2, :2] - touches).max() < 0.003
    session.close()


def test_the_whole_hand_is_solid_where_only_tips_were() -> None:
    whole, tips = beside_box("hand", far=0.12), beside_box("fingertips", far=0.12)
    for session in (whole, tips):
        run(session, 1.0)
    assert whole.solid(0) == set(range(5))
    assert tips.solid(0) == {0, 1}
    # Nothing is near, so that no finger is led.
    assert np.array_equal(whole.reconstructions[0].q, tips.reconstructions[0].q)
    ghosts = [g for g in whole.scene.parts(0) if not whole.scene.model.geom_contype[g]]
    names = {whole.scene.model.geom(g).name for g in ghosts}
    # A whole last link takes the place of its end, which is the same geom twice.
    assert names <= {link.tip_geom for link in whole.scene.spec.hands[0].links}
    for session in (whole, tips):
        session.close()


SHARES = np.linspace(-1.0, 1.0, 41)


def fresh_scene() -> Scene:
    """A hand, and a box below its fingers."""
    box = Box("box", (0.03, 0.03, 0.03), 0.1, (0.0, 0.1, 0.03), 0.3)
    return Scene(SceneSpec((Hand(solid_end=0.012, solid_palm=True),), (box,)))


def hand_by_box() -> tuple[HandDistances, mujoco.MjData]:
    """A hand whose fingers are over a box."""
    scene = fresh_scene()
    data = mujoco.MjData(scene.model)
    mujoco.mj_forward(scene.model, data)
    return HandDistances(scene, 0), data


@pytest.mark.parametrize("seed", range(3))
def test_the_derivatives_of_distances_are_finite_differences(seed: int) -> None:
    distances, data = hand_by_box()
    rng = np.random.default_rng(seed)
    middle = 0.5 * (ADULT.lower + ADULT.upper)
    joints = middle + 0.2 * rng.uniform(-1.0, 1.0, 42) * (ADULT.upper - middle)
    q = np.concatenate([[0.0, 0.0, 0.11], 0.1 * rng.uniform(-1.0, 1.0, 3), joints])
    kinematics = SinglePose(ADULT, (0,))
    kinematics.tips_and_jacobian(q)

    def near(pose: Array) -> dict[int, tuple[float, int]]:
        """The nearest point of each part: its distance, and its place in the list."""
        kinematics.tips(pose)
        parts, found, _ = distances.near(data, kinematics.joint_positions())
        rows = range(len(parts))
        return {p: min((found[k], k) for k in rows if parts[k] == p) for p in parts}

    here = near(q)
    clear = [part for part, (far, _) in here.items() if far > 0.0005]
    assert len(clear) >= 2
    kinematics.tips_and_jacobian(q)
    ours = kinematics.by_pose(distances.gradients([here[part][1] for part in clear]))
    step = 1e-6
    for i in range(48):
        forward, back = q.copy(), q.copy()
        forward[i] += step
        back[i] -= step
        up, down = near(forward), near(back)
        change = np.array([up[part][0] - down[part][0] for part in clear])
        assert change / (2 * step) == pytest.approx(ours[:, i], abs=2e-4)


@pytest.mark.parametrize("seed", range(20))
def test_the_likeliest_correction_keeps_every_margin_however_many_there_are(seed: int) -> None:
    """Margins that can be kept are, and the fingertips stay."""
    session = beside_box("hand")
    avoidance = session._avoidance[0]
    assert avoidance is not None
    rng = np.random.default_rng(seed)
    tips, margins = rng.normal(size=(9, 48)), rng.normal(size=(24, 48))
    # All margins can be kept by one correction, which does not move the tips.
    null = np.eye(48) - np.linalg.pinv(tips) @ tips
    one = null @ rng.normal(size=48) * 0.01
    lacking = margins @ one - rng.uniform(0.0, 0.01, 24)
    A = np.concatenate([tips, margins])
    r = np.concatenate([np.zeros(9), lacking])
    q0 = np.concatenate([np.zeros(6), 0.5 * (ADULT.lower + ADULT.upper)])
    offset, led = avoidance._likeliest(A, r, 9, q0)
    assert np.abs(tips @ offset).max() < 0.001
    assert (margins @ offset - lacking).min() > -0.002
    assert 0 < len(led) < 24
    session.close()


def distance_from_box(scene: Scene, data: mujoco.MjData, geom: int, radius: float) -> float:
    """m between the box and a capsule of the scene, by the box's own distances."""
    half = np.array([[0.0, 0.0, s * scene.model.geom_size[geom, 1]] for s in SHARES])
    points = data.geom_xpos[geom] + half @ data.geom_xmat[geom].reshape(3, 3).T
    box = scene.spec.objects[0]
    return float(box.clearance(points, *scene.object_pose(data, "box")).min() - radius)


@pytest.mark.parametrize("height", [0.075, 0.09, 0.1])
def test_every_part_within_reach_of_a_thing_is_measured(height: float) -> None:
    """The box's own distances are the independent reader."""
    distances, data = hand_by_box()
    scene = fresh_scene()
    put(scene, data, np.concatenate([[0.0, 0.02, height], np.zeros(45)]))
    mujoco.mj_forward(scene.model, data)
    parts, found, _ = distances.near(data)
    checked = 0
    for link in scene.spec.hands[0].links:
        geom = scene.model.geom(link.tip_geom).id
        clear = distance_from_box(scene, data, geom, link.radius)
        if 0.0 < clear < REACH - 0.001:
            measured = min([d for p, d in zip(parts, found, strict=True) if p == geom], default=1.0)
            assert measured == pytest.approx(clear, abs=5e-4)
            checked += 1
    assert checked >= 3


def test_the_two_parts_of_a_last_link_are_the_whole_of_it() -> None:
    """Whichever way a finger stands to a thing: also with its last joint foremost."""
    distances, data = hand_by_box()
    scene = fresh_scene()
    rng = np.random.default_rng(8)
    middle, half = 0.5 * (ADULT.lower + ADULT.upper), 0.5 * (ADULT.upper - ADULT.lower)
    checked = 0
    for _ in range(80):
        turn = rng.uniform(-np.pi, np.pi, 3)
        at = rng.uniform([-0.04, 0.0, 0.03], [0.04, 0.12, 0.12])
        put(scene, data, np.concatenate([at, turn, middle + rng.uniform(-1.0, 1.0, 42) * half]))
        mujoco.mj_forward(scene.model, data)
        parts, found, _ = distances.near(data)
        for link in scene.spec.hands[0].links:
            own = {scene.model.geom(name).id for name in (link.geom, link.tip_geom)}
            clear = distance_from_box(scene, data, scene.model.geom(link.geom).id, link.radius)
            if len(own) == 2 and -0.5 * link.radius < clear < REACH - 0.001:
                measured = min([d for p, d in zip(parts, found, strict=True) if p in own])
                assert measured == pytest.approx(clear, abs=5e-4)
                checked += 1
    assert checked >= 20


View = Callable[[Snapshot], None]


def between_books(seed: int, views: Callable[[Session], Sequence[View]]) -> bool:
    """Plays `books`, where the encoder's pose is inside of a book; tells whether it succeeded."""
    chosen = trial_settings(TrialOptions(task="books", seed=seed, solid="hand"))
    return play_trial(chosen, device_makers(chosen), views).success


def back(seed: int) -> float:
    """rad a control step that corrections take back of the step before, in one trial."""
    seen: list[Changes] = []

    def watch(session: Session) -> list[View]:
        seen.append(Changes(session))
        return [*seen]

    assert between_books(seed, watch)
    assert seen[0].steps > 100
    return seen[0].back / seen[0].steps


@pytest.mark.parametrize("seed", [9001, 9002])
def test_without_a_share_of_the_correction_before_a_hand_between_books_trembles_twice_as_much(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    steady = back(seed)
    monkeypatch.setattr(collision_avoidance, "STEADY", 1e3)
    assert back(seed) > 2.0 * steady


@pytest.mark.parametrize("seed", [7001, 7002, 7003])
def test_every_joint_of_a_hand_that_is_led_stays_in_its_range(seed: int) -> None:
    led: list[bool] = []

    def watch(session: Session) -> list[View]:
        def look(snapshot: Snapshot) -> None:
            led.append(session.correction(0) is not None)
            joints = session.reconstructions[0].q[JOINTS]
            assert np.all(joints >= ADULT.lower) and np.all(joints <= ADULT.upper)

        return [look]

    between_books(seed, watch)
    assert sum(led) > 50
