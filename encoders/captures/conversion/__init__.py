"""Converts recordings of touches and hands to captures.

The inputs are touches as a `TouchLog`, and poses as a `JointTrack`. Where a recording has points on
the hand instead of poses, a skeleton is fitted to them.
"""

from encoders.captures.conversion.assemble import capture_from_poses as capture_from_poses
from encoders.captures.conversion.assemble import capture_from_touches as capture_from_touches
from encoders.captures.conversion.conversion_report import ConversionReport as ConversionReport
from encoders.captures.conversion.conversion_report import ConversionRules as ConversionRules
from encoders.captures.conversion.hand_points import joints_from_points as joints_from_points
from encoders.captures.conversion.joint_track import JointTrack as JointTrack
from encoders.captures.conversion.surface_frame import SurfaceFrame as SurfaceFrame
from encoders.captures.conversion.surface_frame import frame_from_corners as frame_from_corners
from encoders.captures.conversion.touch_log import TouchLog as TouchLog
