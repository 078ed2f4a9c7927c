"""Given.  Boxes along the axes, and the tree that finds which of them touch."""

from typing import NamedTuple

import numpy as np

from ..checks import BadInput, check_array, check_shape, finite_array

LEAF_SIZE = 8                # boxes in a leaf of a tree [-]: testing so few is faster than descending further


class Tree(NamedTuple):
    """A hierarchy of boxes around n items; node 0 is the root, which contains all items."""
    low: np.ndarray          # (m, d) corners of the box around each node [m]
    high: np.ndarray         # (m, d) [m]
    child: np.ndarray        # (m,) number of the first child, the second follows it; 0 marks a leaf
    first: np.ndarray        # (m,) the items of a node are order[first], …
    held: np.ndarray         # (m,) … this many
    order: np.ndarray        # (n,) numbers of the items
    item_low: np.ndarray     # (n, d) boxes of the items [m], sorted like `order`: those of one leaf are adjacent
    item_high: np.ndarray    # (n, d) [m]


def check_boxes(low, high):
    """Given.  Raise BadInput unless there is a box, and all are finite with low ≤ high; names the first such edge."""
    check_array("the lower corners of the boxes [m]", low, 2)
    check_array("the upper corners of the boxes [m]", high, 2)
    check_shape("the upper corners of the boxes", high, low.shape)
    for i in range(len(low)):
        for c in range(low.shape[1]):
            if low[i, c] > high[i, c]:
                raise BadInput("the edge of a box [m]", high[i, c] - low[i, c], "give low ≤ high in every coordinate")


def boxes_touch(low_a, high_a, i, low_b, high_b, j):
    """Given.  Return whether box i of one set and box j of another overlap or touch: they must in every coordinate."""
    for c in range(low_a.shape[1]):
        if low_a[i, c] > high_b[j, c] or low_b[j, c] > high_a[i, c]:
            return False
    return True


def as_pairs(found):
    """Given.  Return a list of pairs of numbers as an array (m, 2)."""
    pairs = np.zeros((len(found), 2), np.int64)
    for k in range(len(found)):
        pairs[k, 0], pairs[k, 1] = found[k]
    return pairs


def fit_node_box(tree, node):
    """Given.  Store the box around the items of a node; return the axis along which their middles spread most.

    For build_tree, while the items are still in the order of its input.
    """
    widest, axis = -1.0, 0
    for c in range(tree.item_low.shape[1]):
        low, high, first, last = np.inf, -np.inf, np.inf, -np.inf
        for k in range(tree.first[node], tree.first[node] + tree.held[node]):
            a, b = tree.item_low[tree.order[k], c], tree.item_high[tree.order[k], c]
            low, high = min(low, a), max(high, b)
            first, last = min(first, a + b), max(last, a + b)
        tree.low[node, c], tree.high[node, c] = low, high
        if last - first > widest:
            widest, axis = last - first, c
    return axis


def partition_at_median(tree, first, count, axis):
    """Given.  Reorder tree.order[first:first + count] in place: the half with the smaller middles along an axis first.

    For build_tree.
    *Source:* Hoare 1961, “Algorithm 65: find”: it takes time in proportion to count.
    """
    order = tree.order
    low, high, k = first, first + count - 1, first + count // 2
    while low < high:
        pivot = tree.item_low[order[(low + high) // 2], axis] + tree.item_high[order[(low + high) // 2], axis]
        i, j = low, high
        while i <= j:
            while tree.item_low[order[i], axis] + tree.item_high[order[i], axis] < pivot:
                i += 1
            while tree.item_low[order[j], axis] + tree.item_high[order[j], axis] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i, j = i + 1, j - 1
        low, high = (i if j < k else low), (j if k < i else high)


def build_tree(low, high):
    """Given.  Return the Tree of boxes low, high (n, d).

    Halve the items at the median along the axis of largest spread, until at most LEAF_SIZE are left.

    Each level of the tree takes time in proportion to n, and there are about log₂(n/LEAF_SIZE) levels.
    Raises what check_boxes raises.
    *Source:* median split; second lecture deck, “Bounding volume hierarchies”.
    """
    low = finite_array("corner of a box [m]", low)
    high = finite_array("corner of a box [m]", high)
    check_boxes(low, high)
    n, d = low.shape
    numbers = np.zeros((3, 2 * n), np.int64)
    corners = np.zeros((2, 2 * n, d))
    tree = Tree(corners[0], corners[1], numbers[0], numbers[1], numbers[2], np.arange(n), low, high)
    tree.held[0] = n
    node, nodes = 0, 1
    while node < nodes:
        axis, first, count = fit_node_box(tree, node), tree.first[node], tree.held[node]
        if count > LEAF_SIZE:
            half = count // 2
            partition_at_median(tree, first, count, axis)
            tree.child[node] = nodes
            tree.first[nodes], tree.held[nodes] = first, half
            tree.first[nodes + 1], tree.held[nodes + 1] = first + half, count - half
            nodes += 2
        node += 1
    return Tree(tree.low, tree.high, tree.child, tree.first, tree.held, tree.order, low[tree.order], high[tree.order])


def half_perimeter(tree, node):
    """Given.  Return the sum of the edges of a node's box [m], as a measure of its size."""
    total = 0.0
    for c in range(tree.low.shape[1]):
        total += tree.high[node, c] - tree.low[node, c]
    return total


def touching_items(a, i, b, j, found):
    """Given.  Append to `found` all pairs of an item of leaf i of a and one of leaf j of b whose boxes touch."""
    for k in range(a.first[i], a.first[i] + a.held[i]):
        for m in range(b.first[j], b.first[j] + b.held[j]):
            if boxes_touch(a.item_low, a.item_high, k, b.item_low, b.item_high, m):
                found.append((a.order[k], b.order[m]))
