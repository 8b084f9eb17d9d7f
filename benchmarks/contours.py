"""What a foot given by its contour costs beside the same foot given by waypoints."""

from __future__ import annotations

import time

from measure import feet, interleaved

import footopt as fo

DESIGNS, REPEATS = 200, 15


def main() -> None:
    """Print the processor time of a walk by both ways, and their ratio."""
    scene, k = fo.Scene(), feet(DESIGNS)
    contours = [fo.Foot.from_waypoints(heights).contour for heights in k]
    jobs = {
        "waypoints": lambda: fo.evaluate(k, scene, threads=1),
        "contours": lambda: fo.evaluate([fo.Foot(contour) for contour in contours], scene, threads=1),
    }
    seconds = interleaved(jobs, REPEATS, time.process_time)
    for name, taken in seconds.items():
        print(f"{name}: {1e3 * taken / DESIGNS:.3f} ms a walk")
    print(f"ratio: {seconds['contours'] / seconds['waypoints']:.2f}")


if __name__ == "__main__":
    main()
