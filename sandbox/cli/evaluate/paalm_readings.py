"""`sandbox evaluate --paalm simulated --readings`: what each open question of the paper costs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from encoders.evaluation.paalm_judge import judge_recording, summary
from encoders.paalm import EQUAL, PAPER, Coupling, PaalmOptions
from encoders.paalm.simulated.air import simulate_air
from encoders.paalm.simulated.forward import LeapTake, leap_take
from encoders.paalm.simulated.leap_configuration import FROZEN_LEAP
from sandbox.devices.simulated.in_air import LeapDisturbance

FIRST_PERSON = 100
"""Simulated persons to choose readings by; below 200, as all seeds of development are."""

SIMULATED_FIT = Coupling(0.631, 1.596)
"""Least squares over the gestures of the simulated persons 0 to 9, who are never judged."""

DEFAULT = PaalmOptions()
READINGS: dict[str, PaalmOptions] = {
    "default": DEFAULT,
    "identity: paper": replace(DEFAULT, identity="paper"),
    "solve: lengths": replace(DEFAULT, solve="lengths"),
    "direction: device": replace(DEFAULT, solve="lengths", direction="device"),
    "direction: knuckle_to_tip": replace(DEFAULT, solve="lengths", direction="knuckle_to_tip"),
    "first_joint: direction": replace(DEFAULT, first_joint="direction"),
    "first_joint: direction, by lengths": replace(
        DEFAULT, solve="lengths", first_joint="direction"
    ),
    "hidden: 0": replace(DEFAULT, solve="lengths", hidden=0.0),
    "behind: 0": replace(DEFAULT, behind=0.0),
    "behind: 0.45": replace(DEFAULT, behind=0.45),
    "open_bend: 0": replace(DEFAULT, open_bend=0.0),
    "open_bend: 10": replace(DEFAULT, open_bend=10.0),
    "coupling: equal": replace(DEFAULT, coupling=EQUAL),
    "coupling: fitted": replace(DEFAULT, coupling=SIMULATED_FIT),
    "hold: device": replace(DEFAULT, hold="device"),
    "vanished: folded": replace(DEFAULT, vanished="folded"),
    "smoothing: 0": replace(DEFAULT, smoothing=0.0),
    "all as printed": PAPER,
}

ROUGH = replace(LeapDisturbance(2.0).applied(FROZEN_LEAP), lost_rate=4 * FROZEN_LEAP.lost_rate)
"""A device twice as noisy that loses fingers four times as often."""


def judge_readings(takes: int, shown: Callable[[float], None]) -> dict[str, Any]:
    """Every reading with and without drop-outs, and the default on a worse device.

    Nobody is measured: lengths of the first software vary too much for a reading by lengths.
    """
    hands = [(s, simulate_air(s)) for s in range(FIRST_PERSON, FIRST_PERSON + takes)]
    conditions: dict[str, list[tuple[int, LeapTake]]] = {
        "v1": [(s, leap_take(hand, s)) for s, hand in hands],
        "without_drop_outs": [(s, leap_take(hand, s, drop_outs=False)) for s, hand in hands],
    }
    readings: dict[str, Any] = {}
    for done, (name, options) in enumerate(READINGS.items()):
        readings[name] = {
            condition: _figures(
                [
                    judge_recording(str(s), t, options, names=False, measured=False)
                    for s, t in seen_takes
                ]
            )
            for condition, seen_takes in conditions.items()
        }
        shown((done + 1) / (len(READINGS) + 1))
    rough = [judge_recording(str(s), leap_take(hand, s, configuration=ROUGH)) for s, hand in hands]
    return {
        "source": "SIMULATED hands, simulated Leap: no person and no device",
        "seeds": [s for s, _ in hands],
        "readings": readings,
        "rough_device": _figures(rough) | {"identity_percent": summary(rough)["identity_percent"]},
    }


def _figures(judgements: list[Any]) -> dict[str, Any]:
    figures = summary(judgements)
    keys = ("mcp_deg", "mcp_spread_deg", "pip_deg", "dip_deg", "pip_dip_deg", "thumb_cmc_deg")
    kept = {k: figures[k] for k in (*keys, "thumb_mcp_deg", "jitter_deg")}
    return kept | {"seen_pip_deg": figures["seen_fingers"]["pip_deg"]}


def show_readings(found: dict[str, Any]) -> None:
    """The table that docs/paalm.md quotes."""
    table = Table("reading", "MCP", "PIP", "DIP", "PIP seen", "jitter", "no drop-outs: MCP", "PIP")
    table.add_column("DIP")
    table.add_column("thumb CMC, MCP")
    for name, row in found["readings"].items():
        all_of_it, whole = row["v1"], row["without_drop_outs"]
        cells = [all_of_it[k] for k in ("mcp_deg", "pip_deg", "dip_deg", "seen_pip_deg")]
        cells += [all_of_it["jitter_deg"]]
        cells += [whole[k] for k in ("mcp_deg", "pip_deg", "dip_deg")]
        thumb = f"{whole['thumb_cmc_deg']:.1f}, {whole['thumb_mcp_deg']:.1f}"
        table.add_row(name, *(f"{c:.2f}" for c in cells), thumb)
    console = Console()
    console = Console(width=max(console.width, 140))
    console.print(table)
    rough = found["rough_device"]
    names = rough["identity_percent"]
    console.print(
        Text(
            f"a device twice as noisy, four times as forgetful: names {names['tracked']:.2f} % "
            f"tracked, {names['paper']:.2f} % paper; PIP of seen fingers "
            f"{rough['seen_pip_deg']:.2f}"
        )
    )
    console.print(Text(f"{found['source']}; degrees; persons {found['seeds']}"))
