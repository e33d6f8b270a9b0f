"""Wave time and sag of an elastic catenary, or of a part of one.

Source: docs/models/theory.md, "Outputs".
"""

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations.properties import property_of
from ..linear_algebra.vectors import add_scaled, cross, dot, norm
from ..rest.elastic_catenary import LEAST, point_in_space
from ..step.outputs import away_from_chord, place_along_chord, wave_time

SAMPLES = 24  # pieces of the catenary in which wave time and sag are found
HALVINGS = 40  # of the two pieces in which it is farthest from its chord


@kernel
def farthest_between(low, high, start, ground, chord, tension, load, stiffness):
    """Distance [m] from the chord where it is largest between two arcs [m]: (t - s q) . a = 0, with a from the chord."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        away = away_from_chord(point_in_space(start, tension, load, middle, stiffness), ground, chord)
        if dot(away, add_scaled(tension, -middle, load)) > 0.0:
            low = middle
        else:
            high = middle
    return norm(away_from_chord(point_in_space(start, tension, load, low, stiffness), ground, chord))


@kernel
def crossing_and_sag(line, start, length, ground, chord, tension, load):
    """Wave time [s] and largest distance [m] from the chord of a part of a catenary.

    Where it starts [m], its unstretched length [m], ground end of the chord [m], chord [m], tension vector at the start [N],
    load per unstretched length [N/m].
    """
    stiffness = property_of(line, 0, at.STIFFNESS)
    piece = length / SAMPLES
    # beside its chord the tether is farthest from it where it is parallel to it: (t - s q) x c = 0; hanging from ends one
    # above the other, in its fold: (t - s q) . q = 0
    bending = cross(load, chord)
    parallel = dot(cross(tension, chord), bending) / max(dot(bending, bending), LEAST)
    fold = dot(tension, load) / max(dot(load, load), LEAST)
    sag, farthest = 0.0, 0.0
    for arc in (parallel, fold):
        arc = min(length, max(0.0, arc))
        distance = norm(away_from_chord(point_in_space(start, tension, load, arc, stiffness), ground, chord))
        if distance > sag:
            sag, farthest = distance, arc
    crossing, longest = 0.0, 0.0
    for k in range(SAMPLES):
        middle = (k + 0.5) * piece
        pull = norm(add_scaled(tension, -middle, load))
        stretched = piece * (1.0 + pull / stiffness)
        longest = max(longest, stretched)
        crossing += wave_time(property_of(line, 0, at.LINE_DENSITY), piece, stretched, pull, stiffness)
        distance = norm(away_from_chord(point_in_space(start, tension, load, middle, stiffness), ground, chord))
        if distance > sag:
            sag, farthest = distance, middle
    place = place_along_chord(point_in_space(start, tension, load, farthest, stiffness), ground, chord)
    if min(place, 1.0 - place) * norm(chord) <= 2.0 * longest:  # it may be farthest beyond an end of the chord
        low, high = max(0.0, farthest - piece), min(length, farthest + piece)
        sag = max(sag, farthest_between(low, high, start, ground, chord, tension, load, stiffness))
    return crossing, sag
