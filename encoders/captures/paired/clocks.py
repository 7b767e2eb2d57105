"""Relates a device's clock to the host's, from the arrival times of its frames.

Arrivals are late by a latency that differs from frame to frame. A device's own times do not vary
like that, but their zero is arbitrary and their seconds may be a little long. A straight line
through both removes these errors. The mean latency remains, which cannot be measured from one side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arithmetic import Array
from models.errors import CaptureError

MOST_DRIFT = 0.002
"""Largest relative difference of two clocks' seconds; crystals are within a tenth of that."""

_ROUNDS = 5
_OUTLIER = 3.0
"""Median deviations beyond which an arrival is ignored, since the machine was busy."""


@dataclass(frozen=True)
class HostClock:
    """Host time = `offset` + (1 + `drift`) * device time.

    Attributes:
        offset: s, host time at device time 0.
        drift: Share by which a device's second is longer than the host's.
        jitter: s, robust standard deviation of the arrivals about the line.
    """

    offset: float
    drift: float
    jitter: float

    def host(self, device: Array) -> Array:
        """Converts device times to host times, s."""
        return np.asarray(self.offset + (1.0 + self.drift) * device)


def host_clock(device: Array, arrived: Array, where: str) -> HostClock:
    """The line that turns a stream's own times into those of the host's clock, fitted to arrivals.

    Args:
        device: (n,) s, the frames' own times.
        arrived: (n,) s, arrival times on the host's clock.
        where: Name of the stream, for messages.

    Raises:
        CaptureError: The two clocks do not match.
    """
    if len(device) < 2 or np.ptp(device) <= 0.0:
        raise CaptureError(
            "too few frames to relate its clock to the host's", where=where, got=len(device)
        )
    middle = float(device.mean())
    keep = np.ones(len(device), bool)
    line = np.array([1.0, 0.0])
    spread = 0.0
    for _ in range(_ROUNDS):
        line = np.polyfit(device[keep] - middle, arrived[keep], 1)
        off = arrived - np.polyval(line, device - middle)
        spread = 1.4826 * float(np.median(np.abs(off - np.median(off))))
        keep = np.abs(off - np.median(off)) <= max(_OUTLIER * spread, 1e-4)
    drift = float(line[0]) - 1.0
    # Short recordings do not determine the drift: jitter of the arrivals looks like one.
    if abs(drift) > MOST_DRIFT + 4.0 * spread / max(float(np.ptp(device)), 1e-9):
        raise CaptureError(
            "the device's times do not match their arrivals",
            where=where,
            got=f"a second of {1.0 + drift:.4f} s",
            expected=f"within {100 * MOST_DRIFT:g} %",
            remedy="The clock of one of the two was set during the recording; record again",
        )
    return HostClock(float(line[1]) - (1.0 + drift) * middle, drift, spread)
