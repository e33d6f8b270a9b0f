"""Dense equations with a profile: L U without pivoting; nothing is stored in a row before its first entry.

The profile is symmetric: row i of L begins in the same column as column i of U begins in its row. Both are stored side by
side, so every inner product runs through two contiguous arrays:

    lower : rows of L with the diagonal of U, inverted by `factorize`;  upper : columns of U above it
    a place of row i is `start[i]` + column
"""

from collections import namedtuple

from ..compilation import kernel

Profile = namedtuple("Profile", "first start lower upper")
Profile.__doc__ = """A matrix of len(first) rows.

first : the first column of each row.  start : place of column 0 of each row, if it had one.  lower, upper : see above.
"""


@kernel
def begin(profile, m):
    """Places of all m rows from their first columns (modified); the length of `lower` and of `upper`."""
    place = 0
    for i in range(m):
        profile.start[i] = place - int(profile.first[i])
        place += i + 1 - int(profile.first[i])
    return place


@kernel
def join(profile, i, j):
    """Extend the profile (modified) by the entries i, j and j, i."""
    low, high = min(i, j), max(i, j)
    profile.first[high] = min(profile.first[high], low)


@kernel
def add_entry(profile, i, j, value):
    """Add a number to the entry i, j (modified), which must be in the profile."""
    if j <= i:
        profile.lower[int(profile.start[i]) + j] += value
    else:
        profile.upper[int(profile.start[j]) + i] += value


@kernel
def add_block(profile, row, column, block):
    """Add a 3x3 matrix to the entries from a row and a column on (modified)."""
    for i in range(3):
        for j in range(3):
            add_entry(profile, row + i, column + j, block[3 * i + j])


@kernel
def clear(profile, m):
    """Set all entries of m rows to 0 (modified)."""
    count = int(profile.start[m - 1]) + m if m > 0 else 0
    for i in range(count):
        profile.lower[i] = profile.upper[i] = 0.0


@kernel
def hold_row(profile, m, i):
    """Replace row i (modified) by a unit row."""
    for j in range(int(profile.first[i]), i):
        profile.lower[int(profile.start[i]) + j] = 0.0
    profile.lower[int(profile.start[i]) + i] = 1.0
    for j in range(i + 1, m):
        if int(profile.first[j]) <= i:
            profile.upper[int(profile.start[j]) + i] = 0.0


@kernel
def inner(a, at_a, b, at_b, count):
    """Inner product of `count` numbers of two arrays."""
    total = 0.0
    for k in range(count):
        total += a[at_a + k] * b[at_b + k]
    return total


@kernel
def factorize(profile, m):
    """Factorize m rows in place (modified); False if a pivot is 0 or not a number."""
    first, start, lower, upper = profile
    regular = True
    for i in range(m):
        own, here = int(first[i]), int(start[i])
        for j in range(own, i):
            there = int(start[j])
            begin = max(own, int(first[j]))
            left = lower[here + j] - inner(lower, here + begin, upper, there + begin, j - begin)
            upper[here + j] -= inner(lower, there + begin, upper, here + begin, j - begin)
            lower[here + j] = left * lower[there + j]
        pivot = lower[here + i] - inner(lower, here + own, upper, here + own, i - own)
        regular = regular and abs(pivot) > 0.0
        lower[here + i] = 1.0 / pivot
    return regular


@kernel
def less(number, a, at_a, b, at_b, count):
    """A number minus the inner product of `inner`, one product after the other."""
    for k in range(count):
        number -= a[at_a + k] * b[at_b + k]
    return number


@kernel
def factorize_definite(profile, m):
    """Factorize m rows in place (modified); False if a pivot is not positive.

    Products are subtracted one by one: with lines that are far stiffer axially than laterally, sums of them lose accuracy.
    """
    first, start, lower, upper = profile
    for i in range(m):
        own, here = int(first[i]), int(start[i])
        for j in range(own, i):
            there = int(start[j])
            begin = max(own, int(first[j]))
            left = less(lower[here + j], lower, here + begin, upper, there + begin, j - begin)
            upper[here + j] = less(upper[here + j], lower, there + begin, upper, here + begin, j - begin)
            lower[here + j] = left * lower[there + j]
        pivot = less(lower[here + i], lower, here + own, upper, here + own, i - own)
        if not pivot > 0.0:
            return False
        lower[here + i] = 1.0 / pivot
    return True


@kernel
def solve_back(profile, m, solution):
    """Solve with the columns of U for a right-hand side, which becomes the solution."""
    first, start, lower, upper = profile
    for i in range(m - 1, -1, -1):
        own, here = int(first[i]), int(start[i])
        solution[i] *= lower[here + i]
        for k in range(own, i):
            solution[k] -= upper[here + k] * solution[i]


@kernel
def solve(profile, m, right, solution):
    """Solution (modified) of m factorized equations."""
    first, start, lower, _ = profile
    for i in range(m):
        own, here = int(first[i]), int(start[i])
        solution[i] = right[i] - inner(lower, here + own, solution, own, i - own)
    solve_back(profile, m, solution)


@kernel
def solve_definite(profile, m, right, solution):
    """`solve` after `factorize_definite`, also one product at a time."""
    first, start, lower, _ = profile
    for i in range(m):
        own, here = int(first[i]), int(start[i])
        solution[i] = less(right[i], lower, here + own, solution, own, i - own)
    solve_back(profile, m, solution)
