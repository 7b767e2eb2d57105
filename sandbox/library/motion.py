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
    of: Literal["simulated", "commanded"] | None = None,
    settings: ExportSettings | None = None,
) -> tuple[Path, ...]:
    """Writes the hands' motion of a recording, a capture or a Leap for another program.

    Args:
        source: A recording, a capture (.npz), or a recording of a Leap, whose hands PAALM makes.
        to: File to write; its ending chooses the format: .bvh, .glb, .amc, .v, .vsk, .c3d or .csv.
            A file that exists is replaced.
        rate: Hz of the keys.
        of: For recordings of sessions. `simulated`, the default: the hand as it moved.
            `commanded`: the pose that the touches asked for.
        settings: More choices, such as the Euler order; its rate replaces `rate`.

    Returns:
        The files that were written; two hands in a format for one make two files.

    Warns:
        UserWarning: The source is damaged, or its replay differs; what could be read is written. Or
            a hand over a Leap was not measured.

    Raises:
        InputError: The source cannot be read, or the file cannot be written.
    """
    opened = open_source(Path(source), of)
    for remark in opened.remarks:
        warnings.warn(f"{source}: {remark}", stacklevel=2)
    chosen = settings or ExportSettings(rate)
    with Exporter(Path(to), opened.armatures, opened.names, chosen) as exporter:
        damage = opened.play(exporter.take)
    for text in filter(None, (damage, opened.report.line())):
        warnings.warn(f"{source}: {text}", stacklevel=2)
    return tuple(exporter.paths)
