"""Evaluates PAALM's angles and finger names on simulated and recorded hands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from encoders.evaluation.paalm_errors import (
    Judgement,
    Plausibility,
    as_first_software,
    independent,
    judge_recording,
    plausibility,
    summary,
    take_of_recording,
    test_seeds,
    two_hand_milliseconds,
)
from encoders.paalm import EQUAL, PAPER, TWO_THIRDS, Coupling, PaalmOptions
from encoders.paalm.simulated.air import simulate_air
from encoders.paalm.simulated.forward import PRINTED_LEAP, LeapTake, leap_take
from models.errors import EncoderError, InputError, RecordingError
from models.frames import SIDES
from sandbox.devices.leap.leap_file import LeapRecording, read_leap
from sandbox.devices.leap.leap_write import take_with_truth

CONDITIONS = {
    "v1": ("v1", True),
    "v1_without_drop_outs": ("v1", False),
    "v3": ("v3", True),
}
"""Condition -> dialect of the Leap, and whether hands drop out. PAALM was written for the first
condition."""


def judge_simulated(takes: int, shown: Callable[[float], None]) -> dict[str, Any]:
    seeds = test_seeds(takes)
    results: dict[str, list[Judgement]] = {name: [] for name in CONDITIONS}
    printed: list[Judgement] = []
    live: list[Judgement] = []
    couplings: dict[str, list[Judgement]] = {}
    done, parts = 0, len(CONDITIONS) * takes
    for seed in seeds:
        hand = simulate_air(seed)
        for name, (dialect, drop_outs) in CONDITIONS.items():
            take = leap_take(hand, seed, dialect, drop_outs)
            results[name].append(judge_recording(str(seed), take))
            if name == "v1":
                live.append(judge_recording(str(seed), take, measured=False))
                as_printed = leap_take(hand, seed, dialect, drop_outs, PRINTED_LEAP)
                printed.append(judge_recording(str(seed), as_printed, PAPER))
            if dialect == "v3":
                _by_coupling(couplings, str(seed), take, SIMULATED_FIT)
            done += 1
            shown(done / parts)
    conditions = {name: summary(j) for name, j in results.items()}
    return {
        "source": "SIMULATED hands, simulated Leap: no person and no device",
        "seeds": seeds,
        **conditions["v1"],
        "ms_per_frame_two_hands": two_hand_milliseconds(
            leap_take(simulate_air(seeds[0]), seeds[0]),
            leap_take(simulate_air(seeds[0] + 1, "left"), 1),
        ),
        "without_drop_outs": conditions["v1_without_drop_outs"],
        "v3": conditions["v3"],
        "live": summary(live),
        "paper_as_printed": summary(printed),
        "couplings_v3": {k: _short(j) for k, j in couplings.items()},
    }


def judge_folder(folder: Path, shown: Callable[[float], None]) -> dict[str, Any]:
    if not folder.is_dir():
        raise InputError(
            "no such folder", where=f"--paalm {folder}", expected="simulated, or a folder"
        )
    left_out: dict[str, str] = {}
    takes: list[tuple[str, LeapTake, LeapTake | None]] = []
    plausible: dict[str, Plausibility] = {}
    paths = sorted(p for p in folder.iterdir() if p.is_file())
    for number, path in enumerate(paths):
        try:
            recording = read_leap(path)
            if recording.damage is not None:
                left_out[f"{path.name} (its end)"] = str(recording.damage)
            if recording.report:
                left_out[f"{path.name} (parts)"] = recording.report.line()
            if recording.dialect == "v1" and take_with_truth(recording, str(path)) is None:
                plausible[path.name] = plausibility(recording.frames)
                plausible[f"{path.name}, live"] = plausibility(recording.frames, live=True)
            else:
                takes += list(_takes(path, recording))
        except (RecordingError, EncoderError) as error:
            left_out[path.name] = str(error)
        shown(0.3 * (number + 1) / len(paths))
    angles: list[Judgement] = []
    names: list[Judgement] = []
    couplings: dict[str, list[Judgement]] = {}
    truth = [take for _, take, _ in takes if independent(take)]
    for number, (name, take, unnamed) in enumerate(takes):
        try:
            if unnamed is not None:
                _names(names, left_out, name, unnamed)
            if not independent(take):
                left_out[f"{name} (angles)"] = "PIP and DIP are equal by construction (Leap v2)"
            else:
                angles.append(judge_recording(name, take))
                if take.dialect == "v1":
                    names.append(angles[-1])
                else:
                    _by_coupling(couplings, name, take, _fit([t for t in truth if t is not take]))
        except EncoderError as error:
            left_out[name] = str(error)
        shown(0.3 + 0.7 * (number + 1) / len(takes))
    if not angles and not names and not plausible:
        why = "; ".join(f"{k}: {v}" for k, v in list(left_out.items())[:3]) or "it is empty"
        raise InputError("no recording can be judged", where=f"--paalm {folder}", got=why)
    figures = summary(angles or names) if angles or names else {"recordings": 0}
    if names:
        figures["identity_percent"] = summary(names)["identity_percent"]
    return {
        "source": str(folder),
        **figures,
        "identity_recordings": [j.name for j in names],
        "couplings": {k: _short(j) for k, j in couplings.items()},
        "plausibility": {name: asdict(found) for name, found in plausible.items()},
        "left_out": left_out,
    }


def _names(found: list[Judgement], left_out: dict[str, str], name: str, unnamed: LeapTake) -> None:
    """Adds a judgement of the finger names in a take to `found`.

    It needs an open hand in the recording. Without an open hand, only the names are left out,
    since the judgement of angles of a device that reports joints does not need an open hand.
    """
    try:
        found.append(judge_recording(name, unnamed, angles=False))
    except EncoderError as error:
        left_out[f"{name} (names)"] = str(error)


def _takes(path: Path, recording: LeapRecording) -> Iterator[tuple[str, LeapTake, LeapTake | None]]:
    """Yields the takes of a file: name, take, and a copy without finger names.

    The copy is None if the device does not name fingers.
    """
    known = take_with_truth(recording, str(path))
    if known is not None:
        yield path.name, known, as_first_software(known) if known.dialect == "v3" else None
        return
    sides = {h.side for f in recording.frames for h in f.hands}
    for side in SIDES:
        if side in sides:
            take = take_of_recording(recording.frames, side)
            yield f"{path.name} {side}", take, as_first_software(take)


def _fit(others: list[LeapTake]) -> Coupling | None:
    """Returns the coupling fitted to other recordings; None if they do not determine it."""
    if not others:
        return None
    try:
        return Coupling.fitted(
            [a for t in others for a in t.angles[:, 1:, 2].ravel()],
            [a for t in others for a in t.angles[:, 1:, 3].ravel()],
        )
    except EncoderError:
        return None


def _by_coupling(
    table: dict[str, list[Judgement]], name: str, take: LeapTake, fitted: Coupling | None
) -> None:
    known = {"two_thirds": TWO_THIRDS, "equal": EQUAL}
    for key, coupling in (known | ({"fitted": fitted} if fitted else {})).items():
        options = replace(PaalmOptions(), coupling=coupling)
        table.setdefault(key, []).append(judge_recording(name, take, options))


def _short(judgements: list[Judgement]) -> dict[str, Any]:
    figures = summary(judgements)
    return {k: figures[k] for k in ("mcp_deg", "pip_deg", "dip_deg", "pip_dip_deg", "recordings")}


def show_judgements(found: dict[str, Any]) -> None:
    table = Table("", "MCP", "PIP", "DIP", "PIP+DIP", "names paper", "tracked", "jitter", "ms")
    rows = {"judged": found}
    for key in ("live", "without_drop_outs", "v3", "paper_as_printed"):
        if key in found:
            rows[key.replace("_", " ")] = found[key]
    for name, row in rows.items():
        if not row["recordings"]:
            continue
        cells = [row[k] for k in ("mcp_deg", "pip_deg", "dip_deg", "pip_dip_deg")]
        cells += [row["identity_percent"]["paper"], row["identity_percent"]["tracked"]]
        cells += [row["jitter_deg"], row["ms_per_frame"]]
        table.add_row(name, *("-" if c is None else f"{c:.2f}" for c in cells))
    console = Console()
    console = Console(width=max(console.width, 100))
    if found["recordings"]:
        console.print(table)
    console.print(
        Text(f"{found['source']}; {found['recordings']} recordings; degrees, percent, ms a frame")
    )
    if "ms_per_frame_two_hands" in found:
        console.print(Text(f"two hands: {found['ms_per_frame_two_hands']:.2f} ms a frame (median)"))
    for name, row in found.get("couplings_v3", found.get("couplings", {})).items():
        console.print(
            Text(
                f"joints, coupling {name}: PIP {row['pip_deg']:.2f}, DIP {row['dip_deg']:.2f}, "
                f"PIP+DIP {row['pip_dip_deg']:.2f}"
            )
        )
    for name, row in found.get("plausibility", {}).items():
        console.print(
            Text(
                f"{name}, no truth: of {row['fingers']} seen fingers, "
                f"{100 * row['backward']:.1f} % with the knuckle at its backward limit, "
                f"{100 * row['claws']:.1f} % claws, "
                f"{100 * row['at_limit']:.1f} % with another joint at a limit; fingertips of the "
                f"pose within {1000 * row['tips']:.1f} mm (95 %) of where the device saw them"
            )
        )
    for what, why in found.get("left_out", {}).items():
        console.print(Text(f"left out: {what}: {why}"))


SIMULATED_FIT = Coupling(0.631, 1.596)
"""DIP coupling, fitted by least squares to gestures of the simulated persons 0 to 9. These persons
are never used for tests."""
