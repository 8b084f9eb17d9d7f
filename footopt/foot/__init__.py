"""The foot: a sole's contour, the design space of waypoints, and the plates that feel the sand."""

from footopt.foot.foot import Foot, Soles, as_feet, as_plates, lower_hull
from footopt.foot.plates import Plates
from footopt.foot.shapes import SHAPES
from footopt.foot.waypoints import Waypoints, as_space

__all__ = ["SHAPES", "Foot", "Plates", "Soles", "Waypoints", "as_feet", "as_plates", "as_space", "lower_hull"]
