"""Trained models: what they know, how they are kept, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.capture import Capture, save_capture
from encoders.evaluation.person_model import train_person
from encoders.regression.bone_fit import perturbed_skeleton
from encoders.regression.polynomial import PolynomialEncoder, QuadraticEncoder
from encoders.regression.trained import (
    PersonCorrection,
    TrainedModel,
    builtin,
    builtin_capture,
    builtin_folder,
    load_model,
)
from encoders.regression.training import blocked_predictions, rounded, save_model, train
from encoders.regression.yaw_normalised import YawNormalisedEncoder
from encoders.validation import robust_covariance
from models.errors import EncoderError
from models.pose import absolute_pose
from models.skeleton import ADULT
from sandbox.cli.main import main
from tests.support.npz_files import header_of, rewritten

CAPTURE_FILE = str(builtin_folder() / "capture.npz")


def said(**changes: Any) -> np.ndarray:
    """The header of a sound polynomial of degree 1 with something else in it."""
    sound = {"schema": 2, "kind": "polynomial", "degree": 1, "ridge": 0.01, "meta": {}}
    return header_of(json.dumps(sound | changes))


def said_turned(**changes: Any) -> np.ndarray:
    """The same of a turned encoder with a correction."""
    sound = {"schema": 2, "kind": "turned", "ridge": 0.03, "turned_ridge": 0.1, "meta": {}}
    return header_of(json.dumps(sound | {"distrust": 2.0} | changes))


@pytest.fixture(scope="module")
def capture() -> Capture:
    """Every twentieth frame of the built-in capture: all takes, quickly learned."""
    return builtin_capture().select(np.arange(0, len(builtin_capture()), 20))


@pytest.fixture(scope="module")
def model(capture: Capture) -> TrainedModel:
    return train(capture, "mine", 1, 0.01)


@pytest.fixture(scope="module")
def corrected(model: TrainedModel, capture: Capture) -> TrainedModel:
    """A turned encoder with a correction by bones that are not the table's."""
    encoder = YawNormalisedEncoder(0.03, 0.1).fit(capture.u, capture.relative)
    bones = perturbed_skeleton(ADULT, np.random.default_rng(0), 0.06, 0.004)
    correction = PersonCorrection(bones, model.residual_covariance, np.full(3, 1e-6), 2.0)
    return rounded(replace(model, name="turned", encoder=encoder, correction=correction))


@pytest.fixture
def corrected_path(corrected: TrainedModel, tmp_path: Path) -> Path:
    path = tmp_path / "turned.npz"
    save_model(corrected, path)
    return path


@pytest.fixture
def path(model: TrainedModel, tmp_path: Path) -> Path:
    path = tmp_path / "mine.npz"
    save_model(model, path)
    return path


@pytest.mark.parametrize("training", (True, False))
def test_a_yaw_normalised_encoder_and_its_correction_come_back_to_the_bit(
    corrected: TrainedModel, capture: Capture, training: bool, tmp_path: Path
) -> None:
    save_model(corrected, tmp_path / "t.npz", training)
    read = load_model(tmp_path / "t.npz", None if training else capture)
    assert read.digest == corrected.digest
    q = corrected.encoder.predict(capture.u)
    np.testing.assert_array_equal(read.encoder.predict(capture.u), q)
    assert isinstance(read.encoder, YawNormalisedEncoder) and read.encoder.turned_ridge == 0.1
    assert read.correction is not None and read.correction.distrust == 2.0
    q = absolute_pose(q, capture.leftmost)
    np.testing.assert_array_equal(
        read.correction.correct(q, capture.xy), corrected.correction.correct(q, capture.xy)
    )
    # Once rounded, nothing is left to round.
    save_model(read, tmp_path / "again.npz", training)
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "t.npz").read_bytes()


def test_a_model_without_its_training_data_takes_them_from_the_capture(
    model: TrainedModel, capture: Capture, tmp_path: Path
) -> None:
    save_model(model, tmp_path / "slim.npz", training=False)
    assert load_model(tmp_path / "slim.npz", capture).digest == model.digest
    with pytest.raises(EncoderError, match=r"slim\.npz"):
        load_model(tmp_path / "slim.npz")


def test_the_digest_sees_every_part(model: TrainedModel) -> None:
    encoder = model.encoder
    assert isinstance(encoder, PolynomialEncoder)
    changed = (
        replace(model, residual_covariance=model.residual_covariance * 1.01),
        replace(model, training_u=model.training_u[:-1]),
        replace(model, training_pose=model.training_pose + 0.01),
        replace(model, meta=model.meta | {"ridge": 0.02}),
        replace(model, encoder=PolynomialEncoder(1, 0.02).load(encoder.coef_, 15)),
        replace(model, encoder=PolynomialEncoder(1, 0.01).load(encoder.coef_ * 1.01, 15)),
    )
    assert len({model.digest, *(m.digest for m in changed)}) == 7
    assert replace(model, name="other").digest == model.digest


def test_the_covariance_is_that_of_errors_on_takes_not_seen(capture: Capture) -> None:
    model = train(capture, "mine", 1, None)
    seen = blocked_predictions(lambda: PolynomialEncoder(1, model.meta["ridge"]), capture)
    covariance = robust_covariance(capture.relative - seen)
    np.testing.assert_allclose(model.residual_covariance, covariance, rtol=1e-4, atol=1e-9)


def test_one_take_alone_is_refused(capture: Capture) -> None:
    with pytest.raises(EncoderError, match="2 trials"):
        train(capture.select(capture.trial == 0), "mine", 1, 0.0)


def test_the_papers_model_is_least_squares_on_the_built_in_capture() -> None:
    capture = builtin_capture()
    fresh = QuadraticEncoder().fit(capture.u, capture.relative)
    paper = builtin("paper")
    assert isinstance(paper.encoder, PolynomialEncoder)
    assert paper.encoder.ridge == 0 and paper.encoder.degree == 2 and fresh.rank_ == 121
    np.testing.assert_allclose(
        paper.encoder.predict(capture.u), fresh.predict(capture.u), atol=1e-4
    )


@pytest.mark.parametrize(
    "changes",
    (
        {"coef": None},
        {"coef": np.zeros((15, 48), np.float32)},
        {"coef": np.zeros((16, 48), int)},
        {"covariance": np.full((48, 48), np.nan, np.float32)},
        {"training_u": np.zeros((3, 15), np.float32)},
        {"training_pose": np.full((355, 48), np.inf, np.float32)},
        {"header": header_of('{"schema": 1, "kind": "polynomial", "degree": 1, "meta": {}}')},
        {"header": said(meta=None)},
        {"header": said(kind="deep")},
        {"header": said(degree=True)},
        {"header": said(ridge=-1.0)},
        {"header": said(kind="turned", turned_ridge=0.1)},
        {"header": said(distrust=1.0)},
    ),
)
def test_a_file_with_a_wrong_part_is_refused_in_one_clear_line(
    path: Path, changes: dict[str, Any]
) -> None:
    rewritten(path, **changes)
    with pytest.raises(EncoderError, match=r"mine\.npz") as error:
        load_model(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "changes",
    (
        {"coef": np.zeros((136, 48), np.float32)},
        {"coef": np.full((3, 136, 48), np.nan, np.float32)},
        {"anchors": None},
        {"anchors": np.zeros((15, 3), np.float32)},
        {"lengths": np.zeros(14, np.float32)},
        {"tip_variance": np.array([1e-6, 1e-6, -1e-6], np.float32)},
        {"header": said_turned(kind="polynomial", degree=2)},
        {"header": said_turned(turned_ridge=None)},
        {"header": said_turned(distrust=float("nan"))},
    ),
)
def test_a_turned_encoder_or_correction_with_a_wrong_part_is_refused(
    corrected_path: Path, changes: dict[str, Any]
) -> None:
    rewritten(corrected_path, **changes)
    with pytest.raises(EncoderError, match=r"turned\.npz") as error:
        load_model(corrected_path)
    assert "\n" not in str(error.value)


def test_with_a_degree_the_command_trains_that_polynomial(capture: Capture, tmp_path: Path) -> None:
    save_capture(capture, tmp_path / "c.npz")
    line = ["train", "--capture", str(tmp_path / "c.npz"), "--out", str(tmp_path / "m.npz")]
    assert main([*line, "--degree", "1", "--ridge", "0"]) == 0
    assert load_model(tmp_path / "m.npz").digest == train(capture, "m", 1, 0.0).digest


def test_without_a_degree_the_command_trains_what_wins(
    capture: Capture, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    few = capture.select(capture.trial % 3 == 0)
    save_capture(few, tmp_path / "c.npz")
    line = ["train", "--capture", str(tmp_path / "c.npz"), "--out", str(tmp_path / "m.npz")]
    assert main(line) == 0
    model, told = load_model(tmp_path / "m.npz"), capsys.readouterr().out
    assert "simulated" in told and model.meta["winner"] in told
    assert model.name == "m" and model.correction is not None
    assert model.digest == train_person(few, "m").digest


@pytest.mark.parametrize(
    "rest",
    (
        [],
        ["--capture", "none.npz"],
        ["--capture", CAPTURE_FILE, "--ridge", "-1"],
        ["--capture", CAPTURE_FILE, "--degree", "4"],
        ["--capture", CAPTURE_FILE, "--out", "none/m.npz"],
        ["--capture", CAPTURE_FILE, "--out", "."],
        ["--capture", "c.npz", "--out", "./c.npz"],
    ),
)
def test_the_command_answers_bad_input_with_one_line(
    rest: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["train", "--out", "m.npz", *rest]) == 2
    assert capsys.readouterr().err.count("\n") == 1
