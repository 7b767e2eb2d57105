"""Export of a hand's motion from Python."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Literal

from sandbox.export.sources import open_source
from sandbox.export.targets import Exporter, ExportSettings


def export_motion(
    source: Path | str,
    to: Path | str,
    *,
    rate: float = 60.0,
    of: Literal["simulated", "commanded"] = "simulated",
    settings: ExportSettings | None = None,
) -> tuple[Path, ...]:
    """Writes the hands' motion of a recording or capture for another program.

    Args:
        source: A recording, or a capture (.npz).
        to: File to write; its ending chooses the format: .bvh, .glb, .amc, .v, .vsk, .c3d or .csv.
            A file that exists is replaced.
        rate: Hz of the keys.
        of: `simulated`: the hand as it moved. `commanded`: the pose that the touches asked for.
        settings: More choices, such as the Euler order; its rate replaces `rate`.

    Returns:
        The files that were written; two hands in a format for one make two files.

    Warns:
        UserWarning: The source is damaged, or its replay differs; what could be read is written.

    Raises:
        InputError: The source cannot be read, or the file cannot be written.
    """
    opened = open_source(Path(source), of)
    chosen = settings or ExportSettings(rate)
    with Exporter(Path(to), opened.armatures, opened.names, chosen) as exporter:
        damage = opened.play(exporter.take)
    if damage:
        warnings.warn(f"{source}: {damage}", stacklevel=2)
    return tuple(exporter.paths)
