"""What a recording of the first Leap software says of its device, beside the simulated device.

    python -m benchmarks.first_leap ../shared/data/leap/v1-hands.json
    python -m benchmarks.first_leap ../shared/data/leap/v1-hands.json --readings

The simulated device sees the hands that PAALM makes of the recording, several times with other
chance, so that both devices see the same movement. Fingers do not include thumbs. The first second
does not count: the device looks for hands. With `--readings`, what every reading of the paper makes
of the recording as if it came from the device, which `sandbox evaluate --paalm simulated
--readings` judges by truth.
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.one_line import run
from encoders.evaluation.paalm_plausible import plausibility
from encoders.paalm import Paalm
from encoders.paalm.angles import joints_of_angles
from encoders.paalm.hand_pose import PALM_CENTRE
from encoders.paalm.palm import palm_of
from encoders.paalm.recorded import calibrate_on_recording
from encoders.paalm.rig import bone_lengths
from encoders.paalm.simulated.air import AirTake
from encoders.paalm.simulated.forward import leap_take
from encoders.paalm.simulated.leap_configuration import (
    FROZEN_LEAP,
    PRINTED_LEAP,
    LeapConfiguration,
)
from models.arithmetic.arrays import Array
from models.frames import FINGERS, HandFrame
from models.skeleton import ADULT
from sandbox.cli.evaluate.paalm_readings import READINGS
from sandbox.devices.leap.leap_file import read_leap

SETTLED = 1.0
"""s at the beginning that do not count."""
PIECES = ((0.4, 0.6), (0.6, 0.75), (0.75, 0.9), (0.9, 1.1))
"""Pieces of the length ratio by which directions are told apart."""
LATER = (0.1, 0.2, 0.4)
"""s after which length ratios are compared."""
KNUCKLES = np.array([ADULT.bones[i].anchor for i in ADULT.first_bone]) - PALM_CENTRE
"""(5, 3) m, those of the average hand from its palm's centre."""


@dataclass(frozen=True)
class SeenHand:
    """One hand of a recording, with the names and the pose that PAALM gives it; unseen is NaN or 0.

    Attributes:
        time: (T,) s.
        palm: (T, 3) m, in the device's frame.
        slip: (T,) m by which the palm's centre is seen too far forward.
        shift: (3,) m, from the device's centre of the palm to the average hand's.
        ids: (T, 5).
        ratio: (T, 5) length ratios.
        tip, along: (T, 5, 3) tips, m, and directions in the palm's frame.
        world: (T, 5, 3) m, tips in the device's frame.
        pose: The pose, as a hand that a simulated device may see.
    """

    time: Array
    palm: Array
    slip: Array
    shift: Array
    ids: Array
    ratio: Array
    tip: Array
    along: Array
    world: Array
    pose: AirTake


def hands_in(frames: Sequence[HandFrame], side: str | None = None) -> list[SeenHand]:
    """The hands of a recording; `side` is that of a lone hand."""
    paalm = Paalm()
    why = calibrate_on_recording(paalm, frames, "both" if side is None else side)  # type: ignore[arg-type]
    if why:
        print(why)
    rows: dict[str, list[tuple[Array, ...]]] = {s: [] for s in paalm.calibration}
    for frame in frames:
        for s, hand in paalm.step(frame).hands.items():
            if not hand.seen or frame.time - frames[0].time < SETTLED:
                continue
            seen = next(h for h in frame.hands if h.id == hand.hand_id)
            palm, named = palm_of(seen, s), {i: n for n, i in hand.ids.items()}
            table = np.full((len(FINGERS), 11), np.nan)
            table[:, 0] = 0
            for f in seen.fingers:
                name = named[f.id]
                finger = FINGERS.index(name)
                table[finger] = (
                    *(f.id, hand.ratios[name]),
                    *(*palm.place(f.tip), *palm.turn(f.direction), *f.tip),
                )
            shift = np.array(paalm.calibration[s].palm_shift or (0.0, 0.0, 0.0))
            slip = shift[1] - palm.place(hand.palm.origin)[1]
            rows[s].append(
                (
                    np.array([frame.time, slip, *seen.palm]),
                    table,
                    hand.table,
                    np.array(hand.palm.origin),
                    hand.palm.rotation,
                    shift,
                )
            )
    return [_hand(s, found) for s, found in rows.items() if found]


def _hand(side: str, rows: list[tuple[Array, ...]]) -> SeenHand:
    head, table, angles, origin, rotation, shift = (np.array(c) for c in zip(*rows, strict=True))
    joints = joints_of_angles(angles, KNUCKLES, bone_lengths())
    still = np.zeros(len(head), bool)
    pose = AirTake(head[:, 0], origin, rotation, joints, still, side)
    return SeenHand(
        head[:, 0],
        head[:, 2:],
        head[:, 1],
        shift[0],
        table[..., 0],
        table[..., 1],
        table[..., 2:5],
        table[..., 5:8],
        table[..., 8:],
        pose,
    )


def facts(hands: Sequence[SeenHand]) -> dict[str, float]:
    """Facts of a device by name; lengths in mm, angles in degrees."""
    ratio = np.concatenate([h.ratio[:, 1:].ravel() for h in hands])
    along = np.concatenate([h.along[:, 1:].reshape(-1, 3) for h in hands])
    flexion = np.degrees(np.arctan2(-along[:, 2], along[:, 1]))
    rows = {f"length ratio, {q} % of fingers": _percentile(ratio, q) for q in (5, 25, 50, 75)}
    for low, high in PIECES:
        rows[f"direction at {low} to {high}"] = _percentile(
            flexion[(ratio >= low) & (ratio < high)], 50
        )
    change = np.concatenate(
        [(np.diff(h.ratio[:, 1:], axis=0) / np.diff(h.time)[:, None]).ravel() for h in hands]
    )
    rows["change of a ratio, 1/s, 75 %"] = _percentile(np.abs(change), 75)
    rows["the same, 95 %"] = _percentile(np.abs(change), 95)
    for later in LATER:
        before, after = zip(*(_later(h, later) for h in hands), strict=True)
        rows[f"ratio and ratio {later} s later"] = _correlation(before, after)
    rows["ratios of two fingers"] = _correlation(
        *zip(
            *(
                (h.ratio[:, [a]], h.ratio[:, [b]])
                for h in hands
                for a in range(1, 5)
                for b in range(1, a)
            ),
            strict=True,
        )
    )
    rows["tip from frame to frame, mm"] = 1e3 * _second([h.world[:, 1:] for h in hands])
    rows["direction from frame to frame"] = np.degrees(_second([h.along[:, 1:] for h in hands]))
    rows["palm from frame to frame, mm"] = 1e3 * _second([h.palm[:, None] for h in hands])
    off = np.concatenate([_off_line(h).ravel() for h in hands])
    rows["direction off knuckle to tip, median"] = _percentile(off, 50)
    rows["the same, 95 % of fingers"] = _percentile(off, 95)
    rows["palm in front of ours, mm"] = -1e3 * float(np.mean([h.shift[1] for h in hands]))
    slip = 1e3 * np.concatenate([h.slip for h in hands])
    rows["its wandering, mm"] = (_percentile(slip, 84) - _percentile(slip, 16)) / 2.0
    seen = np.concatenate([(h.ids != 0).sum(axis=1) for h in hands])
    rows["fingers of a hand"] = float(seen.mean())
    rows["hands with five, %"] = 100.0 * float((seen == len(FINGERS)).mean())
    return rows | _losses(hands)


def _losses(hands: Sequence[SeenHand]) -> dict[str, float]:
    """How often a finger is lost, for how long, and how often its id is another's afterwards."""
    away: list[float] = []
    fresh: list[bool] = []
    swapped, seconds, together = 0, 0.0, 0.0
    for h in hands:
        step = float(np.median(np.diff(h.time)))
        together += step * len(h.time)
        for finger in range(len(FINGERS)):
            ids = h.ids[:, finger]
            at = np.nonzero(ids)[0]
            seconds += step * len(at)
            for a, b in itertools.pairwise(at):
                if b > a + 1:
                    away.append(float(h.time[b] - h.time[a]) - step)
                    fresh.append(bool(ids[a] != ids[b]))
                elif ids[a] != ids[b]:
                    swapped += 1
    return {
        "losses of a finger, 1/s": len(away) / seconds,
        "duration, s, median": float(np.median(away)),
        "the same, 90 %": _percentile(np.array(away), 90),
        "with another id, %": 100.0 * float(np.mean(fresh)),
        "ids that change names, 1/s": swapped / together,
    }


def _off_line(h: SeenHand) -> Array:
    """Degrees (T, 4) between a finger's direction and the line from its knuckle to its tip."""
    knuckles = KNUCKLES[1:] + h.shift
    line = h.tip[:, 1:] - knuckles
    line[..., 1] += h.slip[:, None]
    cosine = (line * h.along[:, 1:]).sum(axis=-1) / np.linalg.norm(line, axis=-1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def _later(h: SeenHand, seconds: float) -> tuple[Array, Array]:
    at = np.searchsorted(h.time, h.time + seconds)
    ok = at < len(h.time)
    at = at[ok]
    near = h.time[at] - h.time[ok] < 1.2 * seconds
    return h.ratio[ok][near][:, 1:], h.ratio[at][near][:, 1:]


def _second(places: Sequence[Array]) -> float:
    """Median length of the second differences of places (T, k, 3)."""
    parts = [np.linalg.norm(np.diff(p, n=2, axis=0), axis=-1).ravel() for p in places]
    return _percentile(np.concatenate(parts), 50)


def _percentile(values: Array, share: float) -> float:
    known = values[np.isfinite(values)]
    return float(np.percentile(known, share)) if len(known) else float("nan")


def _correlation(before: Sequence[Array], after: Sequence[Array]) -> float:
    a, b = (np.concatenate([np.ravel(x) for x in xs]) for xs in (before, after))
    known = np.isfinite(a) & np.isfinite(b)
    return float(np.corrcoef(a[known], b[known])[0, 1])


def simulated(
    hands: Sequence[SeenHand], configuration: LeapConfiguration, takes: int
) -> list[dict[str, float]]:
    """Facts of a simulated device that sees the same hands, take by take."""
    return [
        facts(
            [
                found
                for i, h in enumerate(hands)
                for found in hands_in(
                    leap_take(h.pose, 2 * seed + i, configuration=configuration).frames, h.pose.side
                )
            ]
        )
        for seed in range(takes)
    ]


def main() -> None:
    """Prints a row for every fact."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("recording", type=Path)
    parser.add_argument("--takes", type=int, default=8)
    parser.add_argument("--readings", action="store_true")
    options = parser.parse_args()
    frames = read_leap(options.recording).frames
    if options.readings:
        print("| reading | knuckle backward | claws | other limit | tips, 95 % |")
        print("| --- | --- | --- | --- | --- |")
        for name, reading in READINGS.items():
            judged = plausibility(frames, reading, live=True)
            shares = (judged.backward, judged.claws, judged.at_limit)
            cells = " | ".join(f"{100 * share:.1f} %" for share in shares)
            print(f"| {name} | {cells} | {1000 * judged.tips:.1f} mm |")
        return
    hands = hands_in(frames)
    real = facts(hands)
    columns = [simulated(hands, c, options.takes) for c in (FROZEN_LEAP, PRINTED_LEAP)]
    print(f"| fact | real, {len(frames)} frames | simulated, {options.takes} takes | as printed |")
    print("| --- | --- | --- | --- |")
    for name, value in real.items():
        found = [np.array([one[name] for one in column]) for column in columns]
        text = " | ".join(f"{c.mean():.2f} ({c.min():.2f} to {c.max():.2f})" for c in found)
        print(f"| {name} | {value:.2f} | {text} |")


if __name__ == "__main__":
    run(main)
