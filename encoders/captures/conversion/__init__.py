"""Recordings of touches and of hands become captures.

Touches come as a `TouchLog`, poses as a `JointTrack`, or as points on the hand that a skeleton is
fitted to. Everything here is a function of arrays; `sandbox capture` reads the files.
"""

from encoders.captures.conversion.convert import capture_from_poses as capture_from_poses
from encoders.captures.conversion.convert import capture_from_touches as capture_from_touches
from encoders.captures.conversion.hand_points import joints_from_points as joints_from_points
from encoders.captures.conversion.joint_track import JointTrack as JointTrack
from encoders.captures.conversion.report import ConversionReport as ConversionReport
from encoders.captures.conversion.report import ConversionRules as ConversionRules
from encoders.captures.conversion.surface_frame import SurfaceFrame as SurfaceFrame
from encoders.captures.conversion.surface_frame import frame_from_corners as frame_from_corners
from encoders.captures.conversion.touch_log import TouchLog as TouchLog
