"""The exception tree of the project.

Every message states the problem, its place, the actual and the expected value, and the next step.
Callers give these facts; the message is built here, so that all messages have the same form.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


class HandSandboxError(Exception):
    """Base class of all errors that this project raises.

    Args:
        what: The problem, in one clause.
        where: File, line, field or setting with the mistake.
        got: The wrong value; the caller shortens long ones.
        expected: Accepted values.
        remedy: Next step for the reader of the message.
    """

    def __init__(
        self,
        what: str,
        *,
        where: str | None = None,
        got: object = None,
        expected: str | None = None,
        remedy: str | None = None,
    ) -> None:
        self.what, self.where, self.got = what, where, got
        self.expected, self.remedy = expected, remedy
        text = f"{where}: {what}" if where else what
        details = []
        if got is not None:
            details.append(f"got {got!r}" if isinstance(got, str) else f"got {got}")
        if expected is not None:
            details.append(f"expected {expected}")
        if details:
            text += f" ({', '.join(details)})"
        if remedy is not None:
            text += f". {remedy}"
        super().__init__(text)

    def __reduce__(self) -> tuple[object, ...]:
        """Makes errors of all classes picklable, so that they can pass between processes."""
        return _rebuilt, (type(self), self.args), self.__dict__


def _rebuilt(kind: type[HandSandboxError], args: tuple[object, ...]) -> HandSandboxError:
    return kind.__new__(kind, *args)


class InputError(HandSandboxError):
    """Input from a person or a file cannot be used; the command line exits with 2."""


def unknown_name(
    what: str,
    name: str,
    names: Iterable[str],
    *,
    where: str | None = None,
    others: str = "",
    remedy: str | None = None,
    kind: type[InputError] = InputError,
) -> InputError:
    """The error for an unknown name, with the most similar known name or with all known names.

    Args:
        what: The problem, such as `no such command`.
        name: The unknown name.
        names: The known names.
        where: Option, file or command with the mistake.
        others: Text about other accepted values, such as `or a file`.
        remedy: Next step, if no known name is similar.
        kind: Class of the error.
    """
    names = list(names)
    near = get_close_matches(name, names, 1)
    if near:
        return kind(what, where=where, got=name, remedy=f"Did you mean {near[0]}?")
    expected = ", ".join([*names, *([others] if others else [])]) or None
    return kind(what, where=where, got=name, expected=expected, remedy=remedy)


class SurfaceTooSmallError(InputError):
    """A touch surface has no room for a task.

    Args:
        task: Name of the task; empty if the caller does not know it.
        size_in: (2,) inches, width and height of the surface.
        room: Objects that need room, as text.
        example_in: (2,) inches, size of a large enough surface; None if none is known.
        remedy: Next step for the reader of the message.
    """

    def __init__(
        self,
        task: str,
        size_in: tuple[float, float],
        room: str,
        example_in: tuple[float, float] | None = None,
        remedy: str | None = None,
    ) -> None:
        self.example_in = example_in
        example = f", as on {example_in[0]:g}x{example_in[1]:g}in" if example_in else ""
        super().__init__(
            "the surface is too small for this task",
            where=task or None,
            got=f"{size_in[0]:.3g}x{size_in[1]:.3g}in",
            expected=f"room for {room}{example}",
            remedy=remedy,
        )


class FrameError(InputError):
    """A touch or hand frame breaks its contract."""


class DeviceError(InputError):
    """A device cannot be opened, or it sends data that cannot be read."""


class CaptureError(InputError):
    """A capture file or its arrays break the contract of a capture."""


class MotionError(InputError):
    """A file of motion capture (BVH, ASF/AMC, markers, a table of poses) cannot be understood."""


class EncoderError(InputError):
    """An encoder cannot be fitted or loaded, or does not support the call."""


class RecordingError(InputError):
    """A recording is damaged, of another version, or does not replay."""


class StudyError(InputError):
    """A user study's design, folder or journal cannot be used as requested."""


class DifferentPlanError(StudyError):
    """The plan of a session, or of a participant's earlier session, differs from the study's
    current plan."""


class LaterLayoutError(StudyError):
    """A later version of the program wrote a record or note of a study."""


class SceneError(HandSandboxError):
    """A scene cannot be built as described."""


class DivergenceError(HandSandboxError):
    """The simulation diverged: its numbers are not valid any more."""
