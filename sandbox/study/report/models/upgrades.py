"""What a study's journal says of changes by `--force-upgrade` after somebody had taken part."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from models.errors import HandSandboxError, StudyError
from models.message import counted
from sandbox.study.design.design import Design
from sandbox.study.design.design_file import load_design
from sandbox.study.record.folder import ANONYMISED, DESIGN_FILE, EARLIER, STUDY_JOURNAL
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
    if any(record["kind"] == ANONYMISED for record in records):
        return tuple(_of_anonymous_copy(folder))
    told, begun = [], 0
    for record in records:
        begun += record["kind"] == "participant"
        if record["kind"] != "upgrade" or not begun:
            continue
        what = ", ".join(str(name) for name in record["changed"])
        before, after = (_design(folder, record[k].get("design", "")) for k in ("before", "after"))
        told.append(
            f"After {counted(begun, 'participant')} had begun, the study was changed "
            f"(--force-upgrade): {what}. The reason given: {record['reason']}."
            f"{_differences(before, after)}"
        )
    return tuple(told)


def _of_anonymous_copy(folder: Path) -> Iterator[str]:
    """The same of a copy, which has the designs, and neither an order of people nor reasons."""
    today = _design(folder, "")
    for path in sorted(folder.glob(f"{EARLIER}/*")):
        yield (
            f"Some sessions were run by an earlier design ({path.name}), before the study was "
            f"changed (--force-upgrade).{_differences(_design(folder, path.name), today)}"
        )


def _design(folder: Path, digest: str) -> Design | None:
    """The design of a digest, or today's without one; None where it was not kept, or cannot be
    read."""
    for path in (folder / EARLIER / digest / DESIGN_FILE, folder / DESIGN_FILE):
        try:
            design = load_design(path, try_out=False)
        except HandSandboxError:
            continue
        if design.digest == (digest or design.digest):
            return design
    return None


def _differences(before: Design | None, after: Design | None) -> str:
    """What a reader of the results must know of two designs, in sentences after a space."""
    known = _meanings(before, after) if before and after else ()
    return "".join(f" {sentence}." for sentence in known)


def _meanings(before: Design, after: Design) -> Iterator[str]:
    """Other primary outcomes, and other meanings of levels with the same names."""
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
