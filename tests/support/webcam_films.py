"""Films of the rendered hand with its true poses, and what the camera's page sees in them.

The hand is that of `models.skeleton`, drawn with its skin; it moves as hands over a simulated Leap
do (`encoders.paalm.simulated.air`). Chromium's fake camera plays the film, the page finds hands as
it does for a person, and each picture carries its number as black and white squares in a corner,
which are read inside the page. Pictures are held until the page has seen them, so time
is stretched. All of this is rendered, not recorded.
"""

from __future__ import annotations

import io
import json
import tempfile
import time
from contextlib import ExitStack
from dataclasses import dataclass
from math import radians, tan
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from PIL import Image, ImageDraw

from encoders.air.camera import Camera
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.palm import Palm
from encoders.paalm.simulated.air import simulate_air
from models.arithmetic import Array
from models.frames import LandmarkFrame
from models.hand import Hand
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from sandbox.devices.device import Closeable
from sandbox.devices.webcam.landmarks import PictureMessage, frame_of, picture_message
from sandbox.devices.webcam.webcam import LandmarkServer
from sandbox.views.graphics import offscreen_context, render_context
from sandbox.views.hand_appearance import HIDDEN_GROUP, skinned_model
from tests.support.chromium import Browser

SIZE = (640, 480)
"""px of the pictures."""

RATE = 15.0
"""Hz of the films, in the hand's own time."""

HELD = 14
"""Pictures of the fake camera for which one picture of the film is shown."""

MIDDLE = np.array([0.0, 0.05, 0.13])
"""m, about where the palm is."""

DISTANCE = 0.45
"""m of every camera from there."""

VIEW = 60.0
"""Degrees across the picture."""

_BITS, _SQUARE = 12, 10
"""Bits of a picture's number, and px of a square."""


def _camera(tilt: float, pan: float, roll: float = 0.0) -> Camera:
    """A camera that looks at the middle of the hand's space."""
    away = DISTANCE * Camera(VIEW, tilt=tilt, roll=roll, pan=pan).axes[2]
    x, y, z = (MIDDLE - away).tolist()
    return Camera(VIEW, (x, y, z), tilt, roll, pan)


VIEWS = {
    "above": _camera(90.0, 0.0, 180.0),
    "side": _camera(0.0, 90.0),
    "30 degrees": _camera(30.0, 118.0),
}
"""Straight down; horizontally from the thumb's side; 30 degrees down from the thumb's side and
behind, as films of the sandbox look."""


@dataclass(frozen=True)
class Film:
    """A film of the hand.

    Attributes:
        camera: The camera.
        poses: (T, 48) true poses in the world, one a picture.
        pictures: JPEG of each picture.
    """

    camera: Camera
    poses: Array
    pictures: tuple[bytes, ...]


def poses_of(seed: int, count: int) -> Array:
    """(T, 48) poses in the world of one person's gestures."""
    take = simulate_air(seed)
    begin = int(np.argmin(take.open)) - round(1.0 / (take.time[1] - take.time[0]))
    every = round(1.0 / RATE / (take.time[1] - take.time[0]))
    angles = take.angles
    poses = []
    for t in range(begin, len(take.time), every)[:count]:
        x, y, z = take.rotation[t].T.tolist()
        palm = Palm(tuple(take.origin[t].tolist()), tuple(x), tuple(y), tuple(z))
        poses.append(hand_pose(angles[t], palm, device=(0.0, 0.05, -0.07)))
    return np.array(poses)


class HandPainter(Closeable):
    """Draws the hand before a camera, alone and with its skin.

    Args:
        camera: The camera.
    """

    def __init__(self, camera: Camera) -> None:
        self._camera = camera
        self._scene = Scene(SceneSpec((Hand("right", ADULT),)))
        self._model, _ = skinned_model(self._scene)
        self._model.vis.global_.offwidth, self._model.vis.global_.offheight = SIZE
        self._data = mujoco.MjData(self._model)
        self._option, self._view = mujoco.MjvOption(), mujoco.MjvCamera()
        self._option.geomgroup[HIDDEN_GROUP:] = 0
        self._drawn = mujoco.MjvScene(self._model, 2000)
        self._open = ExitStack()
        self._gl = offscreen_context(*SIZE)
        self._open.callback(self._gl.free)
        self._context = self._open.enter_context(render_context(self._model, self._gl))

    def draw(self, q: Array) -> Image.Image:
        """A picture of a pose (48,) in the world."""
        width, height = SIZE
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        self._data.qpos[self._scene.qpos_slice(0)] = self._scene.pose_to_qpos(0, q)
        mujoco.mj_forward(self._model, self._data)
        mujoco.mjv_updateScene(
            self._model, self._data, self._option, None, self._view, everything, self._drawn
        )
        for eye in self._drawn.camera:
            _point(eye, self._camera)
        pixels = np.empty((height, width, 3), np.uint8)
        place = mujoco.MjrRect(0, 0, width, height)
        with self._gl.as_current():
            mujoco.mjr_render(place, self._drawn, self._context)
            mujoco.mjr_readPixels(pixels, None, place, self._context)
        return Image.fromarray(pixels[::-1])

    def close(self) -> None:
        """Frees what draws."""
        self._open.close()


def film(camera: Camera, poses: Array) -> Film:
    """Draws a film of poses (T, 48)."""
    with HandPainter(camera) as painter:
        pictures = tuple(numbered(painter.draw(q), n) for n, q in enumerate(poses))
    return Film(camera, poses, pictures)


def _point(eye: Any, camera: Camera) -> None:
    """Puts one of MuJoCo's OpenGL cameras where a camera is."""
    width, height = SIZE
    _, down, away = camera.axes
    eye.pos[:], eye.forward[:], eye.up[:] = camera.at, away, -down
    half = tan(radians(camera.view / 2.0)) * eye.frustum_near
    eye.frustum_center, eye.frustum_width = 0.0, half
    eye.frustum_top, eye.frustum_bottom = half * height / width, -half * height / width


def numbered(picture: Image.Image, number: int) -> bytes:
    """A picture as JPEG, with its number in black and white squares in its upper left corner."""
    pen = ImageDraw.Draw(picture)
    for bit in range(_BITS):
        shade = 255 if number >> bit & 1 else 0
        place = (bit * _SQUARE, 0, (bit + 1) * _SQUARE - 1, _SQUARE - 1)
        pen.rectangle(place, fill=(shade, shade, shade))
    data = io.BytesIO()
    picture.save(data, "JPEG", quality=92)
    return data.getvalue()


_READS_NUMBERS = """
(() => {
  const canvas = document.createElement("canvas");
  const number = () => {
    const video = document.getElementById("video");
    const [bits, square] = [BITS, SQUARE];
    canvas.width = bits * square; canvas.height = square;
    const pen = canvas.getContext("2d", { willReadFrequently: true });
    pen.drawImage(video, 0, 0, canvas.width, square, 0, 0, canvas.width, square);
    const data = pen.getImageData(0, 0, canvas.width, square).data;
    let n = 0;
    for (let i = 0; i < bits; i++) {
      const at = 4 * ((square >> 1) * canvas.width + i * square + (square >> 1));
      if (data[at] > 127) n |= 1 << i;
    }
    return n;
  };
  let before = -1;
  const kind = HTMLVideoElement.prototype;
  const ask = kind.requestVideoFrameCallback;
  kind.requestVideoFrameCallback = function (call) {
    return ask.call(this, (now, data) => { before = number(); call(now, data); });
  };
  const send = WebSocket.prototype.send;
  window.numbers = [];
  WebSocket.prototype.send = function (text) {
    if (text.includes('"seen"')) window.numbers.push([before, number(), text]);
    send.call(this, text);
  };
})();
""".replace("BITS, SQUARE", f"{_BITS}, {_SQUARE}")


@dataclass(frozen=True)
class SeenFilm:
    """What the page saw of a film.

    Attributes:
        frames: Frame of each picture, in the hand's own time; None where the page never saw it.
        milliseconds: Median time that the page took for a picture.
        hosts: Hosts that the page asked for anything.
    """

    frames: tuple[LandmarkFrame | None, ...]
    milliseconds: float
    hosts: frozenset[str]


def seen(pictures: tuple[bytes, ...], engine: Path, hands: int = 1, rate: float = RATE) -> SeenFilm:
    """Shows pictures to the page through Chromium's fake camera.

    Args:
        pictures: JPEGs with their numbers.
        engine: Folder of the engine.
        hands: Hands that the engine looks for.
        rate: Hz of the pictures in the hand's own time.
    """
    messages: list[PictureMessage] = []
    wanted = {"sides": ["right"], "most": 2, "hands": hands, "mirrored": False}
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "film.mjpeg"
        with source.open("wb") as file:
            for picture in pictures:
                file.write(picture * HELD)
        browser = Browser(
            Path(folder),
            (
                "--use-fake-device-for-media-stream",
                "--use-fake-ui-for-media-stream",
                f"--use-file-for-fake-video-capture={source}",
            ),
        )
        server = LandmarkServer(engine, wanted, messages.append, lambda: None)
        try:
            tab = browser.open("about:blank")
            tab.call("Page.addScriptToEvaluateOnNewDocument", source=_READS_NUMBERS)
            tab.go(server.url)
            found = _collected(tab, len(pictures))
        finally:
            asked = [e for e in browser.events if e["method"] == "Network.requestWillBeSent"]
            browser.close()
            server.close()
    frames: list[LandmarkFrame | None] = [None] * len(pictures)
    took = []
    for number, text in found.items():
        message = picture_message(text)
        frame = frame_of(message)
        took.append(1000.0 * (frame.time - frame.taken))
        at = number / rate
        frames[number] = LandmarkFrame(at, frame.hands, frame.size, at, frame.source)
    hosts = frozenset(e["params"]["request"]["url"].split("/")[2] for e in asked)
    return SeenFilm(tuple(frames), float(np.median(took)), hosts)


def _collected(tab: Any, count: int) -> dict[int, str]:
    """The page's message of each picture by its number, once it has seen nearly all of them."""
    found: dict[int, str] = {}
    until = time.monotonic() + 30.0 + 1.2 * count
    news = time.monotonic()
    while time.monotonic() < until and len(found) < count:
        time.sleep(1.0)
        answer = tab.call(
            "Runtime.evaluate",
            expression="JSON.stringify((window.numbers ?? []).splice(0))",
            returnByValue=True,
        )
        for before, after, text in json.loads(answer["result"]["value"]):
            if before == after and before < count and before not in found:
                found[before] = text
                news = time.monotonic()
        if found and time.monotonic() - news > 20.0:
            break
    return found
