"""A player whose task is in a file of their own: the page's menu has it, and comes back to it."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from sandbox.play.page_play import PagePlay
from sandbox.play.pages import EASIEST_FIRST, open_page
from sandbox.play.player_requests import PlayerRequests
from sandbox.server.page_options import PageOptions
from sandbox.server.protocol import PlayerRequest
from sandbox.trial.logs import EventLog
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions
from tasks.registry import TASKS, hands_of
from tests.sandbox.play.played_page import played
from tests.support.page_client import Page

TASK = """
from tasks.box_to_goal import BoxToGoal


class Push(BoxToGoal):
    name = "lab-push"
"""


def own_task(folder: Path) -> str:
    file = folder / "push.py"
    file.write_text(TASK)
    return f"{file}:Push"


def test_another_task_is_chosen_and_then_the_players_own_again(tmp_path: Path) -> None:
    own = own_task(tmp_path)
    server = open_page(PageOptions(), task=own)
    play = PagePlay(
        TrialOptions(task=own, device="web"), (server,), EventLog(None), Console(quiet=True)
    )
    try:
        with played(play, server), Page(server.url) as page:
            assert "lab-push" in [task["name"] for task in page.until("welcome")["tasks"]]
            assert page.until("scene")["task"] == "lab-push"
            page.say(type="ask", what="task", value="wrench-turn")
            assert page.until("scene", task="wrench-turn")
            page.say(type="ask", what="task", value="lab-push")
            assert page.until("scene", task="lab-push")
    finally:
        server.close()


def test_every_built_in_task_of_one_hand_has_its_place_in_the_order_of_difficulty() -> None:
    names = [name for name, kind in TASKS.items() if hands_of(kind) == 1]
    assert sorted(EASIEST_FIRST) == sorted(names)


def test_a_task_that_is_on_no_menu_is_no_request(tmp_path: Path) -> None:
    own = own_task(tmp_path)
    requests = PlayerRequests.of(Settings(task=own))
    requests.take([PlayerRequest("task", "lab-pull"), PlayerRequest("task", own)])
    assert requests.task == own and not requests.again
    requests.take([PlayerRequest("task", "stack")])
    assert requests.task == "stack" and requests.again
    requests.take([PlayerRequest("task", "lab-push")])
    assert requests.task == own
