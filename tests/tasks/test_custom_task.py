"""A lab's own task, in a file or in an installed package, is drawn, played and found like ours."""

from __future__ import annotations

import itertools
import json
import sys
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, NoReturn, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import InputError, RecordingError
from models.mechanism import Mechanism
from models.objects import Box, Wrench
from models.scene import PaintedRing
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.library.trial_run import run_trial
from sandbox.recording.recording import load_recording
from sandbox.recording.versions import STATES
from sandbox.regression import Regression
from sandbox.trial.assembly import build
from sandbox.trial.replay import settings_of
from sandbox.trial.settings import Settings, encoded
from tasks import variation
from tasks.custom_task import CustomTask, judge, two_places
from tasks.guarded import draw_task
from tasks.registry import TASKS, find_task, origin
from tasks.score import measure
from tasks.sensing import Sensing
from tasks.task import Goal, Measure
from tasks.task_checks import check_task
from tests.support.processes import ROOT
from tests.support.scripted import Script

pytest_plugins = ["sandbox.regression"]

MUG = ROOT / "examples" / "push_the_mug.py"
SURFACE = Surface().centred_at((0.0, 0.0, 0.015))


class Slide(CustomTask):
    name = "test-slide"

    @classmethod
    def place(cls, rng: np.random.Generator, surface: Surface) -> tuple[list[Box], list[Goal]]:
        start, end = two_places(rng, surface)
        box = Box("it", (0.02, 0.02, 0.02), 0.1, (start[0], start[1], 0.02))
        return [box], [Goal("it", (end[0], end[1], 0.02), 0.0)]

    def measure(self, sensing: Sensing) -> Measure:
        return judge(0.5, (True, "never"))


def test_another_seed_version_or_name_is_another_trial() -> None:
    class Second(Slide):
        version = 2

    class Renamed(Slide):
        name = "test-slide-too"

    kinds = ((Slide, 3), (Slide, 3), (Slide, 4), (Second, 3), (Renamed, 3))
    starts = [draw_task(kind, seed, SURFACE).objects[0].position for kind, seed in kinds]
    assert starts[0] == starts[1] and len(set(starts)) == 4


@given(seed=st.integers(0, 10_000))
def test_two_places_keep_their_distance_from_each_other_and_from_the_border(seed: int) -> None:
    a, b = two_places(np.random.default_rng(seed), SURFACE, (0.05, 0.06), 0.03)
    assert 0.05 <= np.linalg.norm(a - b) <= 0.06
    assert a[2] == b[2] == 0.0
    for place in (a, b):
        xy = SURFACE.to_surface(place)
        assert np.all(xy >= 0.03 - 1e-9) and np.all(xy <= SURFACE.size - 0.03 + 1e-9)


def test_the_first_missing_condition_is_reported_and_only_success_has_progress_one() -> None:
    assert judge(2.0, (False, "a"), (True, "b"), (True, "c")).reason == "b"
    assert judge(2.0, (True, "b")).progress < 1.0
    assert judge(-1.0, (True, "b")).progress == 0.0
    assert judge(0.2, (False, "b")).reached and judge(0.2).progress == 1.0
    untold = judge(0.5, (True, ""), (True, "far"))
    assert not untold.reached and untold.reason == "far"
    assert not judge(0.5, (True, "")).reached


def test_two_places_on_an_upright_surface_are_refused() -> None:
    with pytest.raises(InputError, match="this surface is upright"):
        two_places(np.random.default_rng(1), Surface().placed_upright(0.006, -0.015))


def broken(**parts: Any) -> type[Slide]:
    return type("Broken", (Slide,), {"name": "test-broken", **parts})


def fails(cls: type[Slide], rng: np.random.Generator, surface: Surface) -> NoReturn:
    raise ZeroDivisionError("a lab's own bug")


COUNTER = itertools.count()
DESK = '<mujoco><worldbody><body><geom size=".01"/></body></worldbody></mujoco>'
BOX = Box("it", (0.02, 0.02, 0.02), 0.1, (0.0, 0.0, 0.02))
GOAL = Goal("it", (0.0, 0.0, 0.02), 0.0)
TYPED_WRONG: Any = replace
"""`replace` for values of other types than an object's."""


@pytest.mark.parametrize(
    "place",
    [
        fails,
        lambda cls, rng, surface: 5,
        lambda cls, rng, surface: ([], []),
        lambda cls, rng, surface: ([BOX, BOX], []),
        lambda cls, rng, surface: ([BOX], [Goal("that", (0, 0, 0), 0)]),
        lambda cls, rng, surface: ([BOX], [Goal("it", (x, 0, 0.02), 0) for x in (0.05, -0.05)]),
        lambda cls, rng, surface: ([BOX], [Goal("it", (0, 0.2, 0.02), 0)]),
        lambda cls, rng, surface: ([BOX], [Goal("it", (0, 0, np.nan), 0)]),
        lambda cls, rng, surface: ([BOX], [TYPED_WRONG(GOAL, position=(0.05, 0))]),
        lambda cls, rng, surface: ([BOX], [TYPED_WRONG(GOAL, object=5)]),
        lambda cls, rng, surface: ([BOX], [None]),
        lambda cls, rng, surface: ([BOX], GOAL),
        lambda cls, rng, surface: ([GOAL], [BOX]),
        lambda cls, rng, surface: ([BOX, replace(BOX, name="other")], []),
        lambda cls, rng, surface: ([replace(BOX, name="world")], []),
        lambda cls, rng, surface: ([replace(BOX, name="left_palm")], []),
        lambda cls, rng, surface: ([replace(BOX, position=(0.0, 0.0, 0.01))], []),
        lambda cls, rng, surface: ([replace(BOX, position=(0.3, 0.0, 0.02))], []),
        lambda cls, rng, surface: ([replace(BOX, half_size=(0.02, 0.0, 0.02))], []),
        lambda cls, rng, surface: (
            [replace(BOX, half_size=(20.0,) * 3, position=(0, 0, 20.0))],
            [],
        ),
        lambda cls, rng, surface: ([replace(BOX, mass=np.nan)], []),
        lambda cls, rng, surface: ([replace(BOX, friction=-1.0)], []),
        lambda cls, rng, surface: ([replace(BOX, mass=0.1 + 0.01 * next(COUNTER))], []),
        lambda cls, rng, surface: ([TYPED_WRONG(BOX, position="here")], []),
        lambda cls, rng, surface: ([TYPED_WRONG(BOX, name=5)], []),
        lambda cls, rng, surface: ([TYPED_WRONG(BOX, mass="0.1")], []),
        lambda cls, rng, surface: ([TYPED_WRONG(BOX, rgb="red")], []),
        lambda cls, rng, surface: ([Wrench("it", 0.1, (0.0, 0.0, 0.012), bolt=-1.0)], []),
        lambda cls, rng, surface: ([Wrench("it", 0.1, (0, 0, 0.02), size=float("nan"))], []),
        lambda cls, rng, surface: (Mechanism("desk", DESK), []),
        lambda cls, rng, surface: ([BOX, Mechanism("desk", DESK)], []),
        lambda cls, rng, surface: two_places(rng, surface, (9.0, 9.5)),
    ],
)
def test_what_is_wrong_with_a_trial_is_one_line_for_its_author(
    place: Callable[[type[Slide], np.random.Generator, Surface], object],
) -> None:
    with pytest.raises(InputError) as error:
        check_task(broken(place=classmethod(place)), [0])
    assert "\n" not in str(error.value)


def chest(drawer: float, height: float, base: float = 0.0) -> Mechanism:
    """A drawer on a slab: m of their lower sides above the origin, which is at a height."""
    mjcf = f"""<mujoco><worldbody><body>
      <geom type="box" size=".02 .02 .002" pos="0 0 {base + 0.002}"/>
      <body name="drawer" pos="0 0 {drawer}"><joint type="slide" axis="0 -1 0" range="0 0.02"/>
        <geom type="box" size=".02 .02 .01" pos="0 0 .01"/></body>
    </body></worldbody></mujoco>"""
    return Mechanism("chest", mjcf, (0.0, 0.0, height), 0.4)


@pytest.mark.parametrize(
    ("places", "pressed", "refused"),
    [
        ((0.004, 0.0), False, False),
        ((0.004, -0.0009), False, False),
        ((0.004, -0.03), True, False),
        ((0.004, -0.03), False, True),
        # What the description itself has below its origin is on purpose.
        ((-0.02, 0.0), False, False),
        ((-0.02, 0.01), False, False),
        ((-0.02, -0.01), False, True),
        # All of it is above its origin, which may be low.
        ((0.054, -0.05, 0.05), False, False),
    ],
)
def test_a_mechanism_reaches_into_the_table_only_where_it_is_pressed_or_described_so(
    places: tuple[float, ...], pressed: bool, refused: bool
) -> None:
    placed = chest(*places)
    task = broken(place=classmethod(lambda *_: (placed.parts, [])), pressed=pressed)
    if refused:
        with pytest.raises(InputError, match=r"30\.0 mm deep"):
            draw_task(task, 0, SURFACE)
        return
    check_task(task, [0])
    assert draw_task(task, 0, SURFACE).objects == placed.parts


def test_objects_that_just_touch_do_not_overlap() -> None:
    boxes = [BOX, replace(BOX, name="other", position=(0.0, 0.0, 0.06))]
    check_task(broken(place=classmethod(lambda *_: (boxes, []))), [0])


@pytest.mark.parametrize(
    "place",
    [
        fails,
        lambda cls, rng, surface: ([BOX], [Goal("it", (0, 0, np.nan), 0)]),
        lambda cls, rng, surface: ([replace(BOX, name="right_palm")], []),
    ],
)
def test_a_trial_that_cannot_be_played_is_refused_in_one_line_when_it_is_built(
    place: Callable[[type[Slide], np.random.Generator, Surface], object],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(TASKS, "test-broken", broken(place=classmethod(place)))
    with pytest.raises(InputError, match="test-broken, seed 0") as error:
        build(Settings(task="test-broken"), (lambda task, surface: Script(),))
    assert "\n" not in str(error.value)


def test_a_measure_that_moves_something_is_found_by_its_author() -> None:
    def measure(self: Slide, sensing: Any) -> Measure:
        sensing._data.qpos[0] += 0.01
        return judge(0.5, (True, "never"))

    with pytest.raises(InputError, match="`measure` changes the simulation"):
        check_task(broken(measure=measure))


@pytest.mark.parametrize("file", ["open_the_drawer.py", "push_the_mug.py", "push_the_puck.py"])
def test_every_task_of_the_examples_keeps_to_the_rules(file: str) -> None:
    check_task(str(ROOT / "examples" / file), range(3))


@pytest.mark.parametrize(
    "measure",
    [
        lambda self, sensing: None,
        lambda self, sensing: sys.exit(0),
        lambda self, sensing: 1 / 0,
        lambda self, sensing: sensing.object("mug"),
        lambda self, sensing: sensing.touching("it", "mug"),
    ],
)
def test_a_task_whose_measure_returns_no_measure_is_refused_before_the_trial(
    measure: Callable[[Slide, Sensing], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(TASKS, "test-broken", broken(measure=measure))
    closed = []

    class Closes(Script):
        def close(self) -> None:
            closed.append(self)

    with pytest.raises(InputError) as error:
        build(Settings(task="test-broken"), (lambda task, surface: Closes(),))
    assert "\n" not in str(error.value) and len(closed) == 1


def test_a_user_whose_touch_returns_nothing_is_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    body = """
class Nobody:
    def __init__(self, configuration, surface, seed): pass
    def observe(self, sight): pass
    def touch(self, now): pass
class A(Slide):
    name = 'lab-a'
    user = Nobody
"""
    assert main(["run", str(write(tmp_path / "lab.py", body))]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    ("parts", "vary"),
    [
        ({"with_room": lambda self, factor: None}, {"room": 0.5}),
        ({"with_room": lambda self, factor: 1 / 0}, {"room": 0.5}),
        ({"shifted": lambda self: None}, {"start": 0.01}),
    ],
)
def test_what_fails_in_a_task_that_is_varied_is_told_in_one_line(
    parts: dict[str, Any], vary: dict[str, float]
) -> None:
    task = draw_task(broken(**parts), 4, SURFACE)
    with pytest.raises(InputError, match="test-broken, seed 4: the task cannot be varied") as error:
        variation.vary(task, variation.Variation(**vary), SURFACE)
    assert "\n" not in str(error.value)


def write(path: Path, body: str) -> Path:
    path.write_text("from tests.tasks.test_custom_task import Slide\n" + body)
    return path


@pytest.mark.parametrize(
    "body",
    [
        "1/0",
        "def",
        "",
        "class A(Slide): name = 'a'\nclass B(Slide): name = 'b'",
        "class A(Slide): name = 'box-to-goal'",
        "class A(Slide): name = 'Too Nice'",
        "class A(Slide): name = 'a'; hold_time = 'long'",
        "class A(Slide): name = 'a'; table_friction = float('inf')",
        "class A(Slide): name = 'a'; time_limit = 0",
        "class A(Slide): name = 'a'; hold_time = 500",
        "class A(Slide): name = 'a'; hands = '2'",
        "class A(Slide): name = 'a'; hands = 0",
        "class A(Slide): name = 'a'; touch_height = -0.01",
        "class A(Slide): name = 'a'; plane = 'ceiling'",
        "class A(Slide): name = 'a'; user = 'me'",
        "from tasks.custom_task import CustomTask\nclass A(CustomTask): name = 'a'",
        "def make():\n    class Local(Slide): name = 'a'\n    return Local",
    ],
)
def test_a_file_without_a_valid_task_is_refused_with_a_one_line_error(
    tmp_path: Path, body: str
) -> None:
    with pytest.raises(InputError) as error:
        find_task(str(write(tmp_path / "lab.py", body)))
    assert "\n" not in str(error.value)


def test_a_file_can_import_modules_from_its_own_folder(tmp_path: Path) -> None:
    for folder, size in (("one", 0.01), ("two", 0.02)):
        (tmp_path / folder / "parts").mkdir(parents=True)
        (tmp_path / folder / "shapes_of_a_lab.py").write_text(f"SIZE = {size}\n")
        (tmp_path / folder / "parts" / "__init__.py").write_text("from parts.names import NAME\n")
        (tmp_path / folder / "parts" / "names.py").write_text(f"NAME = 'lab-{folder}'\n")
        write(
            tmp_path / folder / "lab.py",
            "import shapes_of_a_lab\nfrom parts import NAME\n"
            "class A(Slide):\n    name = NAME\n    hold_time = shapes_of_a_lab.SIZE\n",
        )
    path = list(sys.path)
    for folder, size in (("one", 0.01), ("two", 0.02)):
        kind = find_task(str(tmp_path / folder / "lab.py"))
        assert (kind.name, kind.hold_time) == (f"lab-{folder}", size)
    assert sys.path == path


def test_tasks_are_found_by_module_and_class_as_well(tmp_path: Path) -> None:
    path = write(tmp_path / "lab.py", "class A(Slide): name = 'a'\nclass B(Slide): name = 'b'")
    assert find_task(f"{path}:B").name == "b"
    assert origin(f"{path}:B") == {"file": str(path), "member": "B", "task_version": 1}
    assert find_task("tests.support.regress_tasks:Quick").name == "quick"
    assert all(origin(name) == {} for name in TASKS)
    for wrong in (f"{path}:C", tmp_path / "other.py", tmp_path / "no" / "lab.py", "long" * 100):
        with pytest.raises(InputError):
            find_task(str(wrong))


@pytest.mark.parametrize("here", [".", "examples", "sandbox"])
def test_without_a_touch_the_example_is_not_done_and_its_command_names_the_file(
    regression: Regression, monkeypatch: pytest.MonkeyPatch, here: str
) -> None:
    monkeypatch.chdir(ROOT / here)
    report = regression(str(MUG), "0:2", user="idle")
    assert [t["success"] for t in report.trials] == [False, False]
    assert {t["task"] for t in report.trials} == {"my-lab-push-the-mug"}
    command = report.command(report.trials[0]).split()
    assert command[:2] == ["sandbox", "run"]
    assert Path(command[2]).resolve() == MUG.resolve()


def test_a_recording_of_another_version_of_its_task_is_refused(tmp_path: Path) -> None:
    path, task = tmp_path / "run.jsonl", "tests.support.regress_tasks:Quick"
    header = {"kind": "header", "schema": 2, "states": STATES}
    header |= {"settings": encoded(Settings(task=task))}
    header |= {"task_from": {"entry_point": task, "task_version": 7}}
    path.write_text(json.dumps(header) + "\n")
    with pytest.raises(RecordingError, match="version 1 of the task, not 7"):
        settings_of(load_recording(path))


@pytest.mark.parametrize("turn", [0, 180])
@pytest.mark.parametrize("file", ["open_the_drawer.py", "push_the_mug.py", "push_the_puck.py"])
def test_tasks_of_the_examples_are_played_with_the_left_hand_at_any_side(
    file: str, turn: int
) -> None:
    """A user with nothing but the two methods of the contract broke here."""
    result = run_trial(str(ROOT / "examples" / file), seed=3, hand="left", turn=turn)
    assert result.success or turn  # A drawer does not turn with the person.


def measuring(*values: Any) -> Measure:
    task = draw_task(broken(measure=lambda self, sensing: Measure(*values)), 0, SURFACE)
    return measure(task, cast(Sensing, None))


def test_a_measure_in_numbers_of_numpy_becomes_python_s_own() -> None:
    first = Measure(*cast(Any, (np.False_, np.float32(0.25), "first", np.False_)))
    found = measuring(np.True_, np.float64(0.5), "then", np.False_, first)
    assert found == Measure(True, 0.5, "then", False, Measure(False, 0.25, "first"))
    assert json.loads(json.dumps(asdict(found)))["first"]["progress"] == 0.25


@given(st.floats(-1e9, 1e9))
def test_progress_of_any_task_is_from_0_to_1(progress: float) -> None:
    found = measuring(False, progress, "", False, Measure(False, progress, ""))
    assert 0.0 <= found.progress <= 1.0 and found.first is not None
    assert found.progress == found.first.progress == min(max(progress, 0.0), 1.0)


@pytest.mark.parametrize(
    "painted",
    [
        PaintedRing("ring", (0.0, 0.0), 0.04),
        (PaintedRing("ring", (np.nan, 0.0), 0.04),),
        (PaintedRing("ring", (0.0, 0.0), -0.04),),
        property(lambda self: 1 / 0),
        property(lambda self: (PaintedRing("ring", (0.001 * next(COUNTER), 0.0), 0.04),)),
    ],
)
def test_a_ring_that_cannot_be_painted_is_refused(painted: Any) -> None:
    with pytest.raises(InputError):
        check_task(broken(painted=painted), [0])


@pytest.mark.parametrize(
    "values",
    [
        (False, np.nan, ""),
        (False, np.inf, ""),
        (False, None, ""),
        (False, 0.0, None),
        (np.array([True, False]), 0.0, ""),
        (False, 0.0, "", False, 5),
        (False, 0.0, "", False, Measure(False, np.nan, "")),
    ],
)
def test_a_measure_that_no_file_could_keep_is_refused_in_one_line(values: tuple[Any, ...]) -> None:
    with pytest.raises(InputError) as error:
        measuring(*values)
    assert "\n" not in str(error.value)
