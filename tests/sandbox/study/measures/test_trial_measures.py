"""Measures of a whole trial: from hand-made arrays, and from one that was simulated."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.frames import FINGERS
from models.objects import MechanismPart
from models.surface import Surface
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.study.measures.arrays import TrialArrays
from sandbox.study.measures.measures import MEASURES, measure_trial
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.trial_files import frames_of
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.tables.contacts import ContactReader
from sandbox.study.tables.frame_table import FrameTable, make_frames, read_frames, yaw_error
from sandbox.study.tables.tables import make_tables
from sandbox.trial.assembly import build
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from tasks.sensing import Sensing
from tasks.task import Goal, Task
from tasks.user import UserConfiguration
from tests.support.study_files import first_session, open_study, quiet, rows_of, trial_result

PERIOD = 0.016


def table(palm: Array, box: Array, goal: Array, **other: Any) -> TrialArrays:
    """A table of a hand that is down all the time and never touches, unless told otherwise."""
    n = len(palm)
    columns: dict[str, Any] = {
        "time_s": [PERIOD * (i + 1) for i in range(n)],
        "phase": ["down"] * n,
        **{f"{kind}_{finger}": [None] * n for kind in ("touch", "true") for finger in FINGERS},
        **{f"q_position_{axis}": palm[:, i] for i, axis in enumerate("xyz")},
        **{f"box_{axis}": box[:, i] for i, axis in enumerate("xyz")},
        "box_qw": np.ones(n),
        "box_digits": [""] * n,
        "box_grip_N": [0.0] * n,
        "box_by": ["table"] * n,
        "box_on": ["table"] * n,
        **{f"box_goal_{axis}": np.full(n, goal[i]) for i, axis in enumerate("xyz")},
        "box_off_rad": [0.0] * n,
    }
    return TrialArrays.of({**columns, **other})


def half_circle(n: int = 401) -> Array:
    angle = np.linspace(0.0, np.pi, n)
    return 0.05 * np.stack([1.0 - np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)


def test_a_half_circle_of_palm_and_box_has_the_measures_of_geometry() -> None:
    arc, goal = half_circle(), np.array([0.11, 0.0, 0.0])
    n = len(arc)
    measured = measure_trial(
        table(
            arc[::-1], arc, goal, box_digits=["ti"] * n, box_grip_N=[1.0] * n, box_off_rad=[0.1] * n
        ),
        trial_result(n * PERIOD),
    )
    found = measured.values
    for what in ("palm", "object"):
        assert found[f"{what}_path_m"] == pytest.approx(0.05 * np.pi, rel=1e-3)
        assert found[f"{what}_efficiency"] == pytest.approx(2 / np.pi, rel=1e-3)
    assert found["placement_error_m"] == pytest.approx(0.01, abs=1e-5)
    assert found["placement_error_deg"] == pytest.approx(np.rad2deg(0.1), abs=1e-3)
    assert measured.moved == pytest.approx((0.1, -0.01), abs=1e-5)
    assert (found["grasps"], found["regrasps"], found["drops"]) == (1, 0, 0)
    assert found["first_attempt_success"] and found["first_push_s"] == PERIOD
    assert found["completion_s"] == pytest.approx(n * PERIOD)


def test_what_comes_after_the_goal_was_held_does_not_count() -> None:
    arc = half_circle(100)
    later = np.concatenate([arc, arc[::-1] + 0.3, arc])
    goal, result = arc[-1], trial_result(100 * PERIOD)
    assert measure_trial(table(later, later, goal), result) == measure_trial(
        table(arc, arc, goal), result
    )


def test_a_regrasp_or_a_drop_or_a_thing_put_back_is_no_success_at_the_first_attempt() -> None:
    n = 60
    still = np.tile([0.1, 0.1, 0.025], (n, 1))
    twice = ["ti"] * 10 + [""] * 10 + ["tm"] * 10 + [""] * (n - 30)
    lifted = np.array(still)
    lifted[20:30, 2] += 0.05
    cases: list[tuple[dict[str, Any], Array, int, tuple[int, int, int, bool]]] = [
        ({"box_digits": twice}, still, 0, (2, 1, 0, False)),
        ({"box_digits": ["t"] * n}, still, 0, (0, 0, 0, True)),
        ({"box_by": ["table"] * 29 + [""] * 4 + ["table"] * 27}, lifted, 0, (0, 0, 1, False)),
        ({}, still, 1, (0, 0, 0, False)),
        ({}, still, 0, (0, 0, 0, True)),
    ]
    for columns, box, respawned, told in cases:
        digits = columns.get("box_digits", [""] * n)
        made = table(
            still, box, still[0], **columns, box_grip_N=[1.0 if d else 0.0 for d in digits]
        )
        found = measure_trial(made, trial_result(n * PERIOD, respawned=respawned)).values
        names = ("grasps", "regrasps", "drops", "first_attempt_success")
        assert tuple(found[name] for name in names) == told


def test_nothing_is_said_about_pushes_that_are_not_known_nor_about_ways_of_things_put_back() -> (
    None
):
    still = np.tile([0.1, 0.1, 0.025], (50, 1))
    unknown = table(still, still, still[0], box_grip_N=[None] * 50)
    result = trial_result(50 * PERIOD)
    found = measure_trial(unknown, result)
    unknown_here = ("grasps", "drops", "first_push_s", "first_attempt_success")
    assert all(found.values[name] is None for name in unknown_here)
    back = np.array(still)
    back[25:, 0] += 0.2
    moved = measure_trial(table(still, back, still[0]), result).values
    assert moved["object_path_m"] == 0.0


def test_a_knob_that_is_turned_there_and_back_has_a_travel_of_both_ways() -> None:
    still = np.zeros((401, 3))
    turned = np.concatenate([np.linspace(0.0, 5.0, 301), np.linspace(5.0, 4.0, 101)[1:]])
    found = measure_trial(
        table(still, still, still[0], box_hinge_rad=turned, box_slide_m=turned / 100.0),
        trial_result(401 * PERIOD),
    ).values
    assert found["hinge_travel_deg"] == pytest.approx(np.rad2deg(6.0), abs=0.01)
    assert found["slide_travel_m"] == pytest.approx(0.06, abs=1e-4)
    for kind in ("hinge", "slide"):
        assert found[f"{kind}_efficiency"] == pytest.approx(4.0 / 6.0, abs=1e-3)


def test_a_part_that_is_put_back_makes_no_travel_by_that_and_a_still_one_has_no_efficiency() -> (
    None
):
    place, turned = np.zeros((40, 3)), np.full(40, 0.4)
    place[20:, 0], turned[20:] = 0.2, 0.0
    columns = table(place, place, place[0], box_hinge_rad=turned)
    found = measure_trial(columns, trial_result(40 * PERIOD))
    assert found.values["hinge_travel_deg"] == 0.0 and found.values["hinge_efficiency"] is None
    assert found.values["slide_travel_m"] is None


@pytest.mark.parametrize(
    ("alike", "turn", "off"),
    [(1, 3.0, 3.0), (2, 3.0, 3.0 - np.pi), (4, 1.4, 1.4 - np.pi / 2), (0, 1.0, 0.0)],
)
def test_a_thing_is_turned_by_the_nearest_turn_that_looks_the_same(
    alike: int, turn: float, off: float
) -> None:
    class Seen:
        position = np.zeros(3)
        rotation = np.array(
            [[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]]
        )

    assert yaw_error(Seen(), Goal("box", (0.0, 0.0, 0.0), 0.0), alike) == pytest.approx(off)  # type: ignore[arg-type]


def played(
    settings: Settings, look: Callable[[Session, Snapshot], object], device_labels: bool = False
) -> tuple[Session, FrameTable]:
    """A simulated trial, with its table; `look` sees the session after every step."""

    def device(drawn: Task, surface: Surface) -> SimulatedDevice:
        return SimulatedDevice(drawn, UserConfiguration(), surface, settings.seed, device_labels)

    session, frames = build(settings, (device,)), FrameTable()
    frames.watch(session)
    user: Any = session.rigs[0].device
    while not session.over:
        snapshot = session.advance()
        frames.show(snapshot)
        look(session, snapshot)
        user.show(snapshot)
    return session, frames


@pytest.mark.parametrize("task", ["stack", "wrench-slide"])
def test_who_pushes_and_bears_what_agrees_with_the_sensors_at_every_moment(task: str) -> None:
    seen = {"digits": 0, "borne": 0, "in hand": 0}
    touching: list[ContactReader] = []

    def look(session: Session, snapshot: Snapshot) -> None:
        touching[:] = touching or [ContactReader(session.scene, session.data)]
        sensing = Sensing(session.scene, session.data)
        names = [thing.name for thing in session.task.objects]
        for name, pushes in touching[0].pushes(touching[0].copy()).items():
            others = ["table", *(n for n in names if n != name)]
            assert bool(pushes.digits) == sensing.object(name).held == (pushes.grip > 0)
            assert [o for o in sorted(others) if sensing.touching(name, o)] == list(pushes.by)
            assert [o for o in sorted(others) if sensing.rests_on(name, o)] == list(pushes.on)
            seen["digits"] += len(pushes.digits) >= 2
            seen["borne"] += bool(pushes.on)
            seen["in hand"] += bool(pushes.digits) and not pushes.by

    session, _ = played(Settings(task=task, seed=25), look)
    assert session.scorer.score.success
    assert min(seen.values()) > 20


@pytest.mark.parametrize(
    ("task", "column", "travel"),
    [("dial", "hinge_rad", "hinge_travel_deg"), ("chords", "slide_m", "slide_travel_m")],
)
def test_the_table_tells_where_every_joint_is_as_tasks_sense_it(
    task: str, column: str, travel: str
) -> None:
    sensed: dict[str, list[float]] = {}

    def look(session: Session, snapshot: Snapshot) -> None:
        sensing = Sensing(session.scene, session.data)
        for part in session.task.objects:
            if isinstance(part, MechanismPart) and part.joint is not None:
                sensed.setdefault(part.name, []).append(sensing.joint(part.name).position)

    session, frames = played(Settings(task=task, seed=3), look)
    trial = TrialArrays.read(frames.data())
    told = {
        name: item.hinge if column == "hinge_rad" else item.slide
        for name, item in trial.objects.items()
    }
    assert sensed.keys() == {name for name, positions in told.items() if positions is not None}
    for part, positions in sensed.items():
        assert told[part] == pytest.approx(np.array(positions), abs=6e-6)
    found = measure_trial(trial, TrialResult.of(session)).values
    assert found[travel] > 0.0 and 0.0 < found[f"{column.partition('_')[0]}_efficiency"] <= 1.0


def test_no_label_of_a_device_is_wrong_and_those_of_a_simulated_user_are_what_it_means() -> None:
    labels: dict[int, int | None] = {}

    def look(session: Session, snapshot: Snapshot) -> None:
        labels.update({c.id: c.label for c in snapshot.hands[0].contacts if c.label is not None})

    settings = Settings().changed(task="box-to-goal", seed=3, labels="device")
    session, frames = played(settings, look, device_labels=True)
    user: Any = session.rigs[0].device
    assert labels and labels == {contact: user.true_labels[contact] for contact in labels}
    told = measure_trial(TrialArrays.read(frames.data()), TrialResult.of(session)).values
    assert (told["label_truth"], told["label_accuracy"], told["label_errors"]) == ("device", 1.0, 0)


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    found = open_study(tmp_path_factory.mktemp("measures"))
    run_simulated(found, 1, quiet)
    return found


def row_of(study: StudyFolder, trial: str) -> dict[str, str]:
    rows = rows_of(study.path / "tables/trials.csv")
    return next(row for row in rows if row["trial"] == trial)


def test_frames_that_are_missing_are_made_again_with_the_measures_of_before(
    study: StudyFolder,
) -> None:
    recording = first_session(study) / "trials/T002.jsonl"
    path = frames_of(recording)
    before, row = path.read_bytes(), row_of(study, "2")
    trial = read_frames(recording)
    by_frames = [m.name for m in MEASURES if m.by_frames and row.get(m.name)]
    assert trial is not None and len(trial) > 10 and "drops" in by_frames
    path.write_bytes(before[:100])
    assert read_frames(recording) is None
    said: list[str] = []
    make_tables(study, said.append)
    assert not any(row_of(study, "2").get(name) for name in by_frames)
    assert any("damaged" in line for line in said)
    path.unlink()
    make_tables(study)
    assert path.read_bytes() == before and row_of(study, "2") == row
    path.unlink()
    assert make_frames(recording) == "" and path.read_bytes() == before


NAMES = st.text(st.characters(exclude_categories=["Cc", "Cs"]), min_size=1, max_size=8)


@given(names=st.lists(NAMES, min_size=1, max_size=4, unique=True))
@example(names=["red, box_x", 'a "die"_y'])
def test_frames_are_read_as_they_were_written_whatever_the_objects_are_called(
    names: list[str],
) -> None:
    class Named(FrameTable):
        def columns(self) -> dict[str, Any]:
            found: dict[str, Any] = {"time_s": [0.016, 0.032]}
            for name in names:
                found |= {f"{name}_{part}": np.array([0.5, 0.25]) for part in ("x", "y", "z", "qw")}
            return found

    trial = TrialArrays.read(Named().data())
    assert list(trial.objects) == names and trial.t == pytest.approx([0.016, 0.032])
    for item in trial.objects.values():
        assert item.place == pytest.approx(np.array([[0.5] * 3, [0.25] * 3])) and item.goal is None
