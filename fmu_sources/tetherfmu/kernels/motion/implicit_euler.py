"""Backward Euler with a fixed step: bounded at any step and in bounded work, for real time.

The positions x after a step of h make the incremental potential as small as a bounded number of Newton iterations can:

    Phi(x) = sum_i m_i |x_i - y_i|^2/(2 h^2) + sum_s (k (l - l0)^2/2 + c rho^2/(2 h)) + drag,   v1 = (x - x0)/h
    y_i = x0 + h v0 + h^2 (gravity + load/m_i)            where a node would fly freely
    rho = b l - e . r0,   b = 1 - h dl0/dt/l0             h times the rate that the damper sees; r0: r before the step
    drag = sum_s h u . A u - F . (x_p + x_q)              u: change of the mean velocity of the nodes p, q of a segment

Its gradient is zero where the equations of motion hold with the forces of the new positions and velocities: backward
Euler. Its matrix is made positive definite (no negative tension across a segment), so that iterations descend; one that
would not is shortened, or left out. So Phi never exceeds its value at the start of the iteration, whatever the step.
A step whose iteration has not come to rest after `MOST_ITERATIONS` is taken again in `PARTS` equal parts, those that have
not in `PARTS` again; of these each is taken as it is after `LAST_ITERATIONS`.

Half drag F and its slope A are those of the old velocities and of the directions at the start of the iteration. A driven
end is where its curve is; its old position counts as x - h v, so that the damper sees its exact velocity.

Sources: Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.3; Martin, Thomaszewski, Grinspun and
Gross, Example-based elastic materials, ACM Trans. Graph. 30 (2011), section 4 (incremental potential).
"""

from math import ceil, inf, sqrt

from tetherfmu.kernels.algebra.block_tridiagonal import factorize, solve
from tetherfmu.kernels.algebra.vectors import add, along, apply, dot, get, get_matrix, norm, put, put_matrix, scale, sub
from tetherfmu.kernels.chain import nodes, segment
from tetherfmu.kernels.communication.drive import place_ends
from tetherfmu.kernels.compilation import kernel, view
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import FIXED_STEPS_TOO_MANY, OK, STATE_NOT_FINITE

MOST_ITERATIONS = 8
LAST_ITERATIONS = 32  # of the finest parts
PARTS = 4
FINEST = PARTS**2
WORST_WORK = MOST_ITERATIONS * (1 + PARTS) + LAST_ITERATIONS * FINEST  # iterations for one fixed step
MOST_HALVINGS = 8
CLOSE = 1e-6  # largest move of a node over the length of a segment in the last iteration; the error after it is its square
ROUNDING = 1e-15  # of positions and of the terms of the potential, relative
SHORTEST_PART = 0.1  # of its old length, to which a segment counts as shortened where it turns


@view
def parts(n, w):
    """Arrays of a step: old positions, free flight y, half drags F, their slopes A, positions to try."""
    nodes = 3 * (n + 1)
    many = w.velocities
    return many[:nodes], many[nodes : 2 * nodes], many[2 * nodes : 3 * nodes], many[3 * nodes : 6 * nodes], w.momentum


@kernel
def stretch(s, n, h, x, rest, rest_rate, parameters, w):
    """Length [m], direction, spring k [N/m], damper c/h [N/m], rho [m], and old vector between the nodes of a segment.

    The branch of k is that of the positions x [m], that of c stands in w.branches.
    """
    old, _, _, _, _ = parts(n, w)
    r0 = sub(get(old, s + 1), get(old, s))
    length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
    k = parameters[at.PARAMETER_SCALARS + at.STIFFNESS * n + s] / rest
    if length <= rest:
        k *= parameters[at.SLACK_STIFFNESS_RATIO]
    c = parameters[at.PARAMETER_SCALARS + at.DAMPING * n + s] / rest
    if w.branches[s] == segment.SLACK:
        c *= parameters[at.SLACK_DAMPING_RATIO]
    growth = h * rest_rate / rest if parameters[at.DAMPING_LAW] == at.STRAIN_RATE else 0.0
    return length, e, k, c / h, (1.0 - growth) * length - dot(e, r0), r0


@kernel
def velocity_change(s, n, h, x, v, w):
    """Mean velocity change u [m/s] of the nodes of a segment that are at x [m] after the step; v [m/s]: before it."""
    old, _, _, _, _ = parts(n, w)
    moved = add(sub(get(x, s), get(old, s)), sub(get(x, s + 1), get(old, s + 1)))
    return scale(0.5, sub(scale(1.0 / h, moved), add(get(v, s), get(v, s + 1))))


@kernel
def potential(n, drive, h, length, x, v, parameters, w):
    """Phi [J] at the positions x [m], and its error of rounding [J]; unstretched length of the tether [m] after the step."""
    old, free, drag, slope, _ = parts(n, w)
    total = 0.0
    size = 0.0
    for i in range(drive.first, drive.last + 1):
        away = sub(get(x, i), get(free, i))
        total += 0.5 * w.mass[i] / (h * h) * dot(away, away)
    for s in range(n):
        rest = nodes.rest_length(s, length, parameters)
        rest_rate = nodes.rest_length(s, drive.reeling, parameters)
        distance, _, k, damper, rho, _ = stretch(s, n, h, x, rest, rest_rate, parameters, w)
        total += 0.5 * k * (distance - rest) ** 2 + 0.5 * damper * rho * rho
        size += (k * abs(distance - rest) + damper * abs(rho)) * (norm(get(x, s)) + distance)
        u = velocity_change(s, n, h, x, v, w)
        moved = add(sub(get(x, s), get(old, s)), sub(get(x, s + 1), get(old, s + 1)))
        work = dot(get(drag, s), moved)
        total += h * dot(u, apply(get_matrix(slope, 9 * s), u)) - work
        size += abs(work)
    return total, ROUNDING * (size + abs(total))


@kernel
def linearize(n, drive, h, length, x, v, parameters, w):
    """Matrix of the iteration into the block arrays of w, minus the gradient of Phi into w.b (all modified)."""
    _, free, drag, slope, _ = parts(n, w)
    for i in range(n + 1):
        m = w.mass[i] / (h * h)
        put_matrix(w.diagonal, 9 * i, (m, 0.0, 0.0, 0.0, m, 0.0, 0.0, 0.0, m))
        put(w.b, i, scale(m, sub(get(free, i), get(x, i))))
    for s in range(n):
        rest = nodes.rest_length(s, length, parameters)
        rest_rate = nodes.rest_length(s, drive.reeling, parameters)
        distance, e, k, damper, rho, r0 = stretch(s, n, h, x, rest, rest_rate, parameters, w)
        turned = along(r0, -dot(e, r0), e)
        slant = along(e, -1.0 / max(distance, SHORTEST_PART * norm(r0), segment.SHORTEST), turned)
        pull = add(scale(k * (distance - rest), e), scale(damper * rho, slant))
        across = max(k * (distance - rest) + damper * rho, 0.0) / distance
        air = sub(get(drag, s), apply(get_matrix(slope, 9 * s), velocity_change(s, n, h, x, v, w)))
        put(w.b, s, add(get(w.b, s), add(air, pull)))
        put(w.b, s + 1, add(get(w.b, s + 1), sub(air, pull)))
        for i in range(3):
            for j in range(3):
                stiff = (k - across) * e[i] * e[j] + damper * slant[i] * slant[j]
                if i == j:
                    stiff += across
                both = 0.5 / h * slope[9 * s + 3 * i + j]
                w.diagonal[9 * s + 3 * i + j] += stiff + both
                w.diagonal[9 * s + 9 + 3 * i + j] += stiff + both
                w.upper[9 * s + 3 * i + j] = both - stiff
                w.lower[9 * s + 9 + 3 * i + j] = both - stiff


@kernel
def direction(n, drive, h, length, x, v, parameters, w):
    """Move of all nodes [m] by Newton's method from the positions x [m] into w.b (modified).

    Returns the part of it in which no segment changes by more than its length, 0 where the matrix is singular.
    """
    linearize(n, drive, h, length, x, v, parameters, w)
    if not factorize(drive.first, drive.last, w.diagonal, w.lower, w.upper):
        return 0.0
    solve(drive.first, drive.last, w.diagonal, w.lower, w.upper, w.b)
    if drive.first == 1:
        put(w.b, 0, (0.0, 0.0, 0.0))
    if drive.last == n - 1:
        put(w.b, n, (0.0, 0.0, 0.0))
    part = 1.0
    for s in range(n):
        rest = nodes.rest_length(s, length, parameters)
        part = min(part, rest / max(norm(sub(get(w.b, s + 1), get(w.b, s))), rest))
    return part


@kernel
def descend(n, drive, h, length, x, v, before, parameters, w):
    """One iteration from the positions x [m] (modified) whose Phi is `before` [J].

    Returns Phi [J] and the largest move of a node [m]: -1 where no part of the step goes down, inf where the matrix is
    singular.
    """
    _, _, _, _, trial = parts(n, w)
    part = direction(n, drive, h, length, x, v, parameters, w)
    if part == 0.0:
        return before, inf
    for _ in range(MOST_HALVINGS + 1):
        for k in range(3 * (n + 1)):
            trial[k] = x[k] + part * w.b[k]
        now, rounding = potential(n, drive, h, length, trial, v, parameters, w)
        if now <= before + rounding:
            square = 0.0
            for i in range(n + 1):
                move = get(w.b, i)
                square = max(square, dot(move, move))
                put(x, i, get(trial, i))
            return now, part * sqrt(square)
        part *= 0.5
    return before, -1.0


@kernel
def begin(n, drive, time, h, x, v, parameters, w):
    """Fill old positions, free flight and branches of the dampers into w for a step of h [s] at a time [s]; no drag."""
    old, free, drag, slope, _ = parts(n, w)
    length = drive.length + drive.reeling * (time + h)
    nodes.node_masses(n, length, parameters, w.mass)
    weight = (0.0, 0.0, -parameters[at.GRAVITY])
    place_ends(n, drive, time + h, old, free)  # `free` holds the velocities of the ends for the moment
    for i in range(n + 1):
        if drive.first <= i <= drive.last:
            put(old, i, get(x, i))
            put(free, i, along(along(get(x, i), h, get(v, i)), h * h, weight))
        else:
            end = get(old, i)
            put(old, i, along(end, -h, get(free, i)))
            put(free, i, end)
    if drive.last == n:
        put(free, n, along(get(free, n), h * h / w.mass[n], drive.load))
    for s in range(n):
        taut = norm(sub(get(x, s + 1), get(x, s))) > nodes.rest_length(s, drive.length + drive.reeling * time, parameters)
        w.branches[s] = segment.TAUT if taut else segment.SLACK
        put(drag, s, (0.0, 0.0, 0.0))
        put_matrix(slope, 9 * s, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


@kernel
def guess(n, drive, h, length, x, v, parameters, w):
    """Positions [m] to start from into w.x_stage (modified): free flight, or carried along by the ends.

    The one with the lower potential. A flight of many segment lengths in a step tears the chain; so does, where it swings,
    a chain that keeps its shape.
    """
    _, free, _, _, trial = parts(n, w)
    ground = sub(get(free, 0), get(x, 0)) if drive.first == 1 else (0.0, 0.0, 0.0)
    kite = sub(get(free, n), get(x, n)) if drive.last == n - 1 else ground
    part = 0.0
    for i in range(n + 1):
        put(w.x_stage, i, get(free, i))
        put(trial, i, along(along(get(x, i), 1.0 - part, ground), part, kite))
        if i < n:
            part += parameters[at.PARAMETER_SCALARS + i]
    put(trial, n, add(get(x, n), kite))
    carried, _ = potential(n, drive, h, length, trial, v, parameters, w)
    flying, _ = potential(n, drive, h, length, w.x_stage, v, parameters, w)
    if carried < flying:
        for k in range(3 * (n + 1)):
            w.x_stage[k] = trial[k]


@kernel
def add_drag(n, drive, x, v, parameters, w):
    """Half drags F [N] and slopes A [N s/m] of all segments into w, at the positions x [m] and the velocities v [m/s]."""
    _, _, drag, slope, _ = parts(n, w)
    for s in range(n):
        length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        height = 0.5 * (x[3 * s + 2] + x[3 * s + 5])
        mean = scale(0.5, add(get(v, s), get(v, s + 1)))
        wind, _, density = segment.apparent_wind(e, height, mean, drive.wind, parameters)
        speed = sqrt(dot(wind, wind) + segment.STILLEST)
        width = 0.25 * density * length * parameters[at.PARAMETER_SCALARS + at.DRAG_WIDTH * n + s]
        put(drag, s, scale(width * speed, wind))
        for i in range(3):
            for j in range(3):
                slope[9 * s + 3 * i + j] = width * (wind[i] * wind[j] / speed - speed * e[i] * e[j])
            slope[9 * s + 4 * i] += width * speed


@kernel
def step(n, drive, time, h, in_any_case, x, v, parameters, w):
    """One step of h [s] of (x, v) (modified) at a time [s] of the communication step.

    in_any_case : whether to iterate longer, and to take a result that has not come to rest. Returns whether it was taken,
    and the number of iterations, negative where the matrix is singular.
    """
    length = drive.length + drive.reeling * (time + h)
    begin(n, drive, time, h, x, v, parameters, w)
    guess(n, drive, h, length, x, v, parameters, w)
    add_drag(n, drive, w.x_stage, v, parameters, w)
    phi, _ = potential(n, drive, h, length, w.x_stage, v, parameters, w)
    goal = CLOSE * drive.length / n
    iterations = 0
    farthest = inf
    most = LAST_ITERATIONS if in_any_case else MOST_ITERATIONS
    while iterations < most and farthest > goal:
        phi, farthest = descend(n, drive, h, length, w.x_stage, v, phi, parameters, w)
        iterations += 1
        if not farthest < inf:
            return False, -1
    if not (in_any_case or 0.0 <= farthest <= goal):
        return False, iterations
    for k in range(3 * drive.first, 3 * drive.last + 3):
        v[k] = (w.x_stage[k] - x[k]) / h
        x[k] = w.x_stage[k]
    place_ends(n, drive, time + h, x, v)
    return True, iterations


@kernel
def careful_step(n, drive, time, h, x, v, parameters, w):
    """One step of h [s] of (x, v) (modified), in parts where it does not come to rest as a whole.

    Returns the number of iterations, at most `WORST_WORK`; negative where the matrix is singular.
    """
    iterations = 0
    done = 0  # in parts of the finest kind
    size = FINEST
    while done < FINEST:
        start = time + h * done / FINEST
        taken, more = step(n, drive, start, h * size / FINEST, size == 1, x, v, parameters, w)
        if more < 0:
            return more
        iterations += more
        if not taken:
            size //= PARTS
            continue
        done += size
        while size < FINEST and done % (size * PARTS) == 0:
            size *= PARTS
    return iterations


@kernel
def integrate(n, drive, duration, state, x, v, parameters, w):
    """Advance (x, v) (modified) over a communication step of `duration` [s] with steps of `fixed_step`.

    A communication step that is no multiple is divided evenly into steps of at most `fixed_step`. Counters in `state` are
    modified. Returns a status: OK, FIXED_STEPS_TOO_MANY or STATE_NOT_FINITE.
    """
    wanted = duration / parameters[at.FIXED_STEP] - 1e-6
    budget = at.WORK_BUDGET // n
    if not wanted <= budget:
        return FIXED_STEPS_TOO_MANY
    count = max(1, ceil(wanted))
    h = duration / count
    spent = 0
    for i in range(count):
        if spent > budget:
            return FIXED_STEPS_TOO_MANY
        iterations = careful_step(n, drive, i * h, h, x, v, parameters, w)
        if iterations < 0:
            return STATE_NOT_FINITE
        spent += iterations
    state[at.STEPS] += count
    state[at.ITERATIONS] += spent
    return OK
