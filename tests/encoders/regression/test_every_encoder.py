"""What every encoder keeps to, whatever it learns with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from encoders import PcaIkEncoder
from encoders.encoder import Encoder
from encoders.regression.polynomial import CubicEncoder, LinearEncoder, QuadraticEncoder
from encoders.regression.yaw_normalised import YawNormalisedEncoder
from models.errors import EncoderError
from tests.encoders.regression.ik_frames import new_touches, poses, touches

ENCODERS: dict[str, Callable[[], Encoder]] = {
    "linear": LinearEncoder,
    "quadratic": QuadraticEncoder,
    "cubic": lambda: CubicEncoder(0.1),
    "turned": YawNormalisedEncoder,
    "pca-ik": lambda: PcaIkEncoder(iterations=10),
    "pca-ik, root free": lambda: PcaIkEncoder(iterations=10, free="root", start="projected"),
}
every_encoder = pytest.mark.parametrize("name", ENCODERS)


@every_encoder
def test_rows_alone_and_in_any_order_give_the_poses_of_the_whole(name: str) -> None:
    encoder = ENCODERS[name]().fit(touches(), poses())
    together = encoder.predict(new_touches())
    assert together.shape == (len(new_touches()), 48)
    for i in range(0, len(new_touches()), 7):
        np.testing.assert_allclose(encoder.predict(new_touches()[i]), together[i], atol=1e-9)
    np.testing.assert_allclose(encoder.predict(new_touches()[::-1])[::-1], together, atol=1e-9)
    assert encoder.predict(new_touches()[:0]).shape == (0, 48)


@every_encoder
def test_equal_frames_teach_the_same_to_the_bit_and_stay_as_they_were(name: str) -> None:
    u, q = touches().copy(), poses().copy()
    once, again = (ENCODERS[name]().fit(u, q).predict(new_touches()) for _ in range(2))
    np.testing.assert_array_equal(once, again)
    np.testing.assert_array_equal(u, touches())
    np.testing.assert_array_equal(q, poses())


@every_encoder
@pytest.mark.parametrize(
    "data",
    [
        lambda u, q: (u, q[:-1]),
        lambda u, q: (u[0], q),
        lambda u, q: (u[:0], q[:0]),
        lambda u, q: (np.where(u == u[3, 2], np.nan, u), q),
        lambda u, q: (u, np.where(q == q[5, 7], np.inf, q)),
    ],
    ids=["a pose too few", "one row", "empty", "not a number", "infinite"],
)
def test_unusable_training_data_are_refused(name: str, data: Callable[..., Any]) -> None:
    with pytest.raises(EncoderError):
        ENCODERS[name]().fit(*data(touches(), poses()))


@pytest.mark.parametrize("name", ["turned", "pca-ik"])
def test_data_that_are_no_touches_and_poses_are_refused(name: str) -> None:
    for data in ((touches()[:, :14], poses()), (touches(), poses()[:, :42])):
        with pytest.raises(EncoderError):
            ENCODERS[name]().fit(*data)


@every_encoder
def test_inputs_of_another_width_and_encoders_that_learned_nothing_are_refused(name: str) -> None:
    encoder = ENCODERS[name]()
    with pytest.raises(EncoderError):
        encoder.predict(new_touches())
    encoder.fit(touches(), poses())
    for narrow in (new_touches()[:, :14], new_touches()[0, :14]):
        with pytest.raises(EncoderError):
            encoder.predict(narrow)
