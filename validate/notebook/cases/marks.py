"""Marks in a plane or in space, and views of them: the parts of the pictures of failing checks.

A mark is data.  A view projects it at right angles onto two unit vectors.  What is given is filled and solid, the
answer is dashed with crosses, and what the test expects has wide lines and rings: colours are not needed to tell them
apart.
"""

import contextlib
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon
from scipy.spatial import ConvexHull, QhullError

GIVEN = (("#0072B2", "s"), ("#8C6D31", "^"), ("#6A51A3", "D"), ("#5A5A5A", "v"))
ANSWER, EXPECTED = ("#D55E00", "X"), ("#009E73", "o")
FARTHEST = 3.0               # an answer is shown up to this many spans of the rest beyond it [-]
BEYOND = 100.0               # what is farther away, in widths of the picture, is drawn at this distance [-]


class View(NamedTuple):
    """Where one looks from."""
    title: str
    basis: np.ndarray        # (2, d) unit vectors to the right and up
    origin: np.ndarray       # (d,) this point is (0, 0)
    labels: tuple            # of both axes, with units

    def of(self, points):
        """Return points (n, d) as they are seen (n, 2)."""
        return (np.atleast_2d(np.asarray(points, dtype=float)) - self.origin) @ self.basis.T

    def depth(self, points):
        """Return distances (n,) of points from the plane of the view through its origin."""
        offset = np.atleast_2d(np.asarray(points, dtype=float)) - self.origin
        return np.linalg.norm(offset - offset @ self.basis.T @ self.basis, axis=1)


class Nearby(NamedTuple):
    """A view in which a point that is far beyond the picture stands nearer, in the same direction from its middle.

    A line is drawn dash by dash, also outside the picture.  So a line to a point 1e18 widths away would never end.
    """
    view: View
    middle: np.ndarray       # (2,) of the picture
    reach: float             # no point stands farther from there

    @property
    def basis(self):
        return self.view.basis

    def of(self, points):
        """Return points (n, d) as they are drawn (n, 2)."""
        way = self.view.of(points) - self.middle
        return self.middle + way / np.maximum(1.0, np.linalg.norm(way, axis=1) / self.reach)[:, None]


class Look(NamedTuple):
    """How the marks of one role are drawn."""
    colour: str
    marker: str
    line: str = "-"
    width: float = 1.6
    size: float = 6.0
    hollow: bool = False
    fill: float = 0.0        # opacity of what is inside
    layer: int = 2


ANSWER_LOOK = Look(*ANSWER, line="--", width=1.7, size=8.0, layer=4)
EXPECTED_LOOK = Look(*EXPECTED, width=3.2, size=13.0, hollow=True, layer=3)


def given_look(number):
    return Look(*GIVEN[number % len(GIVEN)], fill=0.13)


class Dots(NamedTuple):
    """Single points (n, d)."""
    points: np.ndarray
    label: str

    def extent(self, view):
        return view.of(self.points)

    def draw(self, axes, view, look):
        layer = 5 if look.fill else look.layer                       # small points that are given are never covered
        axes.plot(*view.of(self.points).T, ls="", **_marker(look), zorder=layer)
        return {"ls": "", **_marker(look)}


class Way(NamedTuple):
    """Points (n, d) joined by lines; closed: the last with the first, too."""
    points: np.ndarray
    label: str
    closed: bool = False
    dots: bool = True

    def extent(self, view):
        return view.of(self.points)

    def draw(self, axes, view, look):
        seen = view.of(self.points)
        style = {"ls": look.line, "lw": look.width, **(_marker(look) if self.dots else {"color": look.colour})}
        if self.closed and len(seen) > 2 and look.fill:
            axes.add_patch(Polygon(seen, color=look.colour, alpha=look.fill, lw=0.0))
        axes.plot(*(np.vstack((seen, seen[:1])) if self.closed else seen).T, **style, zorder=look.layer)
        return style


class Links(NamedTuple):
    """Lines between pairs of points (n, 2, d)."""
    pairs: np.ndarray
    label: str

    def extent(self, view):
        return view.of(np.reshape(self.pairs, (-1, self.pairs.shape[-1]))) if len(self.pairs) else np.zeros((0, 2))

    def draw(self, axes, view, look):
        style = {"ls": look.line, "lw": look.width, "color": look.colour}
        for pair in self.pairs:
            axes.plot(*view.of(pair).T, **style, zorder=look.layer)
        return style


class Disc(NamedTuple):
    """A ball, or in the plane a disc; a circle from wherever one looks."""
    centre: np.ndarray
    r: float
    label: str

    def extent(self, view):
        return view.of(self.centre) + self.r * np.array([(-1.0, -1.0), (1.0, 1.0)])

    def draw(self, axes, view, look):
        centre, r = view.of(self.centre)[0], min(self.r, view.reach)
        axes.add_patch(Circle(centre, r, fill=bool(look.fill), fc=(look.colour, look.fill), ec=look.colour,
                              ls=look.line, lw=look.width, zorder=look.layer))
        style = {"color": look.colour, "marker": "."} if look.fill else _marker(look)
        axes.plot(*centre, **style, zorder=look.layer)
        return {"ls": look.line, "lw": look.width, **style}


class Hull(NamedTuple):
    """The outline of the hull of points (n, d): of a box, or of any convex body."""
    points: np.ndarray
    label: str

    def extent(self, view):
        return view.of(self.points)

    def draw(self, axes, view, look):
        seen = view.of(self.points)
        with contextlib.suppress(QhullError):                        # seen edge-on, or fewer than three points
            seen = seen[ConvexHull(seen).vertices]
        return Way(seen, "", True, len(self.points) < 3).draw(axes, _FLAT, look)


class Arrow(NamedTuple):
    """From a point (d,) along a vector (d,)."""
    start: np.ndarray
    vector: np.ndarray
    label: str

    def extent(self, view):
        return view.of([self.start, np.add(self.start, self.vector)])

    def draw(self, axes, view, look):
        a, b = self.extent(view)
        axes.add_patch(FancyArrowPatch(a, b, arrowstyle="-|>", mutation_scale=8.0 + 2.0 * look.width, shrinkA=0.0,
                                       shrinkB=0.0, color=look.colour, ls=look.line, lw=look.width, zorder=look.layer))
        return {"ls": look.line, "lw": look.width, "color": look.colour, "marker": ">", "markevery": (1, 2)}


class Level(NamedTuple):
    """All points with n · x = offset, where n lies in the plane of the view.

    The part that is beside a given point is in the picture.
    """
    n: np.ndarray
    offset: float
    beside: np.ndarray
    label: str

    def extent(self, view):
        foot = self.beside + (self.offset - self.beside @ self.n) / (self.n @ self.n) * self.n
        return view.of(foot)

    def draw(self, axes, view, look):
        (at,), n = self.extent(view), view.basis @ self.n
        style = {"ls": look.line, "lw": look.width, "color": look.colour}
        axes.axline(at, at + np.array([-n[1], n[0]]), **style, zorder=look.layer)
        return style


class Note(NamedTuple):
    """Words in the legend, without a mark."""
    label: str

    def extent(self, view):
        return np.zeros((0, 2))

    def draw(self, axes, view, look):
        return {"ls": "", **_marker(look)}


_FLAT = View("", np.eye(2), np.zeros(2), ("", ""))


def _marker(look):
    return {"color": look.colour, "marker": look.marker, "ms": look.size,
            "mfc": "none" if look.hollow else look.colour, "mew": 2.0 if look.hollow else 0.6}


# ---------------------------------------------------------------------------------------------- the picture

def is_finite(mark):
    return all(np.all(np.isfinite(part)) for part in mark if isinstance(part, (float, np.ndarray, list, tuple)))


def picture(views, given, answer, expected):
    """Return (figure, whether all of the answer is in it) of lists of marks in their roles."""
    figure = Figure(figsize=(4.3 * len(views) + 0.6, 4.3), layout="constrained")
    legend, inside = {}, True
    labels = list(dict.fromkeys(mark.label for mark in given))
    looks = [(mark, given_look(labels.index(mark.label))) for mark in given]
    looks += [(mark, EXPECTED_LOOK) for mark in expected] + [(mark, ANSWER_LOOK) for mark in answer]
    for view, axes in zip(views, figure.subplots(1, len(views), squeeze=False)[0]):
        inside = _fit(axes, view, given + expected, answer) and inside
        nearby = _nearby(axes, view)
        for mark, look in looks:
            legend.setdefault(mark.label, mark.draw(axes, nearby, look))
        axes.set(aspect="equal", xlabel=view.labels[0], ylabel=view.labels[1], title=view.title)
        axes.title.set_fontsize(10)
        axes.locator_params(nbins=5)
    handles = [Line2D([0, 1], [0, 0], **{**style, "ms": min(9.0, style.get("ms", 6.0))}, label=label)
               for label, style in legend.items() if label]
    figure.legend(handles=handles, loc="outside lower center", ncols=1 if len(views) == 1 else 2, fontsize=9,
                  frameon=False)
    return figure, inside


def _nearby(axes, view):
    """Return the Nearby of a view, for axes whose limits are set."""
    low, high = np.transpose((axes.get_xlim(), axes.get_ylim()))
    return Nearby(view, 0.5 * (low + high), BEYOND * np.max(high - low))


def _fit(axes, view, known, answer):
    """Set the limits around all that is known, and around the answer unless it is too far away; whether it is not."""
    seen = [mark.extent(view) for mark in known]
    seen = np.concatenate([points for points in seen if len(points)] or [np.zeros((1, 2))])
    more = [mark.extent(view) for mark in answer]
    more = np.concatenate([seen, *(points for points in more if len(points))])
    low, high = seen.min(axis=0), seen.max(axis=0)
    span = max((high - low).max(), 1e-300) if len(seen) > 1 else max(np.ptp(more, axis=0).max(), 1e-300)
    least = np.maximum(more.min(axis=0), low - FARTHEST * span)
    most = np.minimum(more.max(axis=0), high + FARTHEST * span)
    width = max((most - least).max(), 1e-300)
    if width <= 1e-12 * np.abs(np.concatenate((least, most))).max():     # all in one point
        width = 1.0 + np.abs(least).max()
    middle, half = 0.5 * (least + most), 0.5 * np.maximum(most - least, 0.35 * width) + 0.08 * width
    axes.set(xlim=(middle[0] - half[0], middle[0] + half[0]), ylim=(middle[1] - half[1], middle[1] + half[1]))
    return bool(np.all(more >= least) and np.all(more <= most))
