"""What became of an answer that was held against odometry."""

import enum
import math
from dataclasses import dataclass


class Verdict(enum.Enum):
    """What became of an answer."""

    TAKEN = enum.auto()  # odometry agrees
    POSITION_CONTRADICTED = enum.auto()  # held back
    ROTATION_CONTRADICTED = enum.auto()  # held back; its position agrees
    UNCONFIRMED = enum.auto()  # held back: there is no pose yet
    RELOCATED = enum.auto()  # as many answers as asked agreed on another place, or on a first one


@dataclass(frozen=True)
class Gap:
    """Between an answer and what odometry makes of the answers before; in standard deviations that of the direction in
    which it is the most."""

    distance_meters: float
    angle_radians: float
    position_sigmas: float
    rotation_sigmas: float


@dataclass(frozen=True)
class Decision:
    """What became of an answer, and why.

    Attributes:
        verdict: TAKEN and RELOCATED alone move the pose.
        gap: to the pose before this answer; None where there was none.
        agreeing: answers on this place so far, where it was held back.
    """

    verdict: Verdict
    gap: Gap | None
    agreeing: int

    @property
    def taken(self) -> bool:
        """Whether the pose follows this answer."""
        return self.verdict in (Verdict.TAKEN, Verdict.RELOCATED)

    @property
    def reason(self) -> str:
        """For people."""
        so_far = f"; {self.agreeing} on this place so far"
        if self.verdict is Verdict.TAKEN:
            return "taken: odometry agrees"
        if self.verdict is Verdict.UNCONFIRMED:
            return "held back: there is no pose yet" + so_far
        if self.gap is None:
            return "taken: enough answers agree on a first place"
        meters, degrees = self.gap.distance_meters, math.degrees(self.gap.angle_radians)
        if self.verdict is Verdict.RELOCATED:
            return f"taken: enough answers agree on a place {meters:.2f} m and {degrees:.1f} degrees away"
        if self.verdict is Verdict.POSITION_CONTRADICTED:
            sigmas = self.gap.position_sigmas
            return f"held back: odometry contradicts its position by {meters:.2f} m ({sigmas:.1f} sigma)" + so_far
        sigmas = self.gap.rotation_sigmas
        return f"held back: odometry contradicts its rotation by {degrees:.1f} degrees ({sigmas:.1f} sigma)" + so_far
