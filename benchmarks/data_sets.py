"""Measures data sets of demonstrations: written, read back and played back, hash by hash.

    python -m benchmarks.data_sets --count 20

The simulated user plays box-to-goal, the recordings become a data set of Minari and a file .npz,
both are read, and all actions are played through the environment that Minari recovers. Prints
processor times, sizes, and what a thousand would take at the same cost each.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from itertools import pairwise
from pathlib import Path
from time import process_time

from benchmarks.machine import describe_machine
from sandbox import run_trial
from sandbox.datasets.export import export_data_set
from sandbox.datasets.npz_file import read_npz
from sandbox.datasets.playback import first_difference


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--first", type=int, default=6000, help="the first seed, of training")
    parser.add_argument("--robot", default="")
    options = parser.parse_args()
    print(f"{describe_machine()}\n", flush=True)
    name = "hand_sandbox/measured-v0"
    with tempfile.TemporaryDirectory() as text:
        folder = Path(text)
        os.environ["MINARI_DATASETS_PATH"] = str(folder / "minari")
        import minari

        files = [folder / f"{i}.jsonl" for i in range(options.count)]
        times = [process_time()]
        for i, file in enumerate(files):
            run_trial(
                "box-to-goal",
                options.first + i,
                record=file,
                robot=options.robot,
                trajectories=False,
            )
        times.append(process_time())
        found = export_data_set(files, Path("minari"), name)
        times.append(process_time())
        data = minari.load_dataset(name)
        episodes = [(e.actions, e.infos) for e in data.iterate_episodes()]
        times.append(process_time())
        env = data.recover_environment()
        different = compared = 0
        for actions, infos in episodes:
            hashes = [text.decode() for text in infos["state_hash"]]
            seed = int(infos["seed"][0])
            different += first_difference(env, seed, actions, hashes) is not None
            compared += len(hashes)
        times.append(process_time())
        size = sum(f.stat().st_size for f in (folder / "minari").rglob("*") if f.is_file())
        export_data_set(files, folder / "set.npz")
        times.append(process_time())
        read = read_npz(folder / "set.npz")
        times.append(process_time())
        npz = (folder / "set.npz").stat().st_size
    each = [(b - a) / options.count for a, b in pairwise(times)]
    print(f"{found.episodes} demonstrations, {found.successes} successful, {found.steps} steps")
    print(f"{len(found.differing)} have other states than their recordings")
    print(f"{len(read.episodes)} read from .npz; {different} differ when played back,")
    print(f"of {compared} states compared\n")
    print("| step | processor s each | min for 1000 (extrapolated) |")
    print("| --- | --- | --- |")
    steps = ("played and recorded", "to Minari", "read", "played back", "to .npz", "read from .npz")
    for what, seconds in zip(steps, each, strict=True):
        print(f"| {what} | {seconds:.3f} | {1000 * seconds / 60:.1f} |")
    print("\n| kind | MB each | MB for 1000 (extrapolated) |\n| --- | --- | --- |")
    for kind, total in (("Minari", size), (".npz", npz)):
        print(f"| {kind} | {total / 1e6 / options.count:.2f} | {total / 1e3 / options.count:.0f} |")


if __name__ == "__main__":
    main()
