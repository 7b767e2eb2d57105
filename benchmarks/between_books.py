"""A task in which pose might decide, and does not: reaching in between two standing books.

    python -m benchmarks.between_books [--seeds 7000:7014] [--gaps 140 115 100]
    python -m benchmarks.between_books --palms

A box is pushed to its goal between two paperbacks that stand on the table, by a hand that follows
it in, its wrist turned. Mean pose and what ships are compared, with the whole hand solid. `--palms`
prints where both put the palm around the same touches before it is led away from things. The task
is not part of the program.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import cos, pi, radians, sin
from statistics import mean
from typing import ClassVar

import mujoco
import numpy as np

from benchmarks.machine import describe_machine
from benchmarks.methods import METHODS, SHIPS, Played, difference, interval
from benchmarks.success import wilson
from encoders.reconstruction.touch_reconstructor import TouchReconstructor
from models.arithmetic.arrays import Array
from models.arithmetic.products import distance, length
from models.errors import SurfaceTooSmallError
from models.frames import Contact, TouchFrame
from models.hand import Hand
from models.objects import Box
from models.scene import CONTROL_PERIOD, Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.trial.assembly import (
    load_encoder,
    make_labeller,
    place_surface,
    reconstructor_settings,
)
from sandbox.trial.headless import run_trial
from tasks.box_to_goal import BORDER, POSITION_TOLERANCE, missing
from tasks.score import Status, points
from tasks.sensing import Sensing
from tasks.simulated_user.grasp import Grasp, grasp_across, wrapped
from tasks.simulated_user.hand import Hand as PersonsHand
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import SeenObject, Sight, UserConfiguration, UserMaker

BOOK, BOOK_MASS = (0.110, 0.020, 0.178), 0.200
"""m and kg, a paperback of 350 pages, standing: 110 x 178 mm is a usual format. It falls when it
is tilted sideways by 6 degrees."""
EDGE, MASS = 0.040, 0.100
"""m and kg, of the box."""
WAY = 0.060
"""m from start to goal, into the gap."""
BEHIND = 0.100
"""m from the goal back to the near ends of the books: the palm begins outside."""
GAP = 0.140
"""m between the books: the palm of what ships fits in. A hand with its thumb is 105 mm wide."""
TURNED = (30.0, 45.0)
"""degrees by which the wrist is turned to the left of its comfortable direction: there the two
palms are farthest apart."""
ASIDE = 0.008
"""m to the left of the box, by which the middle of the gap is off: what ships puts the palm there,
on average over turns of the wrist."""
POINTS = pi / 4
"""rad from the direction across the box, thumb to fingers, to that in which the hand points; of
what ships."""
MOVED, FALLEN = 0.010, radians(30.0)
"""m and rad, from which on a book has been moved, and has fallen."""
_STEP = 0.030
"""m that the user pushes before the next look."""
_TRIES = 20_000


class _AlongHandling(BoxHandling):
    """Handling of a box whose faces are chosen so that the hand points into the gap.

    Attributes:
        into: rad, direction into the gap.
    """

    into = 0.0

    def grasp(
        self, seen: SeenObject, turn: float, hand: PersonsHand, failed: Grasp | None = None
    ) -> Grasp:
        assert isinstance(seen.shape, Box)
        half = seen.shape.half_size
        axes = [seen.yaw + quarter * pi / 2 for quarter in range(4)]
        axis = min(axes, key=lambda a: abs(wrapped(a - self.into + POINTS)))
        return replace(grasp_across(axis, 2 * half[0], 2 * half[1], hand), skew=0.0)


class BooksUser(SkilledUser):
    """Pushes the box in, in steps, pointing into the gap."""

    drags = 12

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._along: _AlongHandling | None = None

    def _act(self, sight: Sight, now: float) -> None:
        if self._along is None:
            (goal,) = sight.goals
            x, y = np.array(goal.position[:2]) - sight.objects[goal.object].position[:2]
            self._handling = self._along = _AlongHandling()
            self._along.into = float(np.arctan2(y, x))
        super()._act(sight, now)

    def _leg(self, sight: Sight, box: SeenObject, off: Array, turn: float) -> tuple[Array, float]:
        return off * min(1.0, _STEP / max(length(off), 1e-9)), turn


@dataclass(frozen=True)
class BetweenBooks(TaskDefaults):
    """Push the box to its goal between the books; none may be moved by 1 cm or fall."""

    name: ClassVar[str] = "between-books"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 30.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.022
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    user: ClassVar[UserMaker | None] = BooksUser
    seed: int
    objects: tuple[Box, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> BetweenBooks:
        """Draws the trial of a seed."""
        rng = np.random.default_rng([seed, cls.version, 47])
        comfort = UserConfiguration().natural_axis_of_row
        for _ in range(_TRIES):
            goal = np.asarray(surface.to_world(rng.uniform((0.0, 0.0), surface.size)))[:2]
            turned = radians(float(rng.uniform(*TURNED)))
            yaw = comfort + turned
            into, _ = _directions(yaw)
            start = goal - WAY * into
            books = [_book(goal, yaw, side * GAP) for side in (0.5, -0.5)]
            if _inside([goal, start], BORDER, surface) and _inside(books, 0.0, surface):
                break
        else:
            size = (surface.width_in, surface.height_in)
            raise SurfaceTooSmallError(cls.name, size, "two books", (7.8, 5.9))
        half = EDGE / 2
        box = Box("box", (half, half, half), MASS, (*start.tolist(), half), yaw)
        walls = tuple(
            Box(
                f"book{number}",
                (BOOK[0] / 2, BOOK[1] / 2, BOOK[2] / 2),
                BOOK_MASS,
                (*book.tolist(), BOOK[2] / 2),
                yaw + POINTS,
                (0.34, 0.71, 0.91),
            )
            for number, book in enumerate(books)
        )
        return cls(seed, (box, *walls), (Goal("box", (*goal.tolist(), half), yaw),))

    def with_room(self, factor: float) -> BetweenBooks:
        """The same trial with so much more or less room between the books."""
        goal = self.goals[0]
        moved = [
            replace(book, position=(*place.tolist(), BOOK[2] / 2))
            for book, side in zip(self.objects[1:], (0.5, -0.5), strict=True)
            for place in [_book(np.array(goal.position[:2]), goal.yaw, side * factor * GAP)]
        ]
        return replace(self, objects=(self.objects[0], *moved))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the box is at its goal now, and both books stand where they stood."""
        box, goal = sensing.object("box"), self.goals[0]
        books = [(sensing.object(book.name), book) for book in self.objects[1:]]
        lost = max(book.tilt for book, _ in books) > FALLEN
        moved = max(length(book.position - np.array(was.position)) for book, was in books)
        reason: str = missing(box, goal)
        if lost or moved > MOVED:
            reason = "a book has fallen" if lost else "a book has been moved"
        off = distance(box.position.tolist(), goal.position)
        travelled = 1.0 - max(off - POSITION_TOLERANCE, 0.0) / (WAY - POSITION_TOLERANCE)
        progress = 1.0 if not reason else min(max(travelled, 0.0), 0.99)
        return Measure(not reason, progress, reason, lost)


def _directions(yaw: float) -> tuple[Array, Array]:
    """Unit vectors (2,), (2,) into the gap and to its right, of a box of that yaw."""
    into = np.array([cos(yaw + POINTS), sin(yaw + POINTS)])
    return into, np.array([into[1], -into[0]])


def _book(goal: Array, yaw: float, aside: float) -> Array:
    """Place (2,) m of a book whose inner face is so far to the right of the gap's middle."""
    into, right = _directions(yaw)
    out = aside + float(np.copysign(BOOK[1] / 2, aside)) - ASIDE
    return np.asarray(goal + (BOOK[0] / 2 - BEHIND) * into + out * right)


def _inside(places: Iterable[Array], border: float, surface: Surface) -> bool:
    """True if places (2,) m in the world are so far from the surface's border."""
    at = np.array([[*place, surface.origin[2]] for place in places])
    on = surface.to_surface(at)
    return bool(np.all(on >= border) and np.all(on <= surface.size - border))


def play(method: str, gap: float, seed: int) -> Played:
    """Plays one trial with the whole hand solid.

    Args:
        method: One of `METHODS`.
        gap: m between the books.
        seed: Seed of the trial.
    """
    options = {"solid": "hand", "vary": f"room={gap / GAP:.6g}", **METHODS[method]}
    place = f"{__file__}:{BetweenBooks.__name__}"
    chosen = plan(SceneOptions(task=place, seed=seed, **options))
    done = run_trial(chosen.settings, chosen.makers, about=chosen.about)
    score = points(done.success, done.progress, done.time_s, BetweenBooks.time_limit)
    fell = done.status is Status.FAILED
    return Played(done.success, score, done.time_s, fell, done.respawned, 0.0)


def rows(seeds: range, gaps: list[float]) -> Iterable[str]:
    """The table of methods, a line for each gap."""
    heads = ["gap, mm"]
    for method in ("mean pose", SHIPS):
        heads += [f"{method}: success [95 %]", "points [95 %]", "books fell"]
    yield "| " + " | ".join([*heads, "points more of mean pose [95 %]"]) + " |"
    yield "| --- " * (len(heads) + 1) + "|"
    for gap in gaps:
        cells, plays = [f"{gap:g}"], {}
        for method in ("mean pose", SHIPS):
            plays[method] = [play(method, gap / 1000, seed) for seed in seeds]
            won = sum(one.success for one in plays[method])
            low, high = wilson(won, len(seeds))
            scores = [one.points for one in plays[method]]
            least, most = interval(scores)
            cells += [
                f"{won}/{len(seeds)} [{low:.0f}, {high:.0f}]",
                f"{mean(scores):.0f} [{least:.0f}, {most:.0f}]",
                str(sum(one.toppled for one in plays[method])),
            ]
        apart = difference(plays["mean pose"], plays[SHIPS])
        cells.append(f"{apart.points:+.1f} [{apart.low:+.1f}, {apart.high:+.1f}]")
        yield "| " + " | ".join(cells) + " |"


def palm(method: str, turned: float, person: int) -> Array:
    """Middle of the palm (3,) mm, from the middle of a pinch of three fingers around the box: along
    the pinch, thumb to fingers, to the right of it, and up; with true names, and before it is led
    away from anything.

    Args:
        method: One of `METHODS`.
        turned: degrees by which the wrist is turned from its comfortable direction.
        person: Seed of the hand.
    """
    surface = place_surface(Surface(), BetweenBooks)
    options = {"tell_labels": True, **METHODS[method]}
    settings = plan(SceneOptions(task="box-to-goal", seed=1, **options)).settings
    model = load_encoder(settings.encoder)
    labeller = make_labeller(settings, model)
    hand = TouchReconstructor(model, labeller, ADULT, surface, reconstructor_settings(settings))
    own = PersonsHand.draw(UserConfiguration(), person)
    axis = own.natural_axis + radians(turned)
    middle = surface.to_world(surface.size / 2)
    grasp = replace(grasp_across(axis, EDGE, EDGE, own), skew=0.0)
    places = grasp.places(middle[:2], 0.0, own)
    xy = surface.to_surface(np.column_stack([places, np.full(len(places), middle[2])])).tolist()
    for step in range(90):
        contacts = tuple(Contact(i, x, y, label=i) for i, (x, y) in enumerate(xy))
        last = hand.step(TouchFrame(step * CONTROL_PERIOD, contacts, source="a pinch"))
    scene = Scene(SceneSpec((Hand(solid_palm=True),), ()))
    data = mujoco.MjData(scene.model)
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, last.q)
    mujoco.mj_kinematics(scene.model, data)
    body = scene.model.body(scene.spec.hands[0].palm).id
    palms = [geom for geom in scene.parts(0) if scene.model.geom_bodyid[geom] == body]
    off = data.geom_xpos[palms].mean(axis=0) - middle
    c, s = cos(axis), sin(axis)
    return 1000 * np.array([c * off[0] + s * off[1], s * off[0] - c * off[1], off[2]])


def palms(people: range) -> Iterable[str]:
    """The table of palms, a line for each turn of the wrist; means over people."""
    yield "| wrist turned by, degrees | mean pose: along, right, up, mm | what ships | apart, mm |"
    yield "| --- " * 4 + "|"
    for turned in (-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0):
        one, other = (
            np.mean([palm(method, turned, person) for person in people], axis=0)
            for method in ("mean pose", SHIPS)
        )
        texts = [", ".join(f"{value:.0f}" for value in values) for values in (one, other)]
        yield f"| {turned:g} | {texts[0]} | {texts[1]} | {length(one - other):.0f} |"


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", default="7000:7014", help="first and last but one training seed")
    parser.add_argument(
        "--gaps", nargs="+", type=float, default=[140.0, 115.0, 100.0, 90.0], help="mm"
    )
    parser.add_argument("--palms", action="store_true", help="where palms are, and nothing else")
    options = parser.parse_args()
    print(describe_machine())
    first, end = map(int, options.seeds.split(":"))
    for line in palms(range(3)) if options.palms else rows(range(first, end), options.gaps):
        print(line, flush=True)


if __name__ == "__main__":
    main()
