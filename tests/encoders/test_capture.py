"""A capture keeps its contract, survives its file, and is refused whole when damaged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from encoders.capture import Capture, load_capture, save_capture
from models.arithmetic import Array
from models.errors import CaptureError
from tests.support.npz_files import header_of, rewritten


def capture(frames: int = 12, seed: int = 0) -> Capture:
    rng = np.random.default_rng(seed)
    down = rng.random((frames, 5)) < 0.6
    down[:, 1] = True
    xy = np.where(down[..., None], rng.uniform(0, 0.15, (frames, 5, 2)), np.nan)
    ids = np.where(down, np.arange(5), -1)
    trial = np.arange(frames) // 4
    meta = {"subject": "nobody", "rate_hz": 30.0, "simulated": True}
    return Capture(np.arange(frames) / 30, trial, ids, xy, rng.normal(size=(frames, 48)), meta)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "capture.npz"
    save_capture(capture(), path)
    return path


def test_a_capture_survives_saving_to_the_bit_and_in_single_precision_to_100_nm(path: Path) -> None:
    made, read = capture(), load_capture(path)
    for name in ("time", "trial", "ids", "xy", "q"):
        np.testing.assert_array_equal(getattr(read, name), getattr(made, name))
    assert read.meta == made.meta
    save_capture(made, path, np.float32)
    read = load_capture(path)
    np.testing.assert_allclose(read.xy, made.xy, atol=1e-7)
    np.testing.assert_array_equal(read.time, made.time)


def test_moving_hand_and_touches_together_changes_neither_input_nor_output() -> None:
    c = capture()
    q = c.q.copy()
    q[:, :2] += [0.03, -0.02]
    moved = replace(c, xy=c.xy + np.array([0.03, 0.02]), q=q)
    np.testing.assert_allclose(moved.u, c.u, atol=1e-12)
    np.testing.assert_allclose(moved.relative, c.relative, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "value"),
    (
        ("q", np.zeros((12, 47))),
        ("xy", np.zeros((12, 5, 3))),
        ("q", np.full((12, 48), np.nan)),
        ("time", np.full(12, np.inf)),
        ("xy", np.full((12, 5, 2), np.nan)),
        ("xy", np.zeros((12, 5, 2))),
        ("xy", np.where(np.isnan(capture().xy), np.inf, capture().xy)),
        ("xy", np.where(np.isnan(capture().xy), [np.nan, 0.0], capture().xy)),
    ),
)
def test_arrays_that_break_the_contract_are_refused(
    name: str, value: Array | NDArray[np.int64]
) -> None:
    changes: dict[str, Any] = {name: value}
    with pytest.raises(CaptureError, match=name):
        replace(capture(), **changes)


def test_an_empty_capture_is_refused() -> None:
    with pytest.raises(CaptureError, match="empty"):
        capture().select(np.zeros(12, bool))


@pytest.mark.parametrize(
    "changes",
    (
        {"q": None},
        {"q": np.zeros((12, 48), int)},
        {"ids": np.zeros((12, 5))},
        {"xy": np.array("text")},
        {"time": np.zeros(3)},
        {"header": header_of('{"schema": 99}')},
        {"header": np.zeros(0)},
    ),
)
def test_a_file_with_a_wrong_part_is_refused_and_named(path: Path, changes: dict[str, Any]) -> None:
    rewritten(path, **changes)
    with pytest.raises(CaptureError, match=r"capture\.npz"):
        load_capture(path)


def test_a_capture_out_of_order_is_refused_when_it_is_read(tmp_path: Path) -> None:
    made = capture()
    back, same, mixed = made.time.copy(), made.ids.copy(), made.trial[::-1].copy()
    back[6] -= 1.0
    same[made.ids >= 0] = 7
    mixed[0] = mixed[-1]
    for changed, said in (
        ({"time": back}, "time does not increase"),
        ({"ids": same}, "share an id"),
        ({"trial": mixed}, "not in one piece"),
    ):
        save_capture(replace(made, **changed), tmp_path / "c.npz")
        with pytest.raises(CaptureError, match=said):
            load_capture(tmp_path / "c.npz")
    # A clock may begin anew with every take.
    save_capture(replace(made, time=np.arange(12) % 4 / 30), tmp_path / "c.npz")
    load_capture(tmp_path / "c.npz")


@pytest.mark.parametrize("units", ("touches", "wrists", "joints"))
def test_millimetres_and_degrees_are_noticed(tmp_path: Path, units: str) -> None:
    made = capture()
    factor = np.ones(48)
    factor[:3], factor[6:] = (1000 if units == "wrists" else 1), (57.3 if units == "joints" else 1)
    xy = made.xy * (1000 if units == "touches" else 1)
    save_capture(replace(made, xy=xy, q=made.q * factor), tmp_path / "c.npz")
    with pytest.raises(CaptureError, match=r"too far from its touches|more than a full turn"):
        load_capture(tmp_path / "c.npz")
