"""Sentences on changes of a study by `--force-upgrade` after the first participation."""

from __future__ import annotations

from collections.abc import Iterator

from models.message import counted
from sandbox.study.design.design import Design
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.notes import ANONYMISED, UPGRADE


def upgrades_of(study: StudyFolder) -> tuple[str, ...]:
    """Returns sentences, from the notes, on every change that was forced after the first
    participation."""
    notes = study.records()
    if any(note["kind"] == ANONYMISED for note in notes):
        return tuple(_of_anonymous_copy(study))
    sentences = []
    for note in notes:
        if note["kind"] != UPGRADE or not note["people"]:
            continue
        what = ", ".join(str(name) for name in note["changed"])
        before, after = (_design(study, note[k].get("design", "")) for k in ("before", "after"))
        sentences.append(
            f"After {counted(note['people'], 'participant')} had begun, the study was changed "
            f"(--force-upgrade): {what}. The reason given: {note['reason']}."
            f"{_differences(before, after)}"
        )
    return tuple(sentences)


def _of_anonymous_copy(study: StudyFolder) -> Iterator[str]:
    """Sentences on the changes of an anonymous copy, which has no reasons or order of people."""
    for digest in sorted({*study.session_designs()} - {study.design.digest}):
        yield (
            f"Some sessions were run by an earlier design ({digest}), before the study was "
            f"changed (--force-upgrade).{_differences(_design(study, digest), study.design)}"
        )


def _design(study: StudyFolder, digest: str) -> Design | None:
    """The design with a digest; None if no session has it or it cannot be read."""
    found = study.design_of(digest)
    return found if found.digest == digest else None


def _differences(before: Design | None, after: Design | None) -> str:
    """Sentences on the differences of two designs that change the meaning of results.

    Each begins with a space.
    """
    known = _meanings(before, after) if before and after else ()
    return "".join(f" {sentence}." for sentence in known)


def _meanings(before: Design, after: Design) -> Iterator[str]:
    """Yields sentences on changed primary outcomes, and on levels whose settings have changed under
    the same name."""
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
