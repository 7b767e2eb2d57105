"""Evaluates PAALM: errors of angles and labels, jitter and time, recording by recording.

Frames of a recording depend on each other, so every figure is computed within a recording first and
then over recordings. docs/paalm.md defines the measures; angles are those of the four fingers, the
thumb has separate figures. Frames in which the hand is held open for calibration do not count.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from encoders.paalm.average import average_calibration
from encoders.paalm.options import PaalmOptions
from encoders.paalm.paalm import Paalm
from encoders.paalm.simulated.air import FROZEN_AIR
from encoders.paalm.simulated.forward import LeapTake
from encoders.paalm.simulated.leap_configuration import FROZEN_LEAP
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS

_LEAST_OPEN = 10

CALIBRATION_SHARE = 0.8
"""Share of the open frames that the calibration requires, since some lack a finger."""


_SHOWN = (
    "mcp_deg",
    "mcp_spread_deg",
    "pip_deg",
    "dip_deg",
    "pip_dip_deg",
    "thumb_cmc_deg",
    "thumb_mcp_deg",
    "jitter_deg",
    "ms_per_frame",
)


@dataclass(frozen=True)
class Judgement:
    """Results for one recording.

    Attributes:
        name: Name of the recording.
        figures: Figures by name; NaN where the recording has no truth.
        frames: Number of evaluated frames.
    """

    name: str
    figures: dict[str, float]
    frames: int


def test_seeds(count: int) -> list[int]:
    """Seeds derived from the frozen configuration, so that they cannot be chosen.

    The first outputs of SHA-256 over hands, device and the method's defaults, 32 bits each.
    """
    frozen = json.dumps(
        [asdict(FROZEN_AIR), asdict(FROZEN_LEAP), asdict(PaalmOptions())], sort_keys=True
    )
    return [
        int.from_bytes(hashlib.sha256(f"{frozen}#{i}".encode()).digest()[:4], "big")
        for i in range(count)
    ]


def calibrated_on(take: LeapTake, options: PaalmOptions, measured: bool = True) -> Paalm:
    """Creates a PAALM calibrated on a recording's open frames.

    A hand that is hardly ever open, but whose joints the device knows, is not measured: its
    standards are its own bones. One that is solved by its tips, and of which too little is seen
    while it is open, is an average hand at first, as over a live device.

    Args:
        take: The recording.
        options: Options of PAALM.
        measured: False measures no hand.

    Raises:
        EncoderError: There are too few open frames, or the hand is not open in them.
    """
    is_open = [f for f, held in zip(take.frames, take.open, strict=True) if held]
    paalm = Paalm(options)
    by_tip = take.dialect == "v1" and options.solve == "tips"
    if not measured or (len(is_open) < _LEAST_OPEN and take.dialect == "v3"):
        known = take.frames if take.dialect == "v3" else ()
        paalm.use({take.side: average_calibration(known, take.side, options)})
        return paalm
    if len(is_open) < _LEAST_OPEN:
        raise EncoderError(
            "the hand is hardly ever held open",
            got=f"{len(is_open)} frames",
            expected=f"{_LEAST_OPEN} or more",
        )
    hands: Any = take.side
    try:
        paalm.calibrate(is_open, hands, round(CALIBRATION_SHARE * len(is_open)))
    except EncoderError:
        if not by_tip:
            raise
        paalm.use({take.side: average_calibration((), take.side, options)})
    return paalm


def judge_recording(
    name: str,
    take: LeapTake,
    options: PaalmOptions | None = None,
    angles: bool = True,
    names: bool = True,
    measured: bool = True,
) -> Judgement:
    """Evaluates one recording.

    Args:
        name: Name of the recording.
        take: Frames and truth.
        options: Options of PAALM; labels are evaluated with the paper's order as well.
        angles: False where the recording has no truth for single joints.
        names: False leaves out the labels of fingers, which take two more passes.
        measured: False takes a hand as a live device shows it that was never measured.
    """
    options = options or PaalmOptions()
    paalm = calibrated_on(take, options, measured)
    begin = time.perf_counter()
    steps = [paalm.step(frame) for frame in take.frames]
    milliseconds = 1e3 * (time.perf_counter() - begin) / len(steps)
    blank = np.full((len(FINGERS), 4), np.nan)
    tables = np.array([s.hands[take.side].table if s.hands else blank for s in steps])
    figures = {
        **_angles(tables, take, angles),
        "ms_per_frame": milliseconds,
    }
    for identity in ("tracked", "paper"):
        chosen = replace(options, identity=identity)
        figures[f"identity_{identity}"] = (
            _identity(take, chosen, measured) if names else float("nan")
        )
    return Judgement(name, figures, int((~take.open).sum()))


def summary(judgements: Sequence[Judgement]) -> dict[str, Any]:
    """Summary of the figures over recordings, as the command writes it; JSON values only."""
    if not judgements:
        raise EncoderError("no recording to judge", expected="1 or more")
    table = {k: np.array([j.figures[k] for j in judgements]) for k in judgements[0].figures}
    mean = {k: None if np.isnan(v).all() else float(np.nanmean(v)) for k, v in table.items()}
    seen = ("mcp_deg", "pip_deg", "dip_deg", "pip_dip_deg")
    return {
        **{k: mean[k] for k in _SHOWN},
        "seen_fingers": {k: mean[f"seen_{k}"] for k in seen},
        "identity_percent": {
            "paper": mean["identity_paper"],
            "tracked": mean["identity_tracked"],
        },
        "frames": sum(j.frames for j in judgements),
        "recordings": len(judgements),
        "per_recording": [
            {"name": j.name, "frames": j.frames}
            | {k: None if np.isnan(v) else v for k, v in j.figures.items()}
            for j in judgements
        ],
    }


def _angles(tables: Array, take: LeapTake, wanted: bool) -> dict[str, float]:
    judged_frames = ~take.open
    error = (tables - take.angles)[judged_frames]
    fingers = error[:, 1:]
    seen = np.array([[f in names.values() for f in range(1, 5)] for names in take.fingers])
    columns = {
        "mcp_deg": np.abs(fingers[..., 0]),
        "pip_deg": np.abs(fingers[..., 2]),
        "dip_deg": np.abs(fingers[..., 3]),
        "pip_dip_deg": np.abs(fingers[..., 2] + fingers[..., 3]),
    }
    chosen = seen[judged_frames]
    figures = {k: _mean(v) for k, v in columns.items()}
    figures |= {f"seen_{k}": _mean(v[chosen]) for k, v in columns.items()}
    # Change from frame to frame minus that of the truth, for fingers that stay visible.
    steps = np.diff(tables - take.angles, axis=0)[:, 1:][..., [0, 2, 3]]
    stays = (seen[1:] & seen[:-1]) & judged_frames[1:, None]
    figures |= {
        "mcp_spread_deg": _mean(np.abs(fingers[..., 1])),
        "thumb_cmc_deg": _mean(np.abs(error[:, 0, 0])),
        "thumb_mcp_deg": _mean(np.abs(error[:, 0, 2])),
        "jitter_deg": float(np.sqrt(_mean(steps[stays] ** 2))),
    }
    return figures if wanted else dict.fromkeys(figures, float("nan"))


def _identity(take: LeapTake, options: PaalmOptions, measured: bool) -> float:
    """Percentage of visible fingers, in frames that count, with the right label."""
    if any(f.finger is not None for frame in take.frames for h in frame.hands for f in h.fingers):
        return float("nan")  # The device labels them.
    paalm = calibrated_on(take, options, measured)
    right = total = 0
    for frame, names, held in zip(take.frames, take.fingers, take.open, strict=True):
        hands = paalm.step(frame).hands
        if held or take.side not in hands:
            continue
        for finger, name in enumerate(FINGERS):
            device_id = hands[take.side].ids[name]
            if device_id is not None:
                right += names[device_id] == finger
                total += 1
    return 100.0 * right / total if total else float("nan")


def _mean(values: Array) -> float:
    values = values[np.isfinite(values)]
    return float(values.mean()) if values.size else float("nan")
