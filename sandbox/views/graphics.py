"""Finds an OpenGL that draws without a screen: EGL of a graphics card or of Mesa, or else OSMesa.

The choice must be made before any of these is loaded: PyOpenGL uses one platform for the whole
process, and MuJoCo loads its drawing functions only once. So libraries are first probed with
ctypes, which has no such effect, and then the chosen library is imported.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import importlib
import os
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from typing import Protocol

import mujoco

from sandbox.views.display import OFFSCREEN_REMEDY, GraphicsError

BACKENDS = ("egl", "osmesa", "glfw", "cgl")
"""Ways to draw without a screen. glfw needs a display for its hidden window; cgl is for macOS."""

_SWITCHED_OFF = ("disable", "disabled", "off", "false", "0")
_EGL_DEVICES_WANTED = 16


class GLContext(Protocol):
    """An OpenGL context.

    Attributes:
        backend: One of `BACKENDS`; None for the context of a window.
    """

    backend: str | None

    def as_current(self) -> AbstractContextManager[None]:
        """Makes the context current in the calling thread within the `with` block.

        It is released afterwards: a thread has one current context at a time, and contexts of a
        window and of EGL are incompatible.
        """
        ...

    def free(self) -> None:
        """Releases the context; may be called twice."""
        ...


@cache
def choose_backend() -> str:
    """Returns the backend of this process, chosen once; MUJOCO_GL in the environment overrides it.

    Raises:
        GraphicsError: No backend is available, or drawing is switched off.
    """
    wish = os.environ.get("MUJOCO_GL", "").lower().strip()
    if wish in _SWITCHED_OFF:
        raise GraphicsError(
            "pictures are switched off",
            where="MUJOCO_GL",
            got=wish,
            expected=", ".join(BACKENDS),
            remedy="Unset MUJOCO_GL: then a backend is chosen automatically",
        )
    if wish in BACKENDS:
        return wish
    if sys.platform == "darwin":
        return "cgl"
    if sys.platform != "linux":
        return "glfw"
    reasons = []
    for name in ("egl", "osmesa"):
        reason = obstacle(name)
        if reason is None:
            return name
        reasons.append(f"{name}: {reason}")
    raise _no_graphics("; ".join(reasons))


def offscreen_context(width: int, height: int) -> GLContext:
    """Returns a context that draws into memory; it is not current in any thread yet.

    Raises:
        GraphicsError: This machine has no OpenGL.
    """
    backend = choose_backend()
    try:
        # ImportError, AttributeError and errors of PyOpenGL all mean a missing backend.
        module = importlib.import_module(f"mujoco.{backend}")
        context: GLContext = module.GLContext(width, height)
        context.backend = backend
    except Exception as error:
        raise _no_graphics(f"{backend}: {error}") from error
    return context


@contextmanager
def render_context(model: mujoco.MjModel, gl: GLContext) -> Iterator[mujoco.MjrContext]:
    """Context manager with MuJoCo's rendering context, which draws into memory.

    Args:
        model: The model to draw.
        gl: The OpenGL context; it is current in this thread only while drawing.

    Raises:
        GraphicsError: The context is too old or too small for MuJoCo.
    """
    with gl.as_current(), _backend_in_environment(gl.backend):
        try:
            context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
        except mujoco.FatalError as error:
            raise _no_graphics(str(error)) from error
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, context)
    try:
        yield context
    finally:
        with gl.as_current():
            context.free()


@contextmanager
def _backend_in_environment(backend: str | None) -> Iterator[None]:
    """Sets MUJOCO_GL, which MuJoCo reads when it loads its drawing functions for the first time.

    The variable is restored afterwards, so that child processes do not inherit it.
    """
    before = os.environ.get("MUJOCO_GL")
    if backend is not None:
        os.environ["MUJOCO_GL"] = backend
    try:
        yield
    finally:
        if before is not None:
            os.environ["MUJOCO_GL"] = before
        elif backend is not None:
            del os.environ["MUJOCO_GL"]


def _no_graphics(reason: str) -> GraphicsError:
    return GraphicsError(
        "this machine has no OpenGL to draw pictures with",
        got=reason,
        expected="EGL or OSMesa" if sys.platform == "linux" else None,
        remedy=OFFSCREEN_REMEDY,
    )


def obstacle(backend: str) -> str | None:
    """Returns why `egl` or `osmesa` cannot draw without a screen; None if it can."""
    return {"egl": _egl_obstacle, "osmesa": _osmesa_obstacle}[backend]()


def _egl_obstacle() -> str | None:
    """Returns why EGL cannot draw without a screen; None if it can."""
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError as error:
        return str(error)
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    egl.eglGetProcAddress.argtypes = [ctypes.c_char_p]
    query_address = egl.eglGetProcAddress(b"eglQueryDevicesEXT")
    display_address = egl.eglGetProcAddress(b"eglGetPlatformDisplayEXT")
    if not query_address or not display_address:
        return "libEGL has no devices extension"
    devices = (ctypes.c_void_p * _EGL_DEVICES_WANTED)()
    count = ctypes.c_int(0)
    query = ctypes.CFUNCTYPE(
        ctypes.c_uint, ctypes.c_int, ctypes.POINTER(ctypes.c_void_p), ctypes.POINTER(ctypes.c_int)
    )(query_address)
    if not query(_EGL_DEVICES_WANTED, devices, ctypes.byref(count)) or count.value == 0:
        return "libEGL knows no device, so its driver (libegl-mesa0 or a vendor's) is missing"
    display_of = ctypes.CFUNCTYPE(
        ctypes.c_void_p, ctypes.c_uint, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int)
    )(display_address)
    egl.eglInitialize.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    platform_device = 0x313F  # EGL_PLATFORM_DEVICE_EXT
    for device in devices[: count.value]:
        display = display_of(platform_device, device, None)
        if display and egl.eglInitialize(display, None, None):
            return None
    return f"none of the {count.value} devices of libEGL can be opened"


def _osmesa_obstacle() -> str | None:
    """Returns why OSMesa cannot draw; None if it can."""
    name = ctypes.util.find_library("OSMesa")
    if name is None:
        return "libOSMesa is missing"
    try:
        ctypes.CDLL(name)
    except OSError as error:
        return str(error)
    return None
