"""Broad phase: pairs of boxes (along the axes) that overlap, found in a grid of cells.

Lesson 6 searches for the pairs of given boxes once.  Here the boxes are wider than the bodies, so that the same pairs
serve many steps.
"""

from typing import NamedTuple

import numpy as np

from ..checks import Diverged

CELLS_PER_BODY = 8           # at most [-]: a body that flies far away must not make the grid huge
LARGEST = 0.5 * np.finfo(np.float64).max                     # half of the largest number
FINEST = 1e-9                # least edge of a cell over the extent of all bodies [-]: so its place is an exact integer


class Pairs(NamedTuple):
    """Body i may touch partner[first[i]], …, partner[first[i + 1] − 1], all with greater numbers.

    Plane p is body n + p.
    """
    first: np.ndarray        # (n + 1,)
    partner: np.ndarray      # (pairs,)


def cell_numbers(low, size):
    """(cell (n,), stride (d,), cells): the cell of each box's low corner, in a grid with an empty rim on all sides."""
    n, d = low.shape
    cell, stride, cells = np.zeros(n, np.int64), np.ones(d, np.int64), 1
    for c in range(d):
        least, last = np.min(low[:, c]), 0
        stride[c] = cells
        for i in range(n):
            place = int((low[i, c] - least) / size) + 1
            cell[i] += cells * place
            last = max(last, place)
        cells *= last + 2
    return cell, stride, cells


def cell_size(low, high):
    """Edge of the cells [m]: the largest box, doubled until the grid, its rim left out, has few enough cells.

    Raises Diverged where a corner or the extent of all is not finite, or a low corner is above a high one.
    """
    n, d = low.shape
    size, span = 0.0, np.empty(d)
    for c in range(d):
        least, last, most, widest = np.inf, -np.inf, -np.inf, 0.0
        for i in range(n):
            a, b = low[i, c], high[i, c]
            if not -np.inf < a <= b < np.inf:
                raise Diverged("the extent of all bodies [m]", abs(a) + abs(b), "take more substeps")
            least, last, most, widest = min(least, a), max(last, a), max(most, b), max(widest, b - a)
        if not 0.5 * most - 0.5 * least < LARGEST:
            raise Diverged("the extent of all bodies [m]", np.inf, "take more substeps")
        size, span[c] = max(size, widest, FINEST * (most - least)), last - least
    if size == 0.0:                                          # so far out that boxes and ways between them round to 0
        return 1.0
    while cells_inside(span, size) > CELLS_PER_BODY * n:
        size *= 2.0
    return size


def cells_inside(span, size):
    """The number of cells that low corners with this span (d,) lie in, the rim left out; a float: it may be huge."""
    count = 1.0
    for width in span:
        count *= np.floor(width / size) + 1.0
    return count


def sorted_by_cell(cell, cells):
    """(start (cells + 2,), order (n,)): the boxes of cell c are order[start[c]:start[c + 1]].  A counting sort."""
    start, order = np.zeros(cells + 2, np.int64), np.zeros(cell.size, np.int64)
    for c in cell:
        start[c + 2] += 1
    for c in range(2, start.size):
        start[c] += start[c - 1]
    for i in range(cell.size):
        order[start[cell[i] + 1]] = i
        start[cell[i] + 1] += 1
    return start, order


def boxes_overlap(low, high, i, j):
    """Whether boxes i and j overlap or touch."""
    for c in range(low.shape[1]):
        if low[i, c] > high[j, c] or low[j, c] > high[i, c]:
            return False
    return True


def box_reaches(low, high, i, plane):
    """Whether box i reaches a plane, (n, d) in one row: n · p + d = 0."""
    d = low.shape[1]
    distance = plane[d]
    for c in range(d):
        distance += plane[c] * (low[i, c] if plane[c] > 0.0 else high[i, c])
    return distance <= 0.0


def near_pairs(low, high, planes):
    """Pairs of boxes that overlap, and of boxes and the planes that they reach.

    Corners low and high (n, d) and planes (p, d + 1).  Boxes that only touch may be left out, by round-off.
    Raises Diverged where a corner or the extent of all is not finite, or a low corner is above a high one.
    """
    n, d = low.shape
    cell, stride, cells = cell_numbers(low, cell_size(low, high))
    start, order = sorted_by_cell(cell, cells)
    first, partner = np.zeros(n + 1, np.int64), [0 for _ in range(0)]
    for i in range(n):
        for around in range(3 ** (d - 1)):  # rows of three cells that lie side by side in `order`
            middle = cell[i] + (around % 3 - 1) * stride[1]
            if d == 3:
                middle += (around // 3 - 1) * stride[2]
            for k in range(start[middle - 1], start[middle + 2]):
                if order[k] > i and boxes_overlap(low, high, i, order[k]):
                    partner.append(order[k])
        for p in range(planes.shape[0]):
            if box_reaches(low, high, i, planes[p]):
                partner.append(n + p)
        first[i + 1] = len(partner)
    return Pairs(first, np.array(partner, dtype=np.int64))


def pairs_with(marked, pairs):
    """Return those Pairs of which at least one body is marked, (n + p,)."""
    first, partner, m = np.zeros(pairs.first.size, np.int64), np.empty(pairs.partner.size, np.int64), 0
    for i in range(first.size - 1):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            partner[m] = pairs.partner[k]                                # a branch here would be guessed wrong often
            m += marked[i] | marked[pairs.partner[k]]
        first[i + 1] = m
    return Pairs(first, partner[:m])
