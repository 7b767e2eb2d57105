"""The one exception tree of the project.

Every message says what is wrong, where, what we got, what was expected and what to do next.
A caller raises with facts; the sentence is built here, so that all messages read alike.
"""

from __future__ import annotations


class HandSandboxError(Exception):
    """Root of everything this project raises on purpose.

    Args:
        what: What is wrong, one clause.
        where: File, line, field or setting that holds the mistake.
        got: The offending value, shortened by the caller where it may be long.
        expected: What would have been accepted.
        remedy: The next step for the person who reads the message.
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


class InputError(HandSandboxError):
    """Input from a person or a file cannot be used; the command line exits with 2."""


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
    """A user study's design, folder or journal cannot be used as asked."""


class SceneError(HandSandboxError):
    """A scene cannot be built as described."""


class DivergenceError(HandSandboxError):
    """The simulation left the region where its numbers mean something."""
