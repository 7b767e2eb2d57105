"""Compares methods that turn touches into a hand pose with the default method, in every task.

    python -m benchmarks.methods --seeds 7000:7150 --out out/methods.jsonl
    python -m benchmarks.methods --tasks insert slalom --methods "mean pose" --seeds 7000:7010
    python -m benchmarks.methods --table out/methods.jsonl [MORE.jsonl ...] --plot methods.svg

The trials are of the simulated user on training seeds. "what ships" is the default method. "mean
pose", "linear", "quadratic", "cubic" and "pca-ik" differ from it in the encoder, and "true labels"
in the labels of fingers. "no correction", "no filter" and "the paper's labels" change one of the
other three parts. "bare" is the default with the paper's labels and without correction and filter.
"the paper's" also has the paper's encoder. These two still have our rules of arrival.

The columns are: success with its Wilson interval; points of `tasks.score.points` with a t interval
of their mean; median time of successes; number of trials that ended early, since an object was
toppled, pushed away or overtightened; number of objects that left the surface and were put back;
largest force (N) of palm and free fingers on objects, as median and largest value of the trials.

Every method is compared with the default on the seeds that both have played, by exact McNemar tests
of success and Wilcoxon signed-rank tests of points, two-sided, with Holm over all of them. Trials
are saved as they end, so that a run can be stopped and resumed.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import sqrt
from pathlib import Path
from statistics import mean, median, stdev
from typing import TYPE_CHECKING, Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest, t, wilcoxon

from benchmarks.kept_trials import KeptTrials
from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from sandbox.figures.charts import COLOURS, FAINT, STYLE, figure, need_matplotlib
from sandbox.regress.run_plan import parse_seeds
from sandbox.regress.statistics import holm, wilson
from sandbox.session.session import Session
from sandbox.trial.assembly import device_makers
from sandbox.trial.driver import ViewMaker, play_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import TASKS, find_task
from tasks.score import Status, points

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHIPS = "what ships"
METHODS: dict[str, dict[str, Any]] = {
    "mean pose": {"encode": False},
    "linear": {"encoder": "linear"},
    "quadratic": {"encoder": "quadratic"},
    "cubic": {"encoder": "cubic"},
    SHIPS: {},
    "true labels": {"labels": "device"},
    "no correction": {"correction": False},
    "no filter": {"smoothing": False},
    "the paper's labels": {"labels": "paper"},
    "pca-ik": {"encoder": "pca-ik"},
    "bare": {"bare": True},
    "the paper's": {"encoder": "paper"},
}
"""Name of a method -> options of its trials."""

FAR = ("bare", "the paper's")
"""Methods that differ so much from the default that their panels have another scale."""

SOLID = ("fingertips", "hand")


class Pushes:
    """A view that reads the unintended forces of a session.

    These are forces between an object and the palm or a finger that does not touch, at the end of
    every control period.

    Args:
        session: The session.

    Attributes:
        largest: Largest force (N) so far.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        model, spec = session.scene.model, session.scene.spec
        self._part = np.full(model.ngeom, -1)
        self._finger = np.full(model.ngeom, -1)
        for i, hand in enumerate(spec.hands):
            self._part[session.scene.parts(i)] = i
            for link in hand.links:
                for name in (link.geom, link.tip_geom):
                    self._finger[model.geom(name).id] = link.finger
        of_things = model.geom_contype & 2
        self._thing: NDArray[np.bool_] = (of_things > 0) & (self._part < 0)
        self.largest = 0.0

    def __call__(self, snapshot: object) -> None:
        """Reads the state after a control period."""
        session = self._session
        model, data = session.scene.model, session.data
        touching = [r.fingers for r in session.reconstructions]
        force = np.zeros(6)
        for k, (a, b) in enumerate(data.contact.geom.tolist()):
            part, thing = (a, b) if self._part[a] >= 0 else (b, a)
            hand = int(self._part[part])
            touches = int(self._finger[part]) in touching[hand]
            if hand < 0 or touches or not self._thing[thing]:
                continue
            mujoco.mj_contactForce(model, data, k, force)
            self.largest = max(self.largest, float(np.linalg.norm(force[:3])))


class Job(NamedTuple):
    """A trial to be played."""

    task: str
    method: str
    solid: str
    fingers: int
    seed: int


@dataclass(frozen=True)
class Played:
    """Result of a trial.

    Attributes:
        success: The goal was reached and held.
        points: Points, 0 to 100.
        seconds: Time (s) until the goal was held, or until the trial ended.
        toppled: The trial ended early, since an object was toppled or pushed away, or a nut was
            overtightened.
        back: Number of objects that left the surface and were put back.
        push: Largest force (N) of palm and free fingers on objects.
    """

    success: bool
    points: float
    seconds: float
    toppled: bool
    back: int
    push: float


def scored_trial(job: Job, make_views: ViewMaker) -> tuple[TrialResult, float]:
    """Plays one trial. Returns its result, and its points of `tasks.score.points`."""
    options = {"solid": job.solid, "fingers": job.fingers, **METHODS[job.method]}
    chosen = trial_settings(TrialOptions(task=job.task, seed=job.seed, **options))
    done = play_trial(chosen, device_makers(chosen), make_views)
    limit = find_task(job.task).time_limit
    return done, points(done.success, done.progress, done.time_s, limit)


def play(job: Job) -> Played:
    """Plays one trial."""
    watched: list[Pushes] = []

    def watch(session: Session) -> Sequence[Pushes]:
        watched.append(Pushes(session))
        return watched

    done, score = scored_trial(job, watch)
    return Played(
        done.success,
        score,
        done.time_s,
        done.status is Status.FAILED,
        done.respawned,
        watched[0].largest,
    )


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Returns the 95 % t interval of the mean of values. Both ends are the value if there is only
    one."""
    middle = mean(values)
    if len(values) < 2:
        return middle, middle
    half = float(t.ppf(0.975, len(values) - 1)) * stdev(values) / sqrt(len(values))
    return middle - half, middle + half


@dataclass(frozen=True)
class Difference:
    """A method compared with the default, on the same seeds.

    Attributes:
        pairs: Number of seeds.
        won, lost: Number of seeds on which only the method succeeded, and only the default.
        points: Mean difference of points, method minus default.
        low, high: 95 % t interval of this difference.
        by_success, by_points: p values before Holm.
    """

    pairs: int
    won: int
    lost: int
    points: float
    low: float
    high: float
    by_success: float
    by_points: float


def difference(method: Sequence[Played], ships: Sequence[Played]) -> Difference:
    """Compares a method with the default.

    Args:
        method: Trials of the method.
        ships: Trials of the default, on the same seeds in the same order.
    """
    won = sum(a.success and not b.success for a, b in zip(method, ships, strict=True))
    lost = sum(b.success and not a.success for a, b in zip(method, ships, strict=True))
    apart = [a.points - b.points for a, b in zip(method, ships, strict=True)]
    low, high = interval(apart)
    unequal = won + lost
    return Difference(
        len(apart),
        won,
        lost,
        mean(apart),
        low,
        high,
        float(binomtest(won, unequal).pvalue) if unequal else 1.0,
        float(wilcoxon(apart).pvalue) if np.any(apart) else 1.0,
    )


def rows(done: dict[Job, Played]) -> Iterator[str]:
    """Yields a table of all trials, with a line for each task, solidity, number of fingers and
    method."""
    heads = ("task", "solid", "fingers", "method", "success [95 %]", "points [95 %]", "s")
    yield "| " + " | ".join((*heads, "ended early", "put back", "push, N")) + " |"
    yield "| --- " * 10 + "|"
    for (task, solid, fingers), methods in _cells(done).items():
        for method, trials in methods.items():
            plays = list(trials.values())
            won = [each.seconds for each in plays if each.success]
            low, high = (100 * end for end in wilson(len(won), len(plays)))
            scores = [each.points for each in plays]
            least, most = interval(scores)
            pushes = [each.push for each in plays]
            cells = [
                *(task, solid, str(fingers), method),
                f"{len(won)}/{len(plays)} [{low:.0f}, {high:.0f}]",
                f"{mean(scores):.1f} [{least:.1f}, {most:.1f}]",
                f"{median(won):.1f}" if won else "",
                str(sum(each.toppled for each in plays)),
                str(sum(each.back for each in plays)),
                f"{median(pushes):.1f}, {max(pushes):.1f}",
            ]
            yield "| " + " | ".join(cells) + " |"


class Compared(NamedTuple):
    """A method compared with the default, in one task.

    Attributes:
        difference: Difference of the trials.
        by_success, by_points: p values after Holm over all comparisons.
    """

    difference: Difference
    by_success: float
    by_points: float


Comparisons = dict[tuple[str, str, int, str], Compared]
"""(Task, solidity, number of fingers, method) -> comparison."""


def compare(done: dict[Job, Played]) -> Comparisons:
    """Compares every method with the default, in every task, with Holm over all of them."""
    raw: dict[tuple[str, str, int, str], Difference] = {}
    for (task, solid, fingers), methods in _cells(done).items():
        ships = methods.get(SHIPS, {})
        for method, trials in methods.items():
            seeds = [seed for seed in trials if seed in ships]
            if method != SHIPS and seeds:
                pairs = [trials[s] for s in seeds], [ships[s] for s in seeds]
                raw[task, solid, fingers, method] = difference(*pairs)
    p = {f"{key}/success": one.by_success for key, one in raw.items()}
    p |= {f"{key}/points": one.by_points for key, one in raw.items()}
    after = holm(p)
    return {
        key: Compared(one, after[f"{key}/success"], after[f"{key}/points"])
        for key, one in raw.items()
    }


def differences(compared: Comparisons) -> Iterator[str]:
    """Yields a table of every method compared with the default, with p values after Holm over all
    of them."""
    heads = ("task", "solid", "fingers", "method", "pairs", "only it, only what ships")
    yield "| " + " | ".join((*heads, "points more [95 %]", "p of success", "p of points")) + " |"
    yield "| --- " * 9 + "|"
    for (task, solid, fingers, method), (one, *after) in compared.items():
        cells = [
            *(task, solid, str(fingers), method, str(one.pairs), f"{one.won}, {one.lost}"),
            f"{one.points:+.1f} [{one.low:+.1f}, {one.high:+.1f}]",
            *(f"{p:.3g}" for p in after),
        ]
        yield "| " + " | ".join(cells) + " |"


def draw(compared: Comparisons, path: Path) -> None:
    """Draws the differences of points, with a panel for each method and a line for each task.

    Args:
        compared: The comparisons.
        path: File of the picture.
    """
    from matplotlib import rc_context

    lines = list(dict.fromkeys(key[:3] for key in compared))
    methods = list(dict.fromkeys(key[3] for key in compared))
    names = {line: _line_name(line, lines) for line in lines}
    with rc_context({**STYLE, "svg.fonttype": "none", "axes.grid.axis": "both"}):
        made = figure(1.6 + 1.5 * len(methods), 0.9 + 0.22 * len(lines))
        panels = made.subplots(1, len(methods), sharey=True, squeeze=False)[0]
        for axes, method in zip(panels, methods, strict=True):
            for line in lines:
                if (*line, method) in compared:
                    _draw_one(axes, names[line], compared[(*line, method)])
            axes.axvline(0.0, color=FAINT, linewidth=0.8)
            axes.set(title=method)
        for near in (True, False):
            _share_scale([a for a, m in zip(panels, methods, strict=True) if (m in FAR) != near])
        panels[0].invert_yaxis()
        made.supxlabel(f"points more than {SHIPS}", fontsize=9.0)
        made.savefig(path, metadata={"Date": None})


def _line_name(line: tuple[str, str, int], lines: Sequence[tuple[str, str, int]]) -> str:
    """Returns the task, with solidity and number of fingers if they differ between lines."""
    task, solid, fingers = line
    parts = [task]
    if len({each[1] for each in lines}) > 1:
        parts.append(solid)
    if len({each[2] for each in lines}) > 1:
        parts.append(f"{fingers} fingers")
    return ", ".join(parts)


def _share_scale(panels: Sequence[Axes]) -> None:
    """Sets the same scale of points for panels."""
    ranges = [panel.get_xlim() for panel in panels]
    for panel in panels:
        panel.set_xlim(min(low for low, _ in ranges), max(high for _, high in ranges))


def _draw_one(axes: Axes, name: str, one: Compared) -> None:
    """Draws a mean difference with its interval, in another colour if success or points differ."""
    apart = one.difference
    differs = min(one.by_success, one.by_points) < 0.05
    around = [[apart.points - apart.low], [apart.high - apart.points]]
    colour = COLOURS[1] if differs else COLOURS[-1]
    axes.errorbar(apart.points, name, xerr=around, fmt="o", markersize=3.5, color=colour)


def _cells(
    done: dict[Job, Played],
) -> dict[tuple[str, str, int], dict[str, dict[int, Played]]]:
    """Groups trials by task, solidity and number of fingers, then by method, then by seed, in the
    order of the registry and of `METHODS`."""
    order = {name: i for i, name in enumerate((*TASKS, *METHODS))}
    cells: dict[tuple[str, str, int], dict[str, dict[int, Played]]] = {}
    for job in sorted(done, key=lambda j: (order[j.task], j.solid, j.fingers, order[j.method], j)):
        methods = cells.setdefault((job.task, job.solid, job.fingers), {})
        methods.setdefault(job.method, {})[job.seed] = done[job]
    return cells


def main() -> None:
    """Plays the missing trials, then prints both tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=list(TASKS), choices=list(TASKS))
    parser.add_argument("--methods", nargs="+", default=list(METHODS), choices=list(METHODS))
    parser.add_argument("--solid", nargs="+", default=list(SOLID), choices=SOLID)
    parser.add_argument("--fingers", nargs="+", type=int, default=[3])
    parser.add_argument(
        "--seeds", default="7000:7150", help="training seeds, FIRST:END without END"
    )
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("out/methods.jsonl"))
    parser.add_argument(
        "--kept", type=Path, nargs="+", default=[], help="files with trials that were played before"
    )
    parser.add_argument(
        "--table", type=Path, nargs="+", help="only print the trials of these files"
    )
    parser.add_argument("--plot", type=Path, help="also draw the differences of points, as SVG")
    options = parser.parse_args()
    for path in [*(options.table or ()), *options.kept]:
        if not path.is_file():
            parser.error(f"no such file: {path}")
    if options.plot:
        need_matplotlib()
    kept = KeptTrials(Job, Played, options.table or [options.out, *options.kept])
    if not options.table:
        # Seed by seed, so that an interrupted run has equally many seeds of all tasks and methods.
        chosen = (options.tasks, options.methods, options.solid, options.fingers)
        jobs = [
            Job(*each, seed) for seed in parse_seeds(options.seeds) for each in product(*chosen)
        ]
        kept.play(play, jobs, options.workers)
    print(describe_machine())
    print("\n".join(rows(kept.done)))
    print()
    compared = compare(kept.done)
    print("\n".join(differences(compared)))
    if options.plot:
        draw(compared, options.plot)


if __name__ == "__main__":
    run(main)
