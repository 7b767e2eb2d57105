"""Checks of OpenGL (each in a separate process), network, ports, browser, webcam and input."""

from __future__ import annotations

import os
import shutil
import socket
import sys
from pathlib import Path

from models.errors import DeviceError
from sandbox.doctor import Check, ProbeResult, run_probe
from sandbox.views.display import OFFSCREEN_REMEDY, OPENGL_REMEDY, VARIABLES

_WINDOW = """
import glfw
said = []
glfw.set_error_callback(lambda code, text: said.append(str(text)))
if not glfw.init():
    raise SystemExit("; ".join(said) or "glfw does not start")
glfw.window_hint(glfw.VISIBLE, glfw.FALSE)
window = glfw.create_window(64, 64, "probe", None, None)
if not window:
    raise SystemExit("; ".join(said) or "no window can be opened")
glfw.make_context_current(window)
from OpenGL import GL
print((GL.glGetString(GL.GL_RENDERER) or b"an OpenGL without a name").decode())
"""

_OFFSCREEN = """
import mujoco
world = "<worldbody><light pos='0 0 3'/><geom size='1'/></worldbody>"
model = mujoco.MjModel.from_xml_string(f"<mujoco>{world}</mujoco>")
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
with mujoco.Renderer(model, 64, 64) as renderer:
    renderer.update_scene(data)
    if renderer.render().std() <= 0:
        raise SystemExit("it draws, but the picture is empty")
    from OpenGL import GL
    print((GL.glGetString(GL.GL_RENDERER) or b"an OpenGL without a name").decode())
"""

_OBSTACLE = """
import sys
from sandbox.views.graphics import obstacle
sys.exit(obstacle({backend!r}))
"""
"""Probe that names the reason why a backend cannot be used. If a backend is missing, the import of
MuJoCo fails without this reason."""

_BY_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader")


def graphics_checks() -> list[Check]:
    """Checks of the display, of a window on it, and of pictures without a screen."""
    display, shown = _display()
    checks = [
        Check(
            "pictures",
            "display",
            display,
            shown,
            "`sandbox play` in a window",
            ""
            if display
            else "Log in with a screen, try xvfb-run, or play in a browser: "
            "`sandbox play --view web`",
        )
    ]
    if display:
        window = run_probe(_WINDOW)
        checks.append(
            Check(
                "pictures",
                "window",
                window.ok,
                _answer_text(window),
                "`sandbox play` in a window",
                "" if window.ok else OPENGL_REMEDY,
            )
        )
    answers = {
        name: _offscreen(backend)
        for name, backend in (("EGL", "egl"), ("OSMesa", "osmesa"))
        if sys.platform == "linux"
    }
    if answers:
        any_ok = any(a.ok for a in answers.values())
        told = "; ".join(
            f"{name}: {_answer_text(a)}" if a.ok or not any_ok else f"no {name} (not needed)"
            for name, a in answers.items()
        )
        checks.append(
            Check(
                "pictures",
                "without a screen",
                any_ok,
                told,
                "films and pictures",
                "" if any_ok else OFFSCREEN_REMEDY,
            )
        )
    return checks


def _offscreen(backend: str) -> ProbeResult:
    """Result of drawing without a screen, or the reason why a backend cannot be used."""
    there = run_probe(_OBSTACLE.format(backend=backend))
    if not there.ok:
        return there
    return run_probe(_OFFSCREEN, MUJOCO_GL=backend, PYOPENGL_PLATFORM=backend)


def _answer_text(answer: ProbeResult) -> str:
    slow = answer.ok and any(word in answer.text.lower() for word in _BY_SOFTWARE)
    return answer.text + (" (in software: slower, but sufficient)" if slow else "")


def _display() -> tuple[bool, str]:
    if sys.platform != "linux":
        return True, "of the system"
    for name in VARIABLES:
        if os.environ.get(name):
            return True, f"{name}={os.environ[name]}"
    return False, f"neither {' nor '.join(VARIABLES)} is set"


TUIO_PORT = 3333
"""Port of TUIO over UDP and TCP, by its specification."""

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


def device_checks() -> list[Check]:
    """Checks of all devices."""
    return [
        _network(),
        *(port_check(kind, TUIO_PORT) for kind in ("UDP", "TCP")),
        _browser(),
        _webcam(),
        *_inputs(),
    ]


def port_check(kind: str, port: int) -> Check:
    """Checks whether a port of this machine is free.

    Args:
        kind: `UDP` or `TCP`.
        port: Port of 127.0.0.1.
    """
    stream = kind == "TCP"
    with socket.socket(
        socket.AF_INET, socket.SOCK_STREAM if stream else socket.SOCK_DGRAM
    ) as probe:
        if stream and os.name == "posix":
            # As servers do, so that a connection that was closed recently does not block the port.
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
            if stream:
                probe.listen()
            ok, state = True, "free"
        except OSError as error:
            ok, state = False, error.strerror or str(error)
    return Check(
        "devices",
        f"{kind} port {port}",
        ok,
        state,
        f"tablets and tables that send TUIO by {kind}",
        ""
        if ok
        else "Another program listens there, perhaps another session; end it, or give "
        "both sides another port (--port)",
    )


def _network() -> Check:
    from sandbox.server.page_options import local_network_address

    try:
        ok, address, remedy = True, local_network_address(), ""
    except DeviceError as error:
        ok, address, remedy = False, error.what, error.remedy or ""
    return Check("devices", "network address", ok, address, "`sandbox play --tablet`", remedy)


def _browser() -> Check:
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    return Check(
        "devices",
        "Chromium",
        path is not None,
        path or "not found on the PATH",
        "the page on this machine, and its tests; to play, any browser is sufficient",
        "" if path else "On Debian or Ubuntu: apt-get install chromium",
    )


def _webcam() -> Check:
    """Checks that the engine that finds hands in a camera's pictures is installed and undamaged."""
    from sandbox.devices.webcam.engine import INSTALL, damaged, engine_folder

    folder = engine_folder()
    wrong = damaged(folder)
    return Check(
        "devices",
        "webcam engine",
        not wrong,
        f"{wrong[0]} is missing or damaged in {folder}" if wrong else str(folder),
        "hands in front of a camera (--device webcam)",
        INSTALL if wrong else "",
    )


def _inputs() -> list[Check]:
    """Checks that input devices of Linux can be read."""
    if sys.platform != "linux":
        return []
    folder = Path("/dev/input")
    events = sorted(folder.glob("event*")) if folder.is_dir() else []
    readable = [p for p in events if os.access(p, os.R_OK)]
    if not events:
        summary = "no input devices, as in most containers"
        remedy = "Connect a touch screen or trackpad to this machine itself"
    elif not readable:
        summary = f"{len(events)} devices, but none can be read"
        remedy = 'sudo usermod -aG input "$USER", then log in again'
    else:
        summary, remedy = f"{len(readable)} of {len(events)} devices can be read", ""
    return [
        Check(
            "devices",
            "/dev/input",
            bool(readable),
            summary,
            "touch screens and trackpads (--device evdev)",
            remedy,
        )
    ]
