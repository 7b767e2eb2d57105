"""The gate notices faults that its quick run can see, and what it compares comes out the same."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import msgspec
import mujoco
import numpy as np
import pytest

from encoders.correction import FingertipCorrection
from encoders.labels.belief import BeliefLabels
from models.frames import Frame
from models.scene import Scene
from sandbox.devices.device import LatestFrame
from sandbox.server.protocol import PageTouches
from sandbox.server.web import WebDevice
from tools.gate import devices, trials
from tools.gate.__main__ import FILE
from tools.gate.rows import Rows, differences, fingerprint

TRIAL = "box-to-goal 0"
"""Row of `solid fingertips` that the faults below change."""
PAGE = "page"
"""Row of `devices`: the page's touches, with a cancelled and a lost finger."""

Fault = Callable[[pytest.MonkeyPatch], None]


def observed() -> Rows:
    """The two rows, played in this process."""
    job = trials.jobs(quick=True)["solid fingertips", TRIAL]
    rows: Rows = {
        "solid fingertips": {TRIAL: trials.play(job)},
        "devices": {PAGE: devices.play(PAGE)},
    }
    plain: Rows = json.loads(json.dumps(rows))
    return plain


@pytest.fixture(scope="module")
def sound() -> Rows:
    return observed()


def friction_20_percent_lower(patch: pytest.MonkeyPatch) -> None:
    begin = Scene.__init__

    def wrong(self: Scene, *arguments: Any, **named: Any) -> None:
        begin(self, *arguments, **named)
        self.model.geom_friction[:, 0] *= 0.8
        self.model.pair_friction[:, :2] *= 0.8

    patch.setattr(Scene, "__init__", wrong)


def two_labels_swapped(patch: pytest.MonkeyPatch) -> None:
    assign, swapped = BeliefLabels.assign, {1: 2, 2: 1}

    def wrong(self: BeliefLabels, *arguments: Any) -> Any:
        right = assign(self, *arguments)
        return replace(right, labels={i: swapped.get(f, f) for i, f in right.labels.items()})

    patch.setattr(BeliefLabels, "assign", wrong)


def correction_aims_a_millimetre_aside(patch: pytest.MonkeyPatch) -> None:
    correct = FingertipCorrection.correct

    def wrong(
        self: FingertipCorrection, guess: Any, labels: Any, targets: Any, *more: Any, **named: Any
    ) -> Any:
        aside = np.add(targets, [0.001, 0.0, 0.0])
        return correct(self, guess, labels, aside, *more, **named)

    patch.setattr(FingertipCorrection, "correct", wrong)


def a_touch_frame_dropped(patch: pytest.MonkeyPatch) -> None:
    take = LatestFrame.take

    def wrong(self: LatestFrame, frames: Sequence[Frame], time: float) -> bool:
        return take(self, () if abs(time - 2.0) < 1e-6 else frames, time)

    patch.setattr(LatestFrame, "take", wrong)


def a_cancel_taken_for_a_lift(patch: pytest.MonkeyPatch) -> None:
    receive = WebDevice.receive

    def wrong(self: WebDevice, message: PageTouches, screen: Any) -> bool:
        return receive(self, msgspec.structs.replace(message, cancelled=[]), screen)

    patch.setattr(WebDevice, "receive", wrong)


def one_physics_step_more(patch: pytest.MonkeyPatch) -> None:
    step, calls = mujoco.mj_step, []

    def wrong(model: Any, data: Any, nstep: int = 1) -> None:
        calls.append(nstep)
        step(model, data, nstep=nstep + (len(calls) == 200))

    patch.setattr(mujoco, "mj_step", wrong)


FAULTS: dict[Fault, str] = {
    friction_20_percent_lower: "solid fingertips",
    two_labels_swapped: "solid fingertips",
    correction_aims_a_millimetre_aside: "solid fingertips",
    a_touch_frame_dropped: "devices",
    a_cancel_taken_for_a_lift: "devices",
    one_physics_step_more: "solid fingertips",
}
"""Fault -> group of a row that it changes."""


def test_a_checkout_equals_itself_and_the_file(sound: Rows) -> None:
    assert not differences(sound, observed(), sound, whole=True, same_machine=True)
    stored = json.loads(FILE.read_text())
    same = stored["fingerprint"] == fingerprint()
    assert not differences(stored["rows"], sound, sound, whole=False, same_machine=same)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
def test_a_planted_fault_is_noticed(
    sound: Rows, monkeypatch: pytest.MonkeyPatch, fault: Fault
) -> None:
    fault(monkeypatch)
    found = differences(sound, observed(), sound, whole=True, same_machine=True)
    assert FAULTS[fault] in {difference.group for difference in found}


ROW = {"hash": "aa", "status": "held", "success": True, "time_s": 2.0}


def test_on_another_machine_outcomes_count_and_states_do_not() -> None:
    before = {"g": {"stack 1": ROW, "gather 1": ROW, "soft servos": ROW}}
    states = {name: {**ROW, "hash": "bb", "time_s": 2.1} for name in before["g"]}
    lost = {name: {**row, "success": False} for name, row in states.items()}
    for same, now, names in (
        (True, states, {"stack 1", "gather 1", "soft servos"}),
        (False, states, set()),
        (False, lost, {"stack 1"}),
    ):
        found = differences(before, {"g": now}, "g", whole=True, same_machine=same)
        assert {difference.name for difference in found} == names


def test_a_row_that_vanished_and_one_that_could_not_be_played_differ() -> None:
    broken = {"error": "ValueError: no"}
    before: Rows = {"g": {"a": ROW, "b": broken}}
    found = differences(before, {"g": {"b": broken}}, "g", whole=True, same_machine=True)
    assert {difference.name for difference in found} == {"a", "b"}
    assert not differences(before, {"g": {"a": ROW}}, "g", whole=False, same_machine=True)
