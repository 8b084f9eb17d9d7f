"""Any MuJoCo environment of gymnasium on sand: python examples/mujoco/gym_on_sand.py"""

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np

import footopt as fo


class OnSand(gymnasium.Wrapper):
    """An environment whose feet, soles by the name of their body, sink into sand in place of the floor."""

    def __init__(self, env: gymnasium.Env, feet: Mapping[str, fo.Foot], sand: fo.Sand, effects: Any = ()):
        super().__init__(env)
        model, data = env.unwrapped.model, env.unwrapped.data
        touch = np.isin(model.geom_bodyid, [model.body(name).id for name in feet])
        model.geom_contype[touch] = model.geom_conaffinity[touch] = 0  # the other bodies keep the floor
        self.sand = fo.mujoco.attach(model, data, feet, sand, effects)

    def step(self, action: Any) -> Any:
        """Take a step; `info` has the sand's force on each foot, N, and how deep it is, m."""
        *found, info = self.env.step(action)
        return *found, info | {"sand_force": self.sand.force, "depth": self.sand.depth}

    def close(self) -> None:
        """Take the sand away."""
        self.sand.detach()
        super().close()


if __name__ == "__main__":
    walker = gymnasium.make("Walker2d-v5", healthy_z_range=(0.0, 2.0), healthy_angle_range=(-4.0, 4.0))
    env = OnSand(walker, dict.fromkeys(("foot", "foot_left"), fo.Foot.flat()), fo.Sand.named("hard"))
    env.reset(seed=1)
    for _ in range(20):
        *_, info = env.step(np.zeros(6))
    print(info["sand_force"], info["depth"])
    env.close()
