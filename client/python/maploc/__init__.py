"""The robot's side of maploc: where was this photo taken?

Frames: map: right-handed, z up. Camera: x right, y down, z forward. Body: the robot's frame; the camera unless a view
has a `camera_from_body`. Pixels: the centre of the first one is (0, 0). Transforms are 4 x 4 target_from_source.
Gravity points DOWN.
"""

from maploc.answer import (
    Evidence,
    FeatureCounts,
    FeatureMatches,
    FocalScale,
    Localization,
    Map,
    Outcome,
    Pose,
    Segment,
    SegmentChange,
    SessionEnd,
    SessionSummary,
    StageTimes,
    StrategySource,
)
from maploc.camera import Camera, CameraModel
from maploc.client import Client, Session
from maploc.errors import MaplocError
from maploc.features import detect_lines, detect_points, has_lines
from maploc.gravity import Gravity
from maploc.odometry import Tracker, TrackerOptions
from maploc.odometry_decision import Decision, Gap, Verdict
from maploc.odometry_drift import OdometryDrift, PoseSigmas
from maploc.odometry_track import map_from_odom, moved
from maploc.photo import load_gray
from maploc.query import DescriptorKind, Lines, Metric, Points, Prior, QueryOptions, Refinement, Strategy, View
from maploc.view import make_view

__all__ = [
    "Camera",
    "CameraModel",
    "Client",
    "Decision",
    "DescriptorKind",
    "Evidence",
    "FeatureCounts",
    "FeatureMatches",
    "FocalScale",
    "Gap",
    "Gravity",
    "Lines",
    "Localization",
    "Map",
    "MaplocError",
    "Metric",
    "OdometryDrift",
    "Outcome",
    "Points",
    "Pose",
    "PoseSigmas",
    "Prior",
    "QueryOptions",
    "Refinement",
    "Segment",
    "SegmentChange",
    "Session",
    "SessionEnd",
    "SessionSummary",
    "StageTimes",
    "Strategy",
    "StrategySource",
    "Tracker",
    "TrackerOptions",
    "Verdict",
    "View",
    "detect_lines",
    "detect_points",
    "has_lines",
    "load_gray",
    "make_view",
    "map_from_odom",
    "moved",
]
