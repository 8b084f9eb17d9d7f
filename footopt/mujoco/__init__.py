"""footopt's sand in MuJoCo: `attach` it to a model, and its feet sink, stand and walk on it.

Needs ``pip install "footopt[mujoco]"``; importing this package does not import MuJoCo.
"""

from footopt.mujoco.attaching import Contact, attach
from footopt.mujoco.intrusion import Grains

__all__ = ["Contact", "Grains", "attach"]
