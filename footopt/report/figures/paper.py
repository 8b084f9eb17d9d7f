"""The paper's figures with their captions: gait, shapes, waypoints, and walks by shape and by sand."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from footopt.files.feet import MM
from footopt.foot import SHAPES
from footopt.gait import Gait
from footopt.report import style
from footopt.report.figures.foot import contour, contours
from footopt.report.figures.gait import draw_angles, draw_path
from footopt.report.figures.walks import com, forces, power_work, step
from footopt.report.numbers import title
from footopt.walk import Walk, Walker


@style.styled()
def gait(shown: Gait, walker: Walker) -> Figure:
    """Fig. 2b: the joint angles over a stride, and the ankle's path around the hip."""
    figure = style.new_figure(style.PAGE, 2.5)
    angles, path = figure.subplots(1, 2)
    draw_angles(angles, shown)
    draw_path(path, shown, walker)
    style.legend_above(figure)
    return figure


def all_figures(walks: Mapping[str, Walk]) -> dict[str, tuple[Figure, str]]:
    """The paper's figures and their captions, by file name.

    They show walks of the five shapes and of each sand's best foot by their names, and "crossed", that of the
    foot for regular sand on hard sand.
    """
    by_shape = {title(name): walks[name] for name in SHAPES}
    by_sand = {sand: walks[sand] for sand in style.SANDS}
    crossed, hard = walks["crossed"], walks["hard"]
    shapes = {name: walk.foot for name, walk in by_shape.items()}
    feet = {f"{sand} (hollow {MM * w.foot.hollow:.1f} mm)": w.foot for sand, w in by_sand.items()}
    joints = gait(crossed.scene.gait, crossed.scene.walker)
    waypoints = contour(hard.foot)
    return {
        "fig2b_gait": (joints, "Joint angles over a stride, and the ankle's path (figure 2b)."),
        "fig3_shapes": (contours(shapes), "The five shapes, all of one length (figure 3)."),
        "fig4a_shapes_states": (com(by_shape), "Position and velocity of the COM by shape (figure 4a)."),
        "fig4b_shapes_power_work": (power_work(by_shape), "Power and work by shape (figure 4b)."),
        "fig5_waypoints": (waypoints, "The waypoints of a sole, their box, and its spline (figure 5)."),
        "fig6_contours": (contours(feet), "The best soles for soft, regular and hard sand (figure 6)."),
        "fig7a_step": (step(hard), "A step on hard sand with its best foot (figure 7)."),
        "fig7b_step": (step(crossed), "The same with the best foot for regular sand (figure 7)."),
        "fig8a_sands_states": (com(by_sand), "Position and velocity of the COM by sand (figure 8a)."),
        "fig8b_sands_forces": (forces(by_sand), "Force on each foot by sand (figure 8b)."),
        "fig8c_sands_power_work": (power_work(by_sand), "Power and work by sand (figure 8c)."),
    }
