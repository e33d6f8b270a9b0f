"""What a point of the stability map asks for that no tether can do: known from the point alone, before it is flown.

Three requests, in this order:

- reeled in too far: at the end of the flight the segments would be shorter than the shortest that is allowed;
- too stiff for its mass: axial waves would be faster than sound can be in any solid, sqrt(EA/mu) > 36 km/s
  (K. Trachenko et al., Speed of sound from fundamental physical constants, Science Advances 6 (2020) eabc8662);
- too soft for its load: L (mu g + rho cd d U^2/2) > EA, so that it would be stretched to more than twice its length, if it
  held; U is the sum of the speeds of wind and kite.

They count in the map as all others do, and once more apart.
"""

from math import sqrt

from tetherfmu.runtime import layout as at

from .flight import DRAG_FACTOR, LINE_DENSITY
from .points import CALLS

FASTEST_SOUND = 36e3  # [m/s]
POSSIBLE = "what a tether can do"
REQUESTS = (POSSIBLE, "reeled in too far", "too stiff for its mass", "too soft for its load")


def request(point):
    """What a `MapPoint` asks for: a word of `REQUESTS`."""
    shortest = point.length + CALLS * point.step * min(0.0, point.reel_out_speed)
    if point.control != at.WINCH_BY_FORCE and shortest < at.MIN_SEGMENT_LENGTH * point.segments:
        return REQUESTS[1]
    if sqrt(point.axial_stiffness / LINE_DENSITY) > FASTEST_SOUND:
        return REQUESTS[2]
    speed = point.wind + point.speed
    load = point.length * (LINE_DENSITY * point.gravity + DRAG_FACTOR * speed * speed)
    return REQUESTS[3] if load > point.axial_stiffness else POSSIBLE
