"""An order of the free points in which points on a common line have close numbers.

By distances along lines from a point at the rim of the network, backwards (reverse Cuthill-McKee).
Source: George and Liu, Computer Solution of Large Sparse Positive Definite Systems, section 4.3.
"""

from .portions import all_portions


def ordered(free, lines):
    """Names of the free points in their order, and the band of their matrix: how far neighbours are apart at most."""
    neighbours = {name: set() for name in free}
    for line in all_portions(lines):
        if line.start in neighbours and line.end in neighbours:
            neighbours[line.start].add(line.end)
            neighbours[line.end].add(line.start)
    found = []
    for name in free:
        if name not in found:
            found += _levels(_levels(name, neighbours)[-1], neighbours)
    found.reverse()
    numbers = {name: k for k, name in enumerate(found)}
    apart = max((abs(numbers[a] - numbers[b]) for a in free for b in neighbours[a]), default=0)
    return found, apart


def _levels(start, neighbours):
    """Points that can be reached from a start, the nearest first; of the neighbours of a point those with fewest first."""
    found, seen = [start], {start}
    for name in found:  # grows
        new = sorted(neighbours[name] - seen, key=lambda each: (len(neighbours[each]), each))
        seen.update(new)
        found += new
    return found
