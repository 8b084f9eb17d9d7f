"""Slips found in the paper, each with the reason and what footopt does instead."""

from __future__ import annotations

from typing import NamedTuple


class Erratum(NamedTuple):
    """A slip: where it is, what the paper has, why that cannot be meant, what footopt does."""

    place: str
    paper: str
    why: str
    footopt: str


ERRATA = (
    Erratum(
        "eqs. 1, 2",
        "f_j = alpha_j |z| H(-z)",
        "alpha is a stress per depth (N/m^3), so that this is a stress; the area of the plate is missing, "
        "and with it the width of the foot, which is not given anywhere",
        "multiplies by width times length of the plate; foot.width is .10 m and swept",
    ),
    Erratum(
        "eq. 1",
        "f_x = +alpha_x |z|, alpha_x from the published map",
        "the published alpha_x is positive against a forward motion, so that drag would push forwards",
        "f_x = -zeta alpha_x |z| dA, f_z = +zeta alpha_z |z| dA",
    ),
    Erratum(
        "eq. 2 and eq. 5",
        "the force on the body is the sum over the N plates",
        "N plates are one foot; the body stands on two",
        "sums both feet",
    ),
    Erratum(
        "eq. 3",
        "gamma = atan(v_z / v_x)",
        "loses the quadrant: a plate that moves down and back gets the stress of one that moves up and forth",
        "gamma = atan2(-v_z, v_x)",
    ),
    Erratum(
        "eq. 3",
        "gamma positive upwards",
        "the published map has gamma positive when the plate moves down",
        "gamma = atan2(-v_z, v_x)",
    ),
    Erratum(
        "eq. 3",
        "beta = atan((z_2 - z_1) / (x_2 - x_1))",
        "is not defined for an upright plate, such as a side of the L; the quadrant of beta does not "
        "matter, because the law depends on 2 beta only",
        "uses cos 2 beta and sin 2 beta of the chord, without an angle",
    ),
    Erratum(
        "text before eq. 2",
        "beta is measured clockwise from the x-axis",
        "eq. 3 with z upwards is counter-clockwise, and so is the stress map's own sense",
        "counter-clockwise",
    ),
    Erratum(
        "text after eq. 4",
        "theta_A = pi/2 - (theta_1 + theta_2), omega_A = omega_1 + omega_2",
        "the rate has the other sign than the angle; a straight standing leg would have its foot "
        "upright; and a knee that flexes turns the shank back, against the thigh",
        "pitch of the foot = shank angle = thigh - knee, its rate the derivative of that",
    ),
    Erratum(
        "text after eq. 4",
        "theta_A is the ankle joint angle",
        "it turns the foot's frame into the world's, and so is the foot's pitch; with the ankle locked "
        "that is the shank's, with a moving ankle another one",
        "gait.pitch=shank (the formula), or measured; swept",
    ),
    Erratum(
        "text after eq. 4",
        "the ankle follows from inverse kinematics",
        "joint angles are given and positions follow: forward kinematics",
        "x = l1 sin(thigh) + l2 sin(shank), z = -l1 cos(thigh) - l2 cos(shank)",
    ),
    Erratum(
        "eq. 6",
        "explicit Euler with a small time step, which is not given",
        "the law jumps where a plate's velocity turns, so that a standing walker chatters at every "
        "step size (footopt study=stability)",
        "an implicit step and a creep speed that smooths the jump; explicit Euler is there by name",
    ),
    Erratum(
        "eqs. 7, 10",
        "W is the integral over N plates; |W(t_f)| enters J_W; Fig. 4b shows W_l and W_r",
        "does not say whether J_W counts one leg or both",
        "both feet",
    ),
    Erratum(
        "text before eq. 9",
        "p_max = max(sum P_i)",
        "P = f.v is negative wherever the sand resists: the largest value is no peak but about zero",
        "the largest |sum f.v| of one foot",
    ),
    Erratum(
        "text before eq. 9",
        "p_max during a single-stance phase; its formula is over all times",
        "the two differ: the largest power comes at heel strike, in double stance",
        "all times from the first heel strike; study.peak_power=single is the other, swept",
    ),
    Erratum(
        "eq. 10",
        "dV_x, the forward velocity change when the stance leg switches",
        "is not defined",
        "the largest fall below the running maximum; study.speed_loss=window is another, swept",
    ),
    Erratum(
        "text before eq. 9",
        "the mean height of the COM measures sinkage",
        "it holds the height of the foot under the ankle as well: a thicker foot seems to sink less",
        "kept, since J_W is the paper's; claims on sinkage are decided by the depth of the sole",
    ),
    Erratum(
        "eq. 9, text after eq. 11",
        "the larger J_W, the more efficient",
        "J_W is negative and minimised: the smaller, the more efficient",
        "minimises J_W = -distance * mean height / (|W| p_max dV_x)",
    ),
    Erratum(
        "eq. 8",
        "x_i = (i - 1)(3 - n) L / (n - 1)",
        "runs from 0 to (3 - n) L, for n = 11 eight half-lengths behind the heel; it does not span the box",
        "x_i = -L + 2 L (i - 1) / (n - 1)",
    ),
    Erratum(
        "text before eq. 8",
        "the contour is restricted to the box",
        "only waypoints are: the spline between them leaves the box in seven of ten random feet",
        "a constraint with a tolerance; foot.box_tolerance=.inf is the paper, swept",
    ),
    Erratum(
        "eq. 11",
        "a mixed integer problem, a multi-objective one (abstract)",
        "all variables are integers and the objective is one scalar",
        "a GA on whole numbers for J_W; several objectives with solver=nsga2",
    ),
    Erratum(
        "Fig. 7",
        "caption: second row regular sand; text: feet for hard and soft sand",
        "the same paragraph calls it the green solid line, which is regular sand",
        "regular sand",
    ),
    Erratum(
        "Fig. 8c",
        "caption: right legs; text: both legs",
        "the two cannot both be meant",
        "shows both",
    ),
    Erratum(
        "Fig. 4",
        "the sand on which the five shapes walk is not named",
        "three sands come later",
        "regular sand, whose map is the generic one; study.shape_sand, swept",
    ),
    Erratum(
        "Fig. 3",
        "sides a:b = 2:1 for the other shapes",
        "a circle has no sides, and which sides of the triangle and the L are meant is not said",
        "base to height 2:1; orientations by foot.apex and foot.upright, swept",
    ),
    Erratum(
        "text",
        "the thing link; unnecessarily convex",
        "thigh; not necessarily convex",
        "reads them so",
    ),
)
