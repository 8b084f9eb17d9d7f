"""The gait: human joint angles, the ankle path they imply, and the start from standing."""

from footopt.gait.fourier import Fourier
from footopt.gait.gait import LEFT, RIGHT, Gait, Pose

__all__ = ["LEFT", "RIGHT", "Fourier", "Gait", "Pose"]
