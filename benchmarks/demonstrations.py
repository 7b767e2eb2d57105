"""Measures demonstrations by the policies that are learned from them.

    python -m benchmarks.demonstrations --sources best --sizes 10 50 200 --judged 100
    python -m benchmarks.demonstrations --sources paper names shadow --sizes 200 --judged 100
    python -m benchmarks.demonstrations --table --plot out/demonstrations/curve.png
    python -m benchmarks.demonstrations --sources best --check 1000 --workers 2
    python -m benchmarks.demonstrations --task insert --sources best --out out/insert

The simulated user plays a task on seeds of training until there are as many successful trials
as the largest size asks for. Of each source and size, a policy is trained by behaviour cloning, and
plays judged seeds in the environment of its demonstrations: with the same encoder, labels and hand.
Resumable: trials, policies and judged episodes are kept in a folder and not made again. Everything
is simulated. Prints Markdown. Training needs the extra `learn`.

`--check` reads kept demonstrations from their files and plays every action through the environment
that they name, in processes of their own, and compares every state with the recorded one.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from time import monotonic, process_time
from typing import Any

import gymnasium
import numpy as np

from benchmarks.judged import judged_seeds
from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from sandbox import run_trial
from sandbox.datasets.demonstration import Demonstration
from sandbox.datasets.export import export_data_set
from sandbox.datasets.npz_file import read_npz
from sandbox.datasets.playback import first_difference
from sandbox.gym import learning_id
from sandbox.learning.cloning import clone
from sandbox.learning.policy import Policy, play
from sandbox.regress.statistics import wilson

TASKS = ("box-to-goal", "insert")
"""Tasks that a policy of `sandbox.learning` can see."""
SOURCES: dict[str, dict[str, Any]] = {
    "best": {},
    "paper": {"encoder": "paper"},
    "names": {"labels": "paper"},
    "shadow": {"robot": "shadow"},
}
"""Source -> options of `sandbox run`: the default; the paper's method; fingers named by the paper's
rule, which is often wrong; and the Shadow Hand."""
FIRST = 20000
"""The first seed, of training."""


@dataclass(frozen=True)
class Source:
    """Demonstrations of one kind.

    Args:
        name: One of `SOURCES`.
        folder: Folder of all that is kept.
        task: One of `TASKS`.
    """

    name: str
    folder: Path
    task: str

    @cached_property
    def trials(self) -> Path:
        """Folder of its trials: a note of each, and a demonstration if it succeeded."""
        path = self.folder / self.name
        path.mkdir(parents=True, exist_ok=True)
        return path

    def notes(self) -> dict[int, dict[str, Any]]:
        """Seed -> what came of it, for the trials so far."""
        files = sorted(self.trials.glob("*.json"), key=lambda file: int(file.stem))
        return {int(file.stem): json.loads(file.read_text()) for file in files}

    def collect(self, successes: int) -> None:
        """Plays trials until there are so many successes."""
        notes, seed = self.notes(), FIRST
        won = sum(note["success"] for note in notes.values())
        while won < successes:
            if seed not in notes:
                won += self._try(seed)
            seed += 1

    def demonstrations(self, count: int) -> list[Demonstration]:
        """The first successful ones."""
        seeds = [seed for seed, note in self.notes().items() if note["success"]][:count]
        return [read_npz(self.trials / f"{seed}.npz").episodes[0] for seed in seeds]

    def played(self, successes: int) -> int:
        """Number of trials that it took to succeed so often."""
        won = np.cumsum([note["success"] for note in self.notes().values()])
        return int(np.searchsorted(won, successes)) + 1

    def environment(self) -> Any:
        """The environment in which its demonstrations were made."""
        (file, *_) = sorted(self.trials.glob("*.npz"))
        kept = {"id", "task"}
        options = {k: v for k, v in read_npz(file).environment.items() if k not in kept}
        return gymnasium.make(learning_id(self.task), **options).unwrapped

    def _try(self, seed: int) -> bool:
        begun, recording = process_time(), self.trials / f"{seed}.jsonl"
        recording.unlink(missing_ok=True)
        trial = run_trial(
            self.task, seed, record=recording, trajectories=False, **SOURCES[self.name]
        )
        differ = None
        if trial.success:
            differ = len(export_data_set([recording], self.trials / f"{seed}.npz").differing)
        recording.unlink()
        note = {"success": trial.success, "differ": differ, "cpu": process_time() - begun}
        (self.trials / f"{seed}.json").write_text(json.dumps(note))
        return trial.success


@dataclass(frozen=True)
class Learner:
    """A policy of one source and size, and how it did.

    Args:
        source: The source.
        size: Number of demonstrations.
    """

    source: Source
    size: int

    def _file(self, ending: str) -> Path:
        return self.source.folder / f"policy-{self.source.name}-{self.size}.{ending}"

    def judged(self) -> list[dict[str, Any]]:
        """The episodes so far; a torn last line is left out."""
        file = self._file("jsonl")
        lines = file.read_bytes().split(b"\n")[:-1] if file.exists() else []
        return [json.loads(line) for line in lines]

    def judge(self, seeds: list[int]) -> None:
        """Trains it unless it is trained, and plays the seeds that were not played yet."""
        missing = seeds[len(self.judged()) :]
        if not missing:
            return
        env = self.source.environment()
        if not self._file("npz").exists():
            (surface,) = env.surfaces
            clone(self.source.demonstrations(self.size), surface).save(self._file("npz"))
        policy = Policy.load(self._file("npz"))
        with self._file("jsonl").open("ab", buffering=0) as file:
            for seed in missing:
                success, seconds = play(env, policy, seed)
                note = {"seed": seed, "success": success, "seconds": seconds}
                file.write(json.dumps(note).encode() + b"\n")
        env.close()

    def row(self) -> str:
        """A row of the table."""
        episodes, source = self.judged(), self.source
        won = [each["seconds"] for each in episodes if each["success"]]
        low, high = (100 * end for end in wilson(len(won), len(episodes)))
        time = f"{np.median(won):.1f}" if won else ""
        return (
            f"| {source.name} | {self.size}/{source.played(self.size)} | {self.size} | "
            f"{len(won)}/{len(episodes)} = {100 * len(won) / len(episodes):.0f} % | "
            f"{low:.0f} to {high:.0f} | {time} |"
        )


@cache
def _environment(source: Source) -> Any:
    """The environment of a source, one in every process."""
    return source.environment()


def _played_back(source: Source, file: Path) -> tuple[int, bool, int]:
    """States of a demonstration, whether all are as recorded, and bytes of its file."""
    (episode,) = read_npz(file).episodes
    env = _environment(source)
    differs = first_difference(env, episode.seed, episode.actions, episode.hashes)
    return len(episode.hashes), differs is None, file.stat().st_size


def check(source: Source, count: int, workers: int) -> str:
    """Reads and plays back the first demonstrations of a source; what came of it."""
    files = sorted(source.trials.glob("*.npz"), key=lambda file: int(file.stem))[:count]
    spent = sum(source.notes()[int(file.stem)]["cpu"] for file in files)
    begun = monotonic()
    with ProcessPoolExecutor(workers) as pool:
        found = list(pool.map(_played_back, [source] * len(files), files))
    minutes = (monotonic() - begun) / 60
    states, equal, size = (sum(column) for column in zip(*found, strict=True))
    return (
        f"{source.name}: {equal} of {len(files)} demonstrations read and played back with every "
        f"one of {states} states as recorded, {minutes:.1f} min in {workers} processes; "
        f"{size / 1e6:.0f} MB. Playing and writing them took {spent / 60:.1f} min of processor."
    )


def table(learners: list[Learner]) -> Iterator[str]:
    """The result as Markdown."""
    yield (
        "| source | its own success | demonstrations | policy's success | 95 % interval, % | "
        "median time, s |"
    )
    yield "| --- | --- | --- | --- | --- | --- |"
    yield from (learner.row() for learner in learners if learner.judged())


def draw(learners: list[Learner], path: Path) -> None:
    """Draws success over the number of demonstrations, with intervals."""
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(6.4, 4.0), layout="constrained")
    for name in SOURCES:
        own = [(each.size, each.judged()) for each in learners if each.source.name == name]
        points = []
        for size, episodes in own:
            if episodes:
                won, count = sum(e["success"] for e in episodes), len(episodes)
                points.append((size, won / count, *wilson(won, count)))
        if points:
            sizes, rates, lows, highs = (np.array(column) for column in zip(*points, strict=True))
            errors = 100 * np.array([rates - lows, highs - rates])
            axes.errorbar(sizes, 100 * rates, errors, marker="o", capsize=3, label=name)
    axes.set(xscale="log", ylim=(0, 102), ylabel="success on judged seeds, %")
    axes.set(xlabel="successful demonstrations (simulated user)", title=learners[0].source.task)
    ticks = sorted({learner.size for learner in learners})
    axes.set_xticks(ticks, [str(tick) for tick in ticks], minor=False)
    axes.minorticks_off()
    axes.legend(frameon=False)
    figure.savefig(path, dpi=150)


def main() -> None:
    """Makes what is missing, then prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sources", nargs="+", choices=list(SOURCES), default=list(SOURCES))
    parser.add_argument("--task", choices=TASKS, default=TASKS[0])
    parser.add_argument("--sizes", nargs="+", type=int, default=[10, 50, 200])
    parser.add_argument("--judged", type=int, default=100, help="the first N judged seeds")
    parser.add_argument("--out", type=Path, default=Path("out/demonstrations"))
    parser.add_argument("--table", action="store_true", help="only print what is there")
    parser.add_argument("--plot", type=Path, help="draws the curves, .png or .svg")
    parser.add_argument("--check", type=int, metavar="N", help="plays back N of each source")
    parser.add_argument("--workers", type=int, default=2, help="processes of --check")
    options = parser.parse_args()
    sources = [Source(name, options.out, options.task) for name in options.sources]
    if options.check:
        print(f"{describe_machine()}\n")
        print("\n".join(check(source, options.check, options.workers) for source in sources))
        return
    learners = [Learner(source, size) for source in sources for size in sorted(options.sizes)]
    if not options.table:
        seeds = judged_seeds(options.judged, options.task)
        for learner in learners:
            learner.source.collect(learner.size)
            learner.judge(seeds)
    print(f"{describe_machine()}\n")
    print("\n".join(table(learners)))
    if options.plot:
        draw(learners, options.plot)


if __name__ == "__main__":
    run(main)
