"""Which simulator should a foot be designed on? python benchmarks/transfer.py [WALKS] [SOLES]

On soft, regular and hard sand: the default search on the planar walker (10,000 walks) and on the biped in
MuJoCo (WALKS), both feet on both, with the robot's peak power (W), speed loss (m/s) and joint work (J), and
Kendall's tau between J_W of both over SOLES random soles.
"""

from __future__ import annotations

import sys

import numpy as np
from scipy.stats import kendalltau

import footopt as fo

FINE = fo.Accuracy(dt=5e-4, plates=64)  # of the robot's walks that are compared
COARSE = fo.Accuracy(dt=2e-3, plates=32)  # of its search, and of the random soles
COLUMNS = ("peak_power", "speed_loss", "joint_work", "efficiency")


def main(walks: int, soles: int) -> None:
    """Print two tables."""
    print("| sand | designed on | k | J_W, walker | J_W, robot | W | m/s | J |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    lost = []
    for name in ("soft", "regular", "hard"):
        sand = fo.Sand.named(name)
        scene, robot = fo.Scene(sand=sand), fo.mujoco.Robot(sand=sand)
        found = {
            "walker": fo.search(fo.FootProblem(scene), walks=10_000, seed=1).foot,
            "robot": fo.search(fo.FootProblem(robot, accuracy=COARSE), walks=walks, seed=1).foot,
        }
        feet = {"": fo.Foot.flat(), **found}
        own = fo.evaluate(list(feet.values()), scene, "fine", "efficiency").values[:, 0]
        other = fo.evaluate(list(feet.values()), robot, FINE, COLUMNS).values
        for (kind, foot), j, row in zip(feet.items(), own, other, strict=True):
            power, loss, joints, there = row
            heights = ",".join(map(str, foot.k or ()))
            numbers = f"{j:.3e} | {there:.3e} | {power:.0f} | {loss:.3f} | {joints:.0f}"
            print(f"| {name} | {kind or 'none: flat'} | {heights} | {numbers} |", flush=True)
        k = fo.Waypoints().random(soles, seed=2)
        both = [
            fo.evaluate(k, w, a, "efficiency").values[:, 0] for w, a in ((scene, "standard"), (robot, COARSE))
        ]
        good = np.isfinite(both).all(axis=0)
        tau = kendalltau(both[0][good], both[1][good]).statistic
        lost.append((name, other[2, 3] / other[1, 3], own[1] / own[2], tau, int(good.sum())))
    print("\n| sand | robot's over walker's foot, on the robot | the reverse, on the walker | tau | soles |")
    print("| --- | --- | --- | --- | --- |")
    for name, there, here, tau, count in lost:
        print(f"| {name} | {there:.2f} | {here:.2f} | {tau:.2f} | {count} |")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:])) if len(sys.argv) > 1 else main(600, 200)
