"""`sandbox study run`: runs a participant's session, on a page, in a window or in the terminal."""

from __future__ import annotations

import shlex
import time
import webbrowser
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from models.errors import StudyError
from models.message import counted
from models.person import Person
from sandbox.cli.common.lsl_options import streaming
from sandbox.cli.study.printing import say_findings, say_noted, sayer
from sandbox.cli.study.run_options import (
    StudyRunOptions,
    again,
    check_camera,
    check_leap,
    check_options,
    check_page,
    check_second_device,
    second_touch_device,
    touch_device,
)
from sandbox.views.display import has_display

if TYPE_CHECKING:
    from sandbox.server.page_options import PageOptions
    from sandbox.study.record.folder import Participant, StudyFolder
    from sandbox.study.record.session_folder import SessionFolder
    from sandbox.study.run.controls import Controls, Terminal
    from sandbox.study.run.forms import Forms, Poll
    from sandbox.study.run.players import TrialPlayer
    from sandbox.study.run.run_device import SessionCamera
    from sandbox.study.run.study_page import StudyPage
    from sandbox.study.run.task_pictures import TaskPictures
    from sandbox.trial.settings import Settings

LONG_PAUSE = 1800.0
"""Time (s) without a record after which a participant may have forgotten the practice."""
FAREWELL = 1.0
"""Time (s) for the page to receive its last message before the program ends."""


def run(options: StudyRunOptions, console: Console) -> int:
    """Runs a session, or the rest of an interrupted one."""
    from sandbox.study.design.checks import findings
    from sandbox.study.design.design_file import load_design
    from sandbox.study.record.folder import PILOT, REAL, StudyFolder, folder_of
    from sandbox.study.record.mirror import Mirror
    from sandbox.study.record.session_folder import SessionFolder
    from sandbox.study.run.controls import Controls, Terminal
    from sandbox.study.run.task_pictures import TaskPictures
    from sandbox.study.tables.tables import bring_up_to_date, make_tables

    check_options(options)
    check_page(options)
    design = load_design(options.file)
    check_leap(options, design)
    engine = check_camera(options, design)
    check_second_device(options, design)
    flaws = findings(design)
    say_findings(flaws, console)
    mode = PILOT if options.pilot else REAL
    wrong = [flaw for flaw in flaws if flaw.error]
    if wrong and mode == REAL and not folder_of(options.out, design.name, mode).exists():
        raise StudyError(
            "this design is not for real participants yet",
            where=str(options.file),
            got=str(wrong[0]),
            remedy="Correct the design, or try it with --pilot",
        )
    study = StudyFolder(options.out, design, mode, options.force_upgrade, options.site)
    say = sayer(console)
    say_noted(study, say)
    if options.force_upgrade and study.participants():
        # The tables must have the columns of the new design, even if no further session is run.
        make_tables(study, say)
    controls = Controls(say)
    terminal = Terminal(controls, answers=not options.has_page)
    person = find_participant(options, study, console)
    number = options.session or _next_session(study, person)
    if number > 1 and options.session is None and not _has_begun(study, person, number):
        say(
            f"{person.ppid} has finished session {number - 1} of {design.sessions}. Begin the next?"
        )
        if not _agreed(terminal, say, f"--session {number} begins that session"):
            say(f"session {number} was not begun")
            return 0
    found = shlex.join(["sandbox", "study", "report", str(study.path)])
    with SessionFolder(study, person, number) as session:
        done, of = session.state.done(session.steps)
        if session.resumed and not options.resume and not session.state.complete:
            far = f"{done} of {counted(of, 'trial')}"
            say(f"{person.ppid} has done {far}. Continue with the next trial?")
            if not _agreed(terminal, say, "--resume goes on"):
                say("nothing was played; the session can be resumed later")
                return 0
            offer_to_begin_again(session, terminal, say)
        of_several = f", session {number} of {design.sessions}" if design.sessions > 1 else ""
        if session.state.complete:
            bring_up_to_date(session, say)
            say(f"{person.ppid}{of_several}: complete, so nothing was played")
            say(f"for the results so far: {found}; the next person: --participant new")
            return 0
        say(
            f"participant {person.ppid}"
            + of_several
            + (", a pilot" if options.pilot else "")
            + f"; {'' if options.has_page else '/'}h and Enter show your keys"
        )
        with ExitStack() as closing:
            if options.mirror is not None:
                closing.enter_context(Mirror(study.path, person.ppid, options.mirror, say))
            clock = closing.enter_context(streaming(options.lsl, console))
            if clock:
                session.write("done", step="lsl", **clock)
            page = _open_page(options, session, console, closing)
            camera = _camera(options, session, engine, console, closing)
            pictures = None
            if page is not None:
                pictures = closing.enter_context(TaskPictures(_settings_left(session)))
            outcome = _play(options, session, page, camera, controls, terminal, console, pictures)
    say(f"{person.ppid}{of_several}: {outcome}")
    if outcome == "stopped":
        say(f"to continue: {again(options, person.ppid)}")
    say(f"the data are in {study.path}")
    say(f"for the results so far: {found}")
    return 0


def find_participant(options: StudyRunOptions, study: StudyFolder, console: Console) -> Participant:
    """Returns the participant that the options name, or a new participant.

    Raises:
        StudyError: The options name an unknown participant, or are not valid for a new participant.
    """
    from sandbox.study.record.pseudonym import read_pseudonym
    from sandbox.study.run.simulated_study import simulated_person

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


def _next_session(study: StudyFolder, person: Participant) -> int:
    """Returns the number of a participant's first unfinished session, or of the last session."""
    from sandbox.study.record.stored_sessions import sessions_of

    done = {s.number for s in sessions_of(study, person) if s.state.complete}
    planned = study.design.sessions
    return next((n for n in range(1, planned + 1) if n not in done), planned)


def _has_begun(study: StudyFolder, person: Participant, number: int) -> bool:
    """True if a participant has begun the session with this number."""
    from sandbox.study.record.stored_sessions import sessions_of

    return number in {session.number for session in sessions_of(study, person)}


def _comes_again(study: StudyFolder, person: Participant) -> bool:
    """True if a participant is not excluded and has a session that is not finished."""
    from sandbox.study.record.stored_sessions import has_finished, sessions_of

    excluded = any(s.state.excluded_participant for s in sessions_of(study, person))
    return not (excluded or study.is_released(person.ppid) or has_finished(study, person))


def _agreed(terminal: Terminal, say: Callable[[str], object], otherwise: str) -> bool:
    """Waits for an answer to a question that was printed; returns True if it is yes.

    Args:
        terminal: Terminal in which the experimenter answers.
        say: Prints the possible answers.
        otherwise: Option that answers the question, and its effect; for the error.

    Raises:
        StudyError: The input has ended without an answer.
    """
    from sandbox.study.run.controls import YES_OR_NO

    ended = partial(_input_ended, otherwise)
    return terminal.choose(YES_OR_NO, say, ended=ended, experimenter=True) == 0


def offer_to_begin_again(
    session: SessionFolder, terminal: Terminal, say: Callable[[str], object]
) -> None:
    """After a long pause in a block, asks whether the block begins again with its practice.

    Raises:
        StudyError: The input has ended without an answer.
    """
    from sandbox.study.design.session_plan import trials_of

    again = session.state.block_under_way(session.steps)
    if session.away <= LONG_PAUSE or not again:
        return
    minutes = f"{session.away / 60.0:.0f} min"
    trials = counted(len(trials_of(again)), "trial")
    say(
        f"{session.person.ppid} was away for {minutes}, after {trials} of this block. Continue "
        "with the next trial, or begin the block again with its instructions and practice? If it "
        "begins again, its earlier trials are stored but do not count"
    )
    ways = ("go on", "begin again")
    ended = partial(_input_ended, "--resume goes on")
    if terminal.choose(ways, say, ended=ended, experimenter=True) == 1:
        session.begin_again(again, f"begun again after {minutes}")


def _input_ended(otherwise: str) -> StudyError:
    """The error for a question without an answer.

    Args:
        otherwise: Option that answers the question, and its effect.
    """
    return StudyError(
        "the input has ended, so that the question cannot be answered",
        where="the terminal",
        remedy=f"Run the command in a terminal; {otherwise} without asking",
    )


def _open_page(
    options: StudyRunOptions, session: SessionFolder, console: Console, closing: ExitStack
) -> StudyPage | None:
    """Serves the participant's page, and prints how to open it; None without a page.

    With `--second-device web`, the page of the second hand is served, too.
    """
    if not options.has_page:
        return None
    two = options.second_device == "web"
    if two:
        console.print("for the participant:")
    page = _serve_page(options, options, session, console, closing)
    if two:
        console.print("for the second hand:")
        next_port = replace(options, page_port=options.page_port and options.page_port + 1)
        whose = "the second hand's page"
        page.beside = _serve_page(options, next_port, session, console, closing, whose)
    beside = options.touches != "web" and options.view == "window"
    if beside and has_display() and not options.no_browser:
        webbrowser.open(page.server.url)
    return page


def _serve_page(
    options: StudyRunOptions,
    where: PageOptions,
    session: SessionFolder,
    console: Console,
    closing: ExitStack,
    whose: str = "the participant's page",
) -> StudyPage:
    """Serves one page, and prints how to open it."""
    from models.surface import parse_surface
    from sandbox.play.pages import open_page, print_refusals, show_address
    from sandbox.study.design.conditions import any_lifts
    from sandbox.study.record.records import SCREEN
    from sandbox.study.run.study_page import StudyPage, study_view
    from sandbox.trial.logs import EventLog

    language, settings = session.person.language, session.study.design.page
    server = open_page(where, study_view(settings, language))
    closing.callback(lambda: print_refusals(server, console))
    closing.callback(server.close)
    page = StudyPage(server, language, sayer(console), settings.words.get(language), whose)
    page.record = partial(session.write, SCREEN)
    surface = session.study.design.settings.get("surface")
    if surface is not None and options.touches == "web":
        designed = parse_surface(surface)
        page.needed_in = designed.width_in, designed.height_in
        page.needed_lifts = any_lifts(session.study.design)
    show_address(server, where, EventLog(None), console)
    return page


def _camera(
    options: StudyRunOptions,
    session: SessionFolder,
    engine: Path | None,
    console: Console,
    closing: ExitStack,
) -> SessionCamera | None:
    """The session's camera, which the first trial that needs it switches on; None without an
    engine."""
    from sandbox.study.run.run_device import SessionCamera, before_cameras

    if engine is None:
        return None
    sides = [
        hand.side
        for settings in _settings_left(session)
        for hand, there in zip(settings.hands, before_cameras(settings), strict=True)
        if there
    ]
    browse = has_display() and not options.no_browser
    return closing.enter_context(
        SessionCamera(engine, list(dict.fromkeys(sides)), browse, sayer(console))
    )


def _settings_left(session: SessionFolder) -> list[Settings]:
    """Settings of the trials of a session that are not finished."""
    from sandbox.study.design.conditions import run_settings
    from sandbox.study.design.session_plan import trials_of

    person, done = session.person, session.state.finished
    return [
        run_settings(step.values, step.seed, person.hand, person.hand_size, session.study.settings)
        for step in trials_of(session.steps)
        if step.id not in done
    ]


def _play(
    options: StudyRunOptions,
    session: SessionFolder,
    page: StudyPage | None,
    camera: SessionCamera | None,
    controls: Controls,
    terminal: Terminal,
    console: Console,
    pictures: TaskPictures | None,
) -> str:
    from sandbox.study.run.forms import TerminalForms
    from sandbox.study.run.page_forms import PageForms, measure_screens
    from sandbox.study.run.run_device import hand_measurer, person_devices, settings_fitter
    from sandbox.study.run.runner import SessionRunner

    person, name = session.person, options.touches
    touch, second = touch_device(options), second_touch_device(options)
    say, leap, repeated = sayer(console), options.leap_address, again(options, person.ppid)
    # A simulated hand in the air differs in every trial, so it is not measured.
    simulated = options.device == "simulated"
    forms: Forms
    if page is not None and options.forms != "terminal":
        forms = PageForms(page, lambda: controls.paused)
    else:
        if simulated:
            say("questions come here in the terminal; `sandbox study simulate` asks no questions")
        forms = TerminalForms(terminal, lambda text: console.print(text, markup=False), repeated)
    player = _player(options, session, page)
    own = session.study.design.page.words.get(person.language)
    calibrate = (
        _average if simulated else hand_measurer(forms, person, leap, say, own=own, again=repeated)
    )
    other = second or touch
    runner = SessionRunner(
        session,
        player,
        person_devices(touch, person, page, leap, second, camera),
        forms,
        controls,
        say,
        touch,
        settings_fitter(name, page, other.name, camera),
        calibrate,
        second_device=other,
        before_step=(
            partial(measure_screens, page)
            if page is not None and options.touches == "web"
            else lambda poll: None
        ),
        picture_of=pictures.of if pictures is not None else lambda task, poll: "",
    )
    try:
        outcome = runner.run()
        if page is not None and outcome != "stopped":
            for each in page.pages:
                each.show_sheet("end", text=each.texts["end"])
            time.sleep(FAREWELL)
        return str(outcome)
    finally:
        player.close()


def _average(poll: Poll) -> None:
    """Skips the measurement of a simulated hand."""


def _player(
    options: StudyRunOptions, session: SessionFolder, page: StudyPage | None
) -> TrialPlayer:
    from sandbox.study.run.page_player import PagePlayer
    from sandbox.study.run.players import HeadlessPlayer, WindowPlayer
    from sandbox.study.run.study_page import OffPagePlayer

    if page is not None and options.touches == "web":
        return PagePlayer(page, session.study.design.page, session.person.language)
    simulated = options.device == "simulated"
    player: TrialPlayer = HeadlessPlayer(paced=not simulated)
    if options.view == "window":
        player = WindowPlayer("simulated user" if simulated else "")
    return player if page is None else OffPagePlayer(player, page)
