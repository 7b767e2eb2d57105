"""A rest posture seen once, on a screen or in the air: it removes what a hand does differently."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.capture import Capture, save_capture
from encoders.correction import PAD_HEIGHT
from encoders.person.rest_posture import (
    MOST,
    SECONDS,
    SeenRest,
    check_rest_samples,
    knowing_rest,
    load_rest,
    rest_samples,
    save_rest,
)
from encoders.regression.trained import TrainedModel, builtin
from models.arithmetic import Array
from models.errors import EncoderError, InputError
from models.kinematics import Kinematics
from models.person import RestSample
from models.pose import JOINTS, ROOT_POSITION, absolute_pose
from models.skeleton import ADULT
from tests.encoders.person.resting_hand import resting
from training.population import simulate_population
from training.pose import at_trained_size

PLANTED = 0.1
"""rad, bending of all fingers' middle joints beyond what the encoder expects."""
BENT = 6 + 3 * np.array([3, 6, 9, 12])


@cache
def person() -> Capture:
    one = simulate_population("rest", {"judge": {"second": 1}}).people[0]
    return at_trained_size(one, one.meta["size"])


def model() -> TrainedModel:
    return builtin("population")


def planted() -> Capture:
    """A person who does what the encoder expects, but bends the fingers more."""
    q = absolute_pose(model().encoder.predict(person().u), person().leftmost)
    q[:, BENT] += PLANTED
    return replace(person(), q=q)


def missing(known: TrainedModel, capture: Capture) -> float:
    """Mean error (rad) of the bent joints, with its sign."""
    off = known.encoder.predict(capture.u) - capture.relative
    return float(off[:, BENT].mean())


def test_a_planted_offset_is_removed_and_more_looks_remove_more() -> None:
    seen = planted()
    samples = rest_samples(seen)
    left = [
        abs(missing(knowing_rest(model(), samples[:n], 1.0), seen)) for n in (1, 4, len(samples))
    ]
    assert abs(missing(model(), seen)) == pytest.approx(PLANTED, abs=1e-9)
    assert PLANTED > left[0] > left[1] > left[2]
    assert left[2] < 0.6 * PLANTED


def test_looks_at_what_the_encoder_expects_change_nothing() -> None:
    expected = absolute_pose(model().encoder.predict(person().u), person().leftmost)
    known = knowing_rest(model(), rest_samples(replace(person(), q=expected)), 1.0)
    u = person().u[:20]
    found = known.encoder.predict(u)
    np.testing.assert_allclose(found, model().encoder.predict(u), atol=1e-4)
    np.testing.assert_allclose([known.encoder.predict(row) for row in u], found, atol=1e-9)


def test_a_seen_hand_is_less_uncertain_in_no_direction_more() -> None:
    known = knowing_rest(model(), rest_samples(planted()), 1.0)
    told = model().residual_covariance - known.residual_covariance
    assert np.linalg.eigvalsh(told).min() > -1e-7 < np.linalg.eigvalsh(told).max()
    assert np.linalg.eigvalsh(known.residual_covariance).min() > -1e-6


def test_size_changes_lengths_and_no_angles() -> None:
    samples = rest_samples(planted())
    larger = tuple(
        RestSample(
            tuple(p and (1.1 * p[0], 1.1 * p[1]) for p in sample.touches),
            tuple((np.array(sample.pose) * np.r_[np.full(3, 1.1), np.ones(45)]).tolist()),
        )
        for sample in samples
    )
    u = person().u[:20]
    same = knowing_rest(model(), larger, 1.1).encoder.predict(u)
    np.testing.assert_allclose(
        same, knowing_rest(model(), samples, 1.0).encoder.predict(u), atol=1e-6
    )


@pytest.mark.parametrize("hand", ("right", "left"))
def test_a_file_gives_back_its_looks(tmp_path: Path, hand: str) -> None:
    samples = rest_samples(person(), 3)
    save_rest(samples, tmp_path / "rest.json", hand, simulated=True)
    assert load_rest(tmp_path / "rest.json", hand, 1.0) == samples
    first = json.loads((tmp_path / "rest.json").read_text())["looks"][0]
    touch = next(i for i, place in enumerate(samples[0].touches) if place)
    sign = 1 if hand == "right" else -1
    known = samples[0].touches[touch]
    assert known is not None and first["touches"][touch] == [sign * known[0], known[1]]


def test_a_capture_is_a_rest_posture_as_well(tmp_path: Path) -> None:
    save_capture(person(), tmp_path / "me.npz", np.float64)
    assert load_rest(tmp_path / "me.npz", "right", 1.0) == rest_samples(person())
    assert 1 <= len(rest_samples(person())) <= MOST


def test_a_capture_of_a_left_hand_is_a_left_hands_rest_posture(tmp_path: Path) -> None:
    # As `sandbox capture --side left` writes it: mirrored, and saying so.
    meta = {**person().meta, "side": "right", "recorded_side": "left"}
    save_capture(replace(person(), meta=meta), tmp_path / "me.npz", np.float64)
    assert load_rest(tmp_path / "me.npz", "left", 1.0) == rest_samples(person())
    with pytest.raises(InputError, match="other hand"):
        load_rest(tmp_path / "me.npz", "right", 1.0)


def test_a_file_that_cannot_be_written_is_refused_and_the_old_one_stays(tmp_path: Path) -> None:
    (tmp_path / "me.json").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        save_rest(rest_samples(person()), tmp_path / "me.json", "right", simulated=True)
    assert (tmp_path / "me.json").is_dir()


@pytest.mark.parametrize(
    "wrong",
    (
        {"schema": 9},
        {"kind": "a cake"},
        {"hand": "left"},
        {"looks": []},
        {"looks": [{"touches": [None] * 5, "pose": [0.0] * 48}]},
        {"looks": [{"touches": [[0, 0]] * 5, "pose": [0.0]}]},
        {"looks": [{"touches": [[0, 0]] * 5, "pose": [0.0] * 20 + [3.0] * 28}]},
        {"looks": [{"touches": [[0, 0]] * 5, "pose": [0.0] * 48}]},
    ),
)
def test_a_file_that_cannot_be_used_is_refused(tmp_path: Path, wrong: dict[str, Any]) -> None:
    path = tmp_path / "rest.json"
    save_rest(rest_samples(person(), 2), path, "right", simulated=True)
    path.write_text(json.dumps(json.loads(path.read_text()) | wrong))
    with pytest.raises(InputError):
        load_rest(path, "right", 1.0)


def test_two_swapped_fingers_are_noticed() -> None:
    sample = next(k for k in rest_samples(person()) if None not in k.touches)
    thumb, *others, little = sample.touches
    with pytest.raises(EncoderError, match="far from its touch"):
        check_rest_samples([RestSample((little, *others, thumb), sample.pose)], 1.0)


RATE = 30.0
HAND = Kinematics(ADULT)


def shown(seen: SeenRest, poses: Array, begin: float = 0.0) -> list[bool]:
    return [seen.add(begin + i / RATE, q) for i, q in enumerate(poses)]


def trembling(q: Array, seconds: float, by: float = 0.001, seed: int = 0) -> Array:
    """Poses of a hand whose wrist and joints shake by m and by five times as many rad."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(0.0, by, (round(seconds * RATE), len(q)))
    noise[:, 3:] *= 5.0
    return q + noise


def moved(q: Array, by: tuple[float, float, float]) -> Array:
    other = q.copy()
    other[ROOT_POSITION] += by
    return other


def test_a_still_hand_is_a_look_wherever_it_is_held() -> None:
    q = resting()
    for place in ((0.0, 0.0, 0.0), (0.2, -0.1, 0.35)):
        seen = SeenRest(ADULT)
        assert sum(shown(seen, trembling(moved(q, place), 1.5))) == 1
        (sample,) = seen.samples
        check_rest_samples(seen.samples, 1.0)
        tips, pose = HAND.tips(q), np.array(sample.pose)
        touches = np.array(sample.touches)
        # What a sample is used for is relative: layout, height of the wrist, joints.
        layout = tips[:, :2] - tips[0, :2]
        assert np.abs((touches - touches[0]) * [1.0, -1.0] - layout).max() < 0.002
        assert abs(pose[2] - (q[2] - np.median(tips[:, 2]) + PAD_HEIGHT)) < 0.002
        assert np.abs(pose[JOINTS] - q[JOINTS]).max() < np.radians(1.0)


def test_a_hand_that_moves_is_no_look() -> None:
    q = resting()
    sliding = np.array([moved(q, (0.03 * i / RATE, 0.0, 0.0)) for i in range(60)])
    seen = SeenRest(ADULT)
    assert not any(shown(seen, sliding)) and seen.trouble == ""


def test_less_than_a_second_is_no_look() -> None:
    seen = SeenRest(ADULT)
    assert not any(shown(seen, trembling(resting(), 0.8 * SECONDS)))
    seen.lose()
    assert not any(shown(seen, trembling(resting(), 0.8 * SECONDS), 1.0))


def test_the_next_look_needs_another_rest() -> None:
    seen, q = SeenRest(ADULT), resting()
    assert sum(shown(seen, trembling(q, 4.0))) == 1
    assert sum(shown(seen, trembling(moved(q, (0.05, 0.0, 0.0)), 2.0), 4.0)) == 1
    assert len(seen.samples) == 2


def test_fingertips_that_are_not_on_one_level_are_told() -> None:
    q = resting()
    q[JOINTS.start + 6] += 0.8  # the index finger, raised at its knuckle
    seen = SeenRest(ADULT)
    assert not any(shown(seen, trembling(q, 2.0)))
    assert "index is" in seen.trouble and "above the other fingertips" in seen.trouble


@pytest.mark.parametrize("size", [0.85, 1.15])
def test_hands_of_other_sizes_fit_their_touches(size: float) -> None:
    skeleton = ADULT.scaled(size)
    q = resting(size)
    seen = SeenRest(skeleton)
    assert sum(shown(seen, trembling(q, 1.5))) == 1
    check_rest_samples(seen.samples, size)
