"""Measures the cost and delay of a stream, and what a real Blender keys of it.

python -m benchmarks.stream                      # times, against a command port of ours
python -m benchmarks.stream --bpy PYTHON         # also Blender, by a Python that has bpy
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.machine import describe_machine
from models.motion.armature import Y_UP, Armature, Keys
from models.motion.read.bvh import read_bvh
from models.motion.write.bvh import BvhWriter
from models.skeleton import ADULT
from sandbox.stream.lines import BLENDER, MAYA, HandLines, StreamTarget
from sandbox.stream.script import script
from sandbox.stream.sender import Sender
from tests.sandbox.stream.command_port import CommandPort, Manners
from tests.support.motion_poses import moving

MOMENTS = 240


def moments(target: StreamTarget) -> tuple[Keys, HandLines, list[Keys]]:
    """A lively hand at 60 Hz."""
    armature = Armature(ADULT)
    keys = armature.keys(moving(ADULT, MOMENTS, 3))
    one = [Keys(keys.root[i : i + 1], keys.turns[i : i + 1]) for i in range(MOMENTS)]
    return keys, HandLines(armature, "right", target), one


def cost() -> None:
    """ms of processor time that a moment's commands take, and their bytes."""
    for target in (MAYA, BLENDER):
        _, hand, every = moments(target)
        spent, sizes = [], []
        for i, one in enumerate(every):
            begin = time.thread_time()
            commands = hand.lines(i / 60.0, one)
            spent.append(1e3 * (time.thread_time() - begin))
            sizes.append(sum(len(c) + 1 for c in commands))
        print(
            f"{target.name}: a moment takes {np.median(spent):.2f} ms (median; 95 % "
            f"{np.percentile(spent, 95):.2f}) and {max(sizes)} bytes at most; "
            f"the rig {len(hand.rig) + 1}"
        )


def delay() -> None:
    """ms from handing a moment over to its being carried out, and what handing over takes."""
    for name, manners in (("answers", Manners()), ("dies of every answer", Manners(dies=True))):
        _, hand, every = moments(MAYA)
        begun: dict[int, float] = {}
        done: dict[int, float] = {}

        def run(text: str, done: dict[int, float] = done) -> None:
            words = text.split(" ")
            if words[3].isdigit():
                done[round(60 * float(words[4]))] = time.perf_counter()

        port = CommandPort(run, manners)
        sender = Sender("127.0.0.1", port.port, [hand.rig])
        sender.connected.wait(5.0)
        time.sleep(1.5)
        handing = []
        for i, one in enumerate(every):
            begun[i] = time.perf_counter()
            sender.show("right", partial(hand.lines, i / 60.0, one))
            handing.append(1e6 * (time.perf_counter() - begun[i]))
            time.sleep(1 / 60)
        sender.flush(5.0)
        time.sleep(0.2)
        sender.close()
        port.close()
        late = [1e3 * (done[i] - begun[i]) for i in done]
        print(
            f"a port that {name}: {len(done)} of {MOMENTS} moments, {np.median(late):.1f} ms late "
            f"(median; 95 % {np.percentile(late, 95):.1f}); handed over in "
            f"{np.median(handing):.0f} us"
        )


def blender(python: str) -> None:
    """m between what Blender exports of what it keyed, and our own export."""
    keys, hand, every = moments(BLENDER)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "side.py").write_text(script("blender"))
        side = subprocess.Popen(
            [python, "side.py", "--port", "0", "--out", "theirs.bvh"],
            cwd=folder,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert side.stdout is not None
        port = int(side.stdout.readline().rsplit(":", 1)[1])
        sender = Sender("127.0.0.1", port, [hand.rig])
        sender.connected.wait(5.0)
        begin = time.perf_counter()
        for i, one in enumerate(every):
            sender.show("right", partial(hand.lines, i / 60.0, one), 60.0)
        sender.order(hand.stop)
        sender.flush(60.0)
        took = time.perf_counter() - begin
        side.communicate(timeout=60)
        sender.close()
        with BvhWriter(folder / "ours.bvh", Armature(ADULT), 60.0) as writer:
            writer.write(keys)
        theirs, ours = read_bvh(folder / "theirs.bvh"), read_bvh(folder / "ours.bvh")
    error = np.abs(theirs.place().positions - ours.place().positions @ Y_UP).max()
    print(
        f"Blender: {len(theirs)} keys, joints within {error:.1e} m of our own export; "
        f"{1e3 * took / MOMENTS:.1f} ms a moment, keyed and answered"
    )


def main() -> None:
    """Prints the lines."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--bpy", metavar="PYTHON")
    asked = parser.parse_args()
    print(describe_machine())
    cost()
    delay()
    if asked.bpy:
        blender(asked.bpy)


if __name__ == "__main__":
    main()
