"""The camera's page in a real browser: what it sends, what it tells, and what it never asks for.

An engine of a few lines stands in for MediaPipe: it says what the test tells it to have seen. Tests
with the fetched engine are marked `full`.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest

from encoders.air.camera import Camera
from models.frames import LandmarkFrame, SeenHand
from sandbox.devices.webcam.engine import install, installed_engine
from sandbox.devices.webcam.webcam import CLOSED, ENDED, NOTICES, REPLACED, WebcamDevice
from sandbox.recording.recording import load_recording
from sandbox.study.run.runner import SessionOutcome
from sandbox.trial.replay import replay
from tests.encoders.air.seen_hands import SIZE, held_up, seen
from tests.sandbox.study.run.study_before_camera import CameraSession
from tests.support.chromium import BINARY, Browser, Tab
from tests.support.processes import PATIENCE
from tests.support.webcam_films import VIEWS, film, poses_of
from tests.support.webcam_films import seen as watch

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

FAKE_CAMERA = ("--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream")
NO_CAMERA = ("--use-fake-device-for-media-stream=device-count=0",)
REFUSED = ("--use-fake-device-for-media-stream", "--deny-permission-prompts")

ENGINE = """
const none = { landmarks: [], worldLandmarks: [], handedness: [] };
export class FilesetResolver {
  static isSimdSupported() { return Promise.resolve(true); }
}
export class HandLandmarker {
  static createFromOptions(files, options) {
    if (globalThis.broken) return Promise.reject(new Error("no WebAssembly here"));
    globalThis.asked = options.numHands;
    return Promise.resolve(new HandLandmarker());
  }
  detectForVideo(video, time) { return globalThis.found ?? none; }
}
"""


@cache
def hand_before() -> SeenHand:
    """The hand that the engine finds."""
    return seen(held_up(30.0), Camera())


def found(*sides: str) -> str:
    """What the engine finds: the same hand for every side, as a script."""
    points = [{"x": x / SIZE[0], "y": y / SIZE[1], "z": 0.0} for x, y in hand_before().image]
    space = [{"x": x, "y": y, "z": z} for x, y, z in hand_before().world]
    told = {
        "landmarks": [points] * len(sides),
        "worldLandmarks": [space] * len(sides),
        "handedness": [[{"categoryName": side.title(), "score": 0.9}] for side in sides],
    }
    return f"globalThis.found = {json.dumps(told)}; true"


LINE = "document.getElementById('line').textContent"


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("engine")
    (folder / "vision_bundle.mjs").write_text(ENGINE)
    return folder


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    browser = Browser(tmp_path_factory.mktemp("chromium"), FAKE_CAMERA)
    yield browser
    browser.close()


@pytest.fixture
def device(engine: Path) -> Iterator[WebcamDevice]:
    device = WebcamDevice(engine, ("right",))
    yield device
    device.close()


@pytest.fixture
def tab(browser: Browser, device: WebcamDevice) -> Iterator[Tab]:
    tab = browser.open(device.address)
    tab.wait(f"{LINE}.startsWith('No hand')")
    yield tab
    tab.close()


def soon(condition: Callable[[], object]) -> None:
    until = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)


def picture(device: WebcamDevice, accept: Callable[[LandmarkFrame], bool]) -> LandmarkFrame:
    """The next picture of a kind."""
    taken: list[LandmarkFrame] = []

    def look() -> bool:
        taken.extend(f for f in device.poll(0.0) if accept(f))
        return bool(taken)

    soon(look)
    return taken[0]


def test_landmarks_come_as_they_were_found(tab: Tab, device: WebcamDevice) -> None:
    tab.evaluate(found("right"))
    tab.wait(f"{LINE} === 'Your hand is followed.'")
    frame = picture(device, lambda f: bool(f.hands))
    (hand,) = frame.hands
    width, height = frame.size
    assert hand.side == "right" and hand.score == 0.9
    expected = np.array(hand_before().image) * [width / SIZE[0], height / SIZE[1]]
    assert np.array(hand.image) == pytest.approx(expected, abs=0.01)
    assert np.array(hand.world) == pytest.approx(np.array(hand_before().world), abs=1e-5)
    assert frame.time >= frame.taken > 0.0
    assert tab.evaluate("globalThis.asked") == 3


UNKNOWN = {
    "places in space": "found.worldLandmarks[1] = null",
    "all places in space": "found.worldLandmarks.length = 1",
    "one place in space": "found.worldLandmarks[1][8] = null",
    "a coordinate": "found.worldLandmarks[1][8].z = null",
    "a coordinate that is no number": "found.worldLandmarks[1][8].z = NaN",
    "places in the picture": "found.landmarks[1] = null",
    "a place in the picture": "found.landmarks[1][8].x = null",
    "side": "found.handedness[1] = []",
}
"""What the engine does not know of the second hand -> how the test takes it away."""


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_hand_that_the_engine_cannot_place_does_not_cost_the_other(
    tab: Tab, device: WebcamDevice, mirrored: bool
) -> None:
    side, other = ("left", "right") if mirrored else ("right", "left")
    if mirrored:
        tab.evaluate("document.getElementById('mirrored').click(); true")
    for lost in UNKNOWN.values():
        before = device.report.left_out["hands that cannot be read"]
        tab.evaluate("globalThis.found = undefined; true")
        tab.wait(f"{LINE}.startsWith('No hand')")
        tab.evaluate(f"{found(side, other)}; {lost}; true")
        tab.wait(f"{LINE} === 'Your hand is followed.'")
        device.poll(0.0)
        frame = picture(device, lambda f: bool(f.hands))
        assert [hand.side for hand in frame.hands] == ["right"]
        soon(lambda n=before: device.report.left_out["hands that cannot be read"] > n)  # type: ignore[misc]
    # Nor is such a hand followed where it is the only one.
    tab.evaluate(f"{found(side)}; found.worldLandmarks[0] = null; true")
    tab.wait(f"{LINE}.startsWith('No hand')")
    assert not device.notices


def test_a_mirrored_picture_is_turned_back(tab: Tab, device: WebcamDevice) -> None:
    tab.evaluate(found("left"))
    tab.evaluate("document.getElementById('mirrored').click(); true")
    frame = picture(device, lambda f: bool(f.hands) and f.hands[0].side == "right")
    width = frame.size[0]
    mirrored = [width - x * width / SIZE[0] for x, _ in hand_before().image]
    assert [x for x, _ in frame.hands[0].image] == pytest.approx(mirrored, abs=0.01)
    assert frame.hands[0].world[8][0] == pytest.approx(-hand_before().world[8][0], abs=1e-5)


def test_the_page_says_when_the_session_is_over_and_its_camera_goes_off(
    tab: Tab, device: WebcamDevice
) -> None:
    device.close()
    tab.wait(f"{LINE} === {ENDED!r}")
    states = "document.getElementById('video').srcObject.getTracks().map(t => t.readyState)"
    assert tab.evaluate(states) == ["ended"]
    assert tab.evaluate("document.getElementById('on').hidden")


def test_a_second_page_takes_over_and_the_first_says_so(
    tab: Tab, browser: Browser, device: WebcamDevice
) -> None:
    second = browser.open(device.address)
    tab.wait(f"{LINE} === {REPLACED!r}")
    second.wait(f"{LINE}.startsWith('No hand')")
    second.close()
    soon(lambda: device.notices == (CLOSED,))


def test_a_page_that_is_loaded_again_goes_on(tab: Tab, device: WebcamDevice) -> None:
    tab.call("Page.reload")
    soon(lambda: device.counts["pages closed"] == 1)
    tab.wait(f"{LINE}.startsWith('No hand')")
    soon(lambda: device.notices == ())


def test_an_engine_that_does_not_start_is_told(browser: Browser, device: WebcamDevice) -> None:
    tab = browser.open("about:blank")
    tab.call("Page.addScriptToEvaluateOnNewDocument", source="globalThis.broken = true")
    tab.go(device.address)
    assert "no WebAssembly here" in tab.wait(f"{LINE}.includes('does not start') && {LINE}")
    soon(lambda: device.notices == (NOTICES["engine"],))
    tab.close()


def test_a_camera_in_use_is_told_and_tried_again_when_it_is_free(
    browser: Browser, device: WebcamDevice
) -> None:
    tab = browser.open("about:blank")
    # Chromium's fake camera can be opened by everybody: its answer for a taken one is given here.
    script = """
        const ask = navigator.mediaDevices.getUserMedia.bind(navigator.mediaDevices);
        globalThis.taken = true;
        navigator.mediaDevices.getUserMedia = (wanted) => globalThis.taken
            ? Promise.reject(new DOMException("taken", "NotReadableError")) : ask(wanted);
    """
    tab.call(
        "Page.addScriptToEvaluateOnNewDocument", source=f"if (navigator.mediaDevices) {{{script}}}"
    )
    tab.go(device.address)
    tab.wait(f"{LINE}.startsWith('Another program uses the camera')")
    soon(lambda: device.notices == (NOTICES["in use"],))
    tab.evaluate("globalThis.taken = false; document.getElementById('again').click(); true")
    tab.wait(f"{LINE}.startsWith('No hand')")
    soon(lambda: device.notices == ())
    tab.close()


def test_a_camera_that_is_pulled_out_is_told_and_taken_again(
    tab: Tab, device: WebcamDevice
) -> None:
    track = "document.getElementById('video').srcObject.getTracks()[0]"
    tab.evaluate(f"{track}.stop(); {track}.dispatchEvent(new Event('ended')); true")
    tab.wait(f"{LINE}.startsWith('The camera has gone')")
    soon(lambda: device.notices == (NOTICES["absent"],))
    tab.evaluate("document.getElementById('again').click(); true")
    tab.wait(f"{LINE}.startsWith('No hand')")
    soon(lambda: device.notices == ())


def test_no_other_host_is_asked_for_anything(
    tab: Tab, browser: Browser, device: WebcamDevice
) -> None:
    tab.evaluate(found("right"))
    tab.wait(f"{LINE} === 'Your hand is followed.'")
    asked = {e["request"]["url"] for e in tab.events("Network.requestWillBeSent")}
    host = urlsplit(device.address).netloc
    elsewhere = {url for url in asked if urlsplit(url).netloc != host}
    assert not {url for url in elsewhere if not url.startswith(("data:", "blob:"))}
    # Nor could a later version of the engine: the page may not.
    refused = tab.evaluate("fetch('http://127.0.0.2:9/').then(() => 'sent', e => e.message)")
    assert refused != "sent"
    blocked = tab.evaluate(
        "new Promise(done => { addEventListener('securitypolicyviolation', e => done("
        "e.blockedURI)); fetch('https://example.com/x').catch(() => 0); })"
    )
    assert blocked.startswith("https://example.com")


@pytest.mark.parametrize(
    ("flags", "said", "notice"),
    [
        (NO_CAMERA, "No camera is connected", "absent"),
        (REFUSED, "does not let this page", "refused"),
    ],
)
def test_why_there_is_no_picture_is_told(
    tmp_path: Path, device: WebcamDevice, flags: tuple[str, ...], said: str, notice: str
) -> None:
    browser = Browser(tmp_path, flags)
    try:
        tab = browser.open(device.address)
        tab.wait(f"{LINE}.includes({said!r})")
        soon(lambda: device.notices == (NOTICES[notice],))
        assert tab.evaluate("!document.getElementById('again').hidden")
    finally:
        browser.close()


class InBrowser(CameraSession):
    """A session whose camera's page is open in a browser, before a hand.

    Attributes:
        tab: The page.
        on: True if the page showed the camera as on when it found the hand.
    """

    def __init__(self, folder: Path, engine: Path, browser: Browser) -> None:
        self._browser, self.on = browser, False
        super().__init__(folder, engine)

    def open_page(self, address: str) -> None:
        self.tab = self._browser.open(address)
        self.tab.wait(f"{LINE}.startsWith('No hand')")
        self.tab.evaluate(found("right"))
        self.tab.wait(f"{LINE} === 'Your hand is followed.'")
        self.on = bool(self.tab.evaluate("!document.getElementById('on').hidden"))


def test_a_study_has_one_camera_page_that_shows_it_as_on_and_goes_off_at_the_end(
    tmp_path: Path, engine: Path, browser: Browser
) -> None:
    session = InBrowser(tmp_path / "study", engine, browser)
    assert session.outcome is SessionOutcome.COMPLETE and session.on
    session.tab.wait(f"{LINE} === {ENDED!r}")
    assert session.tab.evaluate("document.getElementById('on').hidden")
    session.tab.close()
    recordings = sorted((session.path / "trials").glob("*.jsonl*"))
    assert len(recordings) == 2
    for path in recordings:
        recording = load_recording(path)
        frames = [line.frame for line in recording.inputs[0]]
        assert any(isinstance(frame, LandmarkFrame) and frame.hands for frame in frames)
        _, verdict = replay(recording)
        assert verdict.exact and verdict.complete


@pytest.mark.full
@pytest.mark.needs("opengl")
def test_the_fetched_engine_finds_our_rendered_hand_and_asks_no_other_host(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    engine = install(lambda line: None)
    assert engine.is_relative_to(tmp_path) and installed_engine() == engine
    pictures = film(VIEWS["above"], poses_of(1, 4)).pictures
    shown = watch(pictures, engine)
    found = [f for f in shown.frames if f is not None]
    assert len(found) == len(pictures)
    assert [h.side for f in found for h in f.hands] == ["right"] * len(pictures)
    assert all(host.startswith("127.0.0.1:") for host in shown.hosts)
