"""Checks of OpenGL, in a window and without a screen, each in a process of its own."""

from __future__ import annotations

import os
import sys

from sandbox.doctor.check import Check, ProbeResult, run_probe
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
"""Where a backend is missing, MuJoCo cannot be imported, and does not say what is missing."""

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
            f"{name}: {_answer_text(a)}"
            if a.ok or not any_ok
            else f"no {name}, which is not needed then"
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
    """What drawing without a screen says, or what is in its way."""
    there = run_probe(_OBSTACLE.format(backend=backend))
    if not there.ok:
        return there
    return run_probe(_OFFSCREEN, MUJOCO_GL=backend, PYOPENGL_PLATFORM=backend)


def _answer_text(answer: ProbeResult) -> str:
    slow = answer.ok and any(word in answer.text.lower() for word in _BY_SOFTWARE)
    return answer.text + (" (by software: slower, and good enough)" if slow else "")


def _display() -> tuple[bool, str]:
    if sys.platform != "linux":
        return True, "of the system"
    for name in VARIABLES:
        if os.environ.get(name):
            return True, f"{name}={os.environ[name]}"
    return False, f"neither {' nor '.join(VARIABLES)} is set"
