"""Finds the participant and the number of a session."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console

from models.errors import StudyError
from models.person import Person
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.pseudonym import read_pseudonym
from sandbox.study.record.stored_sessions import has_finished, sessions_of
from sandbox.study.run.simulated_study import simulated_person

if TYPE_CHECKING:
    from sandbox.cli.study.run_options import StudyRunOptions


def find_participant(options: StudyRunOptions, study: StudyFolder, console: Console) -> Participant:
    """Returns the participant that the options name, or a new participant.

    Raises:
        StudyError: The options name an unknown participant, or are not valid for a new participant.
    """
    if options.participant and options.participant != "new":
        known = read_pseudonym(options.participant)
        person = study.find(known, "`--participant new` adds a participant")
        _check_same(options, person)
        if study.is_released(person.ppid):
            raise StudyError(
                "the number of this participant was freed for another participant",
                where="--participant",
                got=person.ppid,
                remedy=f"`sandbox study note {study.path} --participant {person.ppid} --include "
                '"REASON"` undoes this',
            )
        return person
    unfinished = [person.ppid for person in study.participants() if _comes_again(study, person)]
    if not options.participant:
        raise StudyError(
            "the participant is missing",
            where="--participant",
            expected=", ".join(("new", *unfinished)),
        )
    if options.session not in (None, 1):
        raise StudyError(
            "a new participant begins with session 1",
            where="--session",
            got=options.session,
            remedy="Leave out --session",
        )
    if unfinished:
        console.print(f"[yellow]not finished yet: {', '.join(unfinished)}[/]")
    language = study.design.language_of(options.language)
    checked = Person(options.hand, options.hand_size)
    if options.device == "simulated":
        drawn = simulated_person(study.design, len(study.participants()) + 1)
        # Options that differ from their defaults replace the values that were drawn.
        if checked.hand != "right":
            drawn["hand"] = checked.hand
        if checked.hand_size != 1.0:
            drawn["hand_size"] = checked.hand_size
        return study.add(**drawn)
    return study.add(hand=checked.hand, hand_size=checked.hand_size, language=language)


def _check_same(options: StudyRunOptions, person: Participant) -> None:
    """Checks that options about the participant agree with what is known of this participant.

    Raises:
        StudyError: An option differs. A default value counts as not given.
    """
    asked = {
        "--hand": (options.hand, "right", person.hand),
        "--hand-size": (options.hand_size, 1.0, person.hand_size),
        "--language": (options.language, "", person.language),
    }
    for option, (given, default, known) in asked.items():
        if given not in (default, known):
            raise StudyError(
                "this participant began with another value, which stays for all sessions",
                where=f"{option} {given}",
                expected=str(known),
                remedy=f"Leave out {option}",
            )


def next_session(study: StudyFolder, person: Participant) -> int:
    """Returns the number of a participant's first unfinished session, or of the last session."""
    done = {s.number for s in sessions_of(study, person) if s.state.complete}
    planned = study.design.sessions
    return next((n for n in range(1, planned + 1) if n not in done), planned)


def has_begun(study: StudyFolder, person: Participant, number: int) -> bool:
    """True if a participant has begun the session with this number."""
    return number in {session.number for session in sessions_of(study, person)}


def _comes_again(study: StudyFolder, person: Participant) -> bool:
    """True if a participant is not excluded and has a session that is not finished."""
    excluded = any(s.state.excluded_participant for s in sessions_of(study, person))
    return not (excluded or study.is_released(person.ppid) or has_finished(study, person))
