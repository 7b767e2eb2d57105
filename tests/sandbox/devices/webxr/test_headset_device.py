"""The headset's device behind its server, and trials, recordings and replays with it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal
from urllib.request import urlopen

import numpy as np
import pytest
from websockets.sync.client import ClientConnection, connect

from encoders.air.joint_fit import TIPS
from models.frames import HandFrame
from sandbox.cli.main import main
from sandbox.devices.webxr.joints import controller_points
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.play.pages import show_session, touched_pages
from sandbox.recording.recording import load_recording
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import PROTOCOL
from sandbox.server.static import HEADSET, StaticFiles
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.settings import recorded_settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.encoders.air.joint_hands import joints, points, seen
from tests.support.processes import until

SCREEN = {"px_per_in": 110.0, "width_px": 800.0, "height_px": 600.0, "calibrated": False}


@dataclass
class Headset:
    """A served scene whose hand is a headset's."""

    server: PageServer
    device: HeadsetDevice

    @contextmanager
    def page(self) -> Iterator[ClientConnection]:
        base, _, query = self.server.url.partition("/?")
        address, headers = f"{base.replace('http', 'ws')}/?{query}", {"Origin": base}
        with connect(address, additional_headers=headers, compression=None) as socket:
            self._greet(socket)
            yield socket

    def _greet(self, socket: ClientConnection) -> None:
        hello = {"type": "hello", "protocol": PROTOCOL, "client": "headset", "role": "player"}
        socket.send(json.dumps({**hello, "screen": SCREEN}))
        assert json.loads(socket.recv(timeout=5))["role"] == "player"

    def frame(self, accept: Callable[[HandFrame], bool]) -> HandFrame:
        """The next frame of a kind."""
        end = time.monotonic() + 5.0
        while time.monotonic() < end:
            for frame in self.device.poll():
                if accept(frame):
                    return frame
            time.sleep(0.005)
        raise AssertionError("no such frame")


@pytest.fixture
def headset() -> Iterator[Headset]:
    server = PageServer(files=StaticFiles(index=HEADSET))
    chosen = trial_settings(TrialOptions(device="webxr"))
    session = build(chosen, device_makers(chosen))
    ((own, device),) = touched_pages(session)
    assert isinstance(device, HeadsetDevice)
    show_session(server, session, "right", "", device, own)
    yield Headset(server, device)
    session.close()
    server.close()


def send(socket: ClientConnection, seq: int, *hands: dict[str, object], **more: object) -> None:
    socket.send(json.dumps({"type": "hands", "seq": seq, "t": 0.0, "hands": hands, **more}))


def test_both_hands_of_a_page_come_with_all_joints(headset: Headset) -> None:
    with headset.page() as page:
        send(page, 1, joints(1), joints(2, "left"))
        frame = headset.frame(lambda f: len(f.hands) == 2)
    assert [h.side for h in frame.hands] == ["right", "left"]
    for hand, told in zip(frame.hands, (joints(1), joints(2, "left")), strict=True):
        places = told["joints"]
        assert isinstance(places, list)
        assert hand.wrist == pytest.approx(places[0])
        assert hand.fingers[1].joints == tuple(map(tuple, places[6:10]))
    assert headset.device.applied == 1


def test_a_hand_is_seen_until_its_page_closes(headset: Headset) -> None:
    with headset.page() as page:
        assert not headset.device.touched
        send(page, 1, joints())
        until(lambda: headset.device.touched)
        assert not headset.server.away
    until(lambda: not headset.device.touched)
    assert headset.frame(lambda f: not f.hands).hands == ()
    until(lambda: headset.server.away)


def test_a_headset_that_is_taken_off_is_away_and_back(headset: Headset) -> None:
    with headset.page() as page:
        send(page, 1, joints())
        page.send(json.dumps({"type": "presence", "here": False}))
        until(lambda: headset.server.away)
        page.send(json.dumps({"type": "presence", "here": True}))
        until(lambda: not headset.server.away)


def test_what_is_no_hand_is_refused_and_the_next_one_comes(headset: Headset) -> None:
    flat: dict[str, object] = {"side": "right", "joints": [[0.0, 0.0, 0.0]] * 25}
    with headset.page() as page:
        send(page, 1, {"side": "right", "joints": [[0.0, 0.0, 0.0]] * 24})
        send(page, 2, {"side": "right", "joints": [[1e9, 0.0, 0.0]] * 25})
        send(page, 3, flat)
        send(page, 4, joints())
        assert headset.frame(lambda f: bool(f.hands)).hands
    assert headset.server.counters["malformed message"] == 1
    assert headset.device.counts["hands without a palm"] == 1
    assert headset.device.counts["the joints of a hand lie on each other"] == 1


# Single joints that are lost: webxr-hand-input 91 and 60.
@pytest.mark.parametrize("place", [None, [None, 0.1, 0.2], [0.1, 1e9, 0.2], [0.1, 0.2, -1e300]])
def test_a_joint_without_a_place_costs_its_finger_alone_and_ends_no_connection(
    headset: Headset, place: object
) -> None:
    """A headset's NaN is null in JSON."""
    broken, other = joints(1), joints(2, "left")
    assert isinstance(broken["joints"], list)
    broken["joints"][8] = place
    with headset.page() as page:
        for seq in range(1, 300):
            send(page, seq, broken, other)
        right, left = headset.frame(lambda f: len(f.hands) == 2).hands
        until(lambda: headset.device.counts["hands without a finger"] == 299)
        send(page, 300, joints(1))
        assert len(headset.frame(lambda f: len(f.hands) == 1).hands[0].fingers) == 5
    assert (len(right.fingers), len(left.fingers)) == (4, 5)
    assert headset.server.counters["malformed message"] == 0


def test_a_third_hand_and_a_lost_controller_cost_no_other(headset: Headset) -> None:
    lost = {"side": "left", "position": [None] * 3, "quaternion": [None] * 4, "trigger": None}
    still = {**lost, "position": [0.0, 0.0, 0.1]}
    message = {"type": "hands", "seq": 1, "t": None, "hands": [joints(1), joints(2), joints(3)]}
    with headset.page() as page:
        page.send(json.dumps({**message, "controllers": [lost, still]}))
        (hand,) = headset.frame(lambda f: bool(f.hands)).hands
    assert hand.side == "right"
    assert headset.device.counts == {
        "no place": 1,
        "not a unit quaternion": 1,
        "further hands of the same side": 2,
    }


def test_a_controller_is_a_hand_that_pinches(headset: Headset) -> None:
    held: dict[str, object] = {
        "side": "right",
        "position": [0.1, 0.0, 0.2],
        "quaternion": [1.0, 0.0, 0.0, 0.0],
    }
    gaps = []
    with headset.page() as page:
        for trigger in (0.0, 1.0):
            send(page, 1, controllers=[{**held, "trigger": trigger}])
            (hand,) = headset.frame(lambda f: bool(f.hands)).hands
            tips = [np.array(f.tip) for f in hand.fingers]
            gaps.append(float(np.linalg.norm(tips[0] - tips[1])))
    assert gaps[0] > 0.08 and gaps[1] < 0.016


def test_a_controller_s_hand_has_its_back_along_x_and_is_mirrored_for_the_left() -> None:
    upright = np.array([1.0, 0.0, 0.0, 0.0])
    right = controller_points("right", 0.3, np.zeros(3), upright)
    left = controller_points("left", 0.3, np.zeros(3), upright)
    assert left == pytest.approx(right * [-1.0, 1.0, 1.0])
    # The tips meet in front of the palm: at -x of a right hand, whose thumb is at -z.
    assert right[TIPS : TIPS + 3, 0].max() < -0.03
    assert right[TIPS, 2] < right[TIPS + 4, 2]


@pytest.mark.parametrize("side", ["right", "left"])
def test_the_palm_of_a_flat_hand_faces_down(side: str) -> None:
    at = points(np.zeros(48)) * ([-1.0, 1.0, 1.0] if side == "left" else [1.0, 1.0, 1.0])
    hand = seen(at, side)
    assert hand.normal[2] < -0.95 and hand.direction[1] > 0.95


def test_the_size_of_the_person_s_hand_is_known_after_a_moment(headset: Headset) -> None:
    assert headset.device.hand_size is None
    with headset.page() as page:
        send(page, 1, joints(3, size=1.1))
        headset.frame(lambda f: bool(f.hands))
    assert headset.device.hand_size == pytest.approx(1.1, abs=1e-3)


def test_the_address_shows_the_headset_s_page(headset: Headset) -> None:
    body = urlopen(headset.server.url, timeout=5).read().decode()
    assert "headset.js" in body and "app.js" not in body and "{{" not in body


def test_a_trial_in_a_simulated_headset_is_recorded_and_replays_to_the_bit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "trial.jsonl"
    assert main(["run", "box-to-goal", "--device", "webxr-simulated", "--record", str(file)]) == 0
    assert main(["replay", str(file)]) == 0
    assert "equal to the bit" in capsys.readouterr().out
    recording = load_recording(file)
    frames = [entry.frame for entry in recording.inputs[0]]
    last = frames[-1]
    assert all(isinstance(frame, HandFrame) for frame in frames) and isinstance(last, HandFrame)
    joints = [f.joints for f in last.hands[0].fingers]
    assert len(joints) == 5 and all(joints)
    settings = recorded_settings(recording.header)
    assert settings.hands[0].in_air is not None and settings.hands[0].in_air.joints


@pytest.mark.parametrize(("task", "hand"), [("box-to-goal", "left"), ("stack", "right")])
def test_the_simulated_person_succeeds(task: str, hand: Literal["left", "right"]) -> None:
    chosen = trial_settings(TrialOptions(task=task, device="webxr-simulated", hand=hand))
    result = play_trial(chosen)
    assert result.success, result.reason
