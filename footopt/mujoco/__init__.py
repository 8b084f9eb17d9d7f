"""footopt's sand in MuJoCo: `attach` it to a model, and its feet sink, stand and walk on it.

Needs ``pip install "footopt[mujoco]"``; importing this package does not import MuJoCo.
"""

from footopt.mujoco.attaching import Contact, attach
from footopt.mujoco.controllers import Commands, Tracker
from footopt.mujoco.robot import Robot

__all__ = ["Commands", "Contact", "Robot", "Tracker", "attach"]
