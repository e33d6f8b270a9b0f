"""Initial rope lengths of the search in `rope_shares.py`: as specified, or from the distances of their points."""

from math import inf

from tetherfmu.runtime import layout as at

from ..compilation import kernel
from ..equations import winch
from ..equations.lines import inputs_of, lines_of, parameters_of, segments_of, state_of
from ..equations.properties import property_in
from ..equations.ropes import comes_from, goes_on, is_portion
from ..linear_algebra.vectors import norm, sub
from ..points.coordinates import (
    LENGTH_AT_REST,
    has_sought_drum,
    is_alone,
    is_shared_out,
    longest_of,
    numbers_at_rest,
    shortest_of,
)
from ..rest.resting_line import given_position, is_any_sought, is_sought
from ..rest.resting_ropes import part_of_drum

LEAST_PART = 0.01  # of a distance that is left for the rope over the sheave beside sections beyond it


@kernel
def has_several(system, k):
    """Whether line k carries a sought drum that is not equivalent to a winch of its own."""
    return has_sought_drum(system, k) and not is_alone(system, k)


@kernel
def straight_length(system, k, spans):
    """Unstretched length [m] at which a straight rope over this distance [m] pulls with the force of its winch."""
    stiffness = property_in(parameters_of(system, k), segments_of(system, k), 0, at.STIFFNESS)
    return spans / (1.0 + max(inputs_of(system, k)[at.WINCH_FORCE], 0.0) / stiffness)


@kernel
def span_of(system, k):
    """Distance of the ends of portion k if both are given [m], less what is `beyond`; else 0."""
    if is_sought(system, k, 0) or is_sought(system, k, 1):
        return 0.0
    span = norm(sub(given_position(system, k, 1), given_position(system, k, 0)))
    return max(span - beyond(system, k), LEAST_PART * span)


@kernel
def beyond(system, k):
    """Rope [m] of portion k beyond its section that runs over sheaves."""
    return parameters_of(system, k)[at.LENGTH_BEYOND] if is_portion(system, k) else 0.0


@kernel
def share_ropes(system, is_straight):
    """Lengths of all portions as specified, or from the distances of their points (modified); number of sought ones.

    is_straight : whether ropes with sought drums get their `straight_length`, or for several lines `draw_taut`.
    """
    sought = 0
    for k in range(lines_of(system)):
        sought += has_sought_drum(system, k)
        if is_shared_out(system, k) and not comes_from(system, k):
            for i in range(at.STATE_HEADER):
                state_of(system, k)[i] = 0.0  # for `first_length` of the whole rope
            whole = winch.first_length(parameters_of(system, k), inputs_of(system, k), state_of(system, k))
            last, given, spans, unknown = k, 0.0, 0.0, 0
            while goes_on(system, last):
                last += 1
            rest = beyond(system, last)
            for j in range(k, last + 1):
                given += parameters_of(system, j)[at.GIVEN_PORTION]
                spans += span_of(system, j)
                unknown += parameters_of(system, j)[at.GIVEN_PORTION] == 0.0
                sought += parameters_of(system, j)[at.GIVEN_PORTION] == 0.0
            if is_straight and has_sought_drum(system, k) and is_alone(system, k):
                whole = rest + straight_length(system, k, spans)
            if has_sought_drum(system, k) and goes_on(system, k):
                whole = min(max(whole, parameters_of(system, k)[at.SHORTEST_LENGTH]), longest_of(system, k))
            spread = 1.0 / (last + 1 - k)
            for j in range(k, last + 1):
                length = parameters_of(system, j)[at.GIVEN_PORTION] * whole / given if unknown == 0 else 0.0
                if unknown > 0:
                    span = span_of(system, j)
                    length = (whole - rest) * (span / spans if spans > 0.0 and span > 0.0 else spread) + beyond(system, j)
                numbers_at_rest(system, j)[LENGTH_AT_REST] = length
            if unknown > 0:
                even_out(system, k, last, whole)
    if is_straight:
        draw_taut(system)
    return sought


@kernel
def draw_taut(system):
    """Adjust drums of several lines (modified) so that all their lines are straight or taut."""
    for c in range(lines_of(system)):
        if has_several(system, c):
            least = inf
            for k in range(lines_of(system)):
                ratio, (_, length, spans) = part_of_drum(system, k, c), rope_at(system, k)
                if ratio > 0.0 and spans > 0.0:
                    least = min(least, (spans - length) / ratio)
            for k in range(lines_of(system)):
                ratio, (last, length, _) = part_of_drum(system, k, c), rope_at(system, k)
                if ratio != 0.0 and least < inf:
                    even_out(system, k, last, length + ratio * least)


@kernel
def rope_at(system, k):
    """Last portion of the rope that begins as line k, its length and the distance of its points [m]; 0 if any is sought."""
    length, spans, unknown = 0.0, 0.0, 0
    for j in range(k, lines_of(system)):
        length += numbers_at_rest(system, j)[LENGTH_AT_REST]
        spans += span_of(system, j) + beyond(system, j)
        unknown += is_any_sought(system, j)
        if not goes_on(system, j):
            return j, length, 0.0 if unknown > 0 else spans
    return k, length, spans


@kernel
def even_out(system, k, last, whole):
    """Set the total length [m] of the portions from k to the last (modified)."""
    total, rest = 0.0, beyond(system, last)
    for j in range(k, last + 1):
        total += numbers_at_rest(system, j)[LENGTH_AT_REST]
    for j in range(k, last + 1):
        length = numbers_at_rest(system, j)[LENGTH_AT_REST] - beyond(system, j)
        numbers_at_rest(system, j)[LENGTH_AT_REST] = length * ((whole - rest) / (total - rest)) + beyond(system, j)


@kernel
def fits(system):
    """Whether each rope is at least as long as its portions together."""
    room = 0.0
    for k in range(lines_of(system)):
        if is_portion(system, k):
            spare = numbers_at_rest(system, k)[LENGTH_AT_REST] - shortest_of(system, k)
            room = room + spare if comes_from(system, k) else spare
            if room < 0.0 and not goes_on(system, k):
                return False
    return True
