"""What a study's journal says of changes by `--force-upgrade` after somebody had taken part."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from models.errors import HandSandboxError, StudyError
from models.messages.wording import counted
from sandbox.study.design.design import Design
from sandbox.study.design.design_file import load_design
from sandbox.study.record.folder import DESIGN_FILE, EARLIER, STUDY_JOURNAL
from sandbox.study.record.journal import read_journal


def upgrades_of(folder: Path) -> tuple[str, ...]:
    """Returns sentences on every change that was forced after somebody had taken part.

    Args:
        folder: Folder of the study. Without a readable journal, as in a folder of tables alone, it
            tells nothing.
    """
    path = folder / STUDY_JOURNAL
    try:
        records = read_journal(path) if path.is_file() else []
    except StudyError:
        return ()
    told, begun = [], 0
    for record in records:
        begun += record["kind"] == "participant"
        if record["kind"] != "upgrade" or not begun:
            continue
        what = ", ".join(str(name) for name in record["changed"])
        before, after = (_design(folder, record[k].get("design", "")) for k in ("before", "after"))
        inside = list(_differences(before, after)) if before and after else []
        told.append(
            f"The study was changed by force after {counted(begun, 'participant')} had begun: "
            f"{what}. The reason given: {record['reason']}."
            + "".join(f" {sentence}." for sentence in inside)
        )
    return tuple(told)


def _design(folder: Path, digest: str) -> Design | None:
    """The design of a digest, among those that were kept; None where it cannot be read."""
    for path in (folder / EARLIER / digest / DESIGN_FILE, folder / DESIGN_FILE):
        try:
            design = load_design(path, try_out=False)
        except HandSandboxError:
            continue
        if design.digest == digest:
            return design
    return None


def _differences(before: Design, after: Design) -> Iterator[str]:
    """What a reader of the results must know: other primary outcomes, other meanings of levels."""
    if before.primary != after.primary:
        names = [", ".join(design.primary) or "none" for design in (before, after)]
        yield f"Primary outcomes were {names[0]} before and are {names[1]}"
    known = {(f.name, level.name): level.settings for f in before.factors for level in f.levels}
    for factor in after.factors:
        for level in factor.levels:
            had = known.get((factor.name, level.name), level.settings)
            for name in sorted({*had, *level.settings}):
                one, other = had.get(name), level.settings.get(name)
                if one != other:
                    yield (
                        f"Trials of {factor.name} {level.name} had {name} {_value(one)} before and "
                        f"{_value(other)} after, under one name"
                    )


def _value(value: object) -> str:
    return "as in all trials" if value is None else str(value) or "nothing"
