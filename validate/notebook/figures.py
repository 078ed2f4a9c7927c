"""Descriptions of figures in words, for readers who cannot see them: every figure of a notebook has one.

JupyterLab shows a PNG without a description, even if its metadata has one; of HTML it keeps the description.  So
a figure is sent as HTML with the PNG in it, and as the PNG, whose metadata the book reads.
"""

import re
from html import escape
from weakref import WeakKeyDictionary

import numpy as np
from matplotlib.container import BarContainer
from matplotlib.figure import Figure

MOST_CURVES, MOST_WORDS = 8, 12                 # that the description of one plot names
LETTERS = {"alpha": "α", "beta": "β", "lambda": "λ", "mu": "μ", "omega": "ω", "Omega": "Ω", "sigma": "σ", "theta": "θ",
           "cdot": "·", "Delta": "Δ"}           # of formulas, as text
NOTHING = "A drawing without words."


# ---------------------------------------------------------------------------------------------- a figure in words

def describe(figure):
    """Return a sentence for each plot of a figure: its title, its quantities and its curves."""
    title = [f"{plain(figure.get_suptitle())}."] if figure.get_suptitle() else []
    sentences = [sentence for axes in figure.axes if axes.get_visible() and (sentence := _sentence(axes))]
    return " ".join([*title, *sentences]) or NOTHING


def plain(text):
    """Return a label without line breaks, its formulas as text."""
    text = re.sub(r"\\([A-Za-z]+)", lambda found: LETTERS.get(found[1], found[1]), text) if "$" in text else text
    return " ".join(re.sub(r"[${}]", "", text).split()) if "$" in text else " ".join(text.split())


def _sentence(axes):
    if axes.get_label() == "<colorbar>":
        scale = plain(axes.get_ylabel() or axes.get_xlabel())
        return f"Colours: {scale}." if scale else ""
    parts = [plain(axes.get_title() or axes.get_title("left")), _quantities(axes), _bars(axes) or _curves(axes)]
    if not parts[2]:
        parts += [_words("at", _categories(axes)), _words("words", [plain(one.get_text()) for one in axes.texts])]
    shown = "; ".join(filter(None, parts))
    return shown and f"Plot: {shown}."


def _quantities(axes):
    """Return the quantities of a plot's axes.

    A plot without a label of its own has that of the plot whose axis it shares.
    """
    x, y = (_label(axes, name) for name in "xy")
    logarithmic = " and ".join(name for name in "xy" if getattr(axes, f"get_{name}scale")() == "log")
    said = f"{y} against {x}" if x and y else x or y
    return f"{said}, logarithmic in {logarithmic}" if said and logarithmic else said


def _label(axes, name):
    shared = getattr(axes, f"get_shared_{name}_axes")().get_siblings(axes)
    return next(filter(None, (plain(getattr(one, f"get_{name}label")()) for one in [axes, *shared])), "")


def _curves(axes):
    handles, labels = axes.get_legend_handles_labels()
    named = [f"“{plain(label)}”{_ends(axes, handle)}" for handle, label in zip(handles, labels) if plain(label)]
    title = plain(axes.get_legend().get_title().get_text()) if axes.get_legend() else ""
    return _words(f"curves ({title})" if title else "curves", list(dict.fromkeys(named)), MOST_CURVES)


def _bars(axes):
    """Return the lengths of the bars, and what each stands for; nothing where there are none."""
    bars = [one for one in axes.containers if isinstance(one, BarContainer)]
    sizes = [[b.get_height() if one.orientation == "vertical" else b.get_width() for b in one] for one in bars]
    names = [f"“{plain(one.get_label())}” " if not one.get_label().startswith("_") else "" for one in bars]
    listed = [f"{name}{', '.join(f'{x:.3g}' for x in found[:MOST_WORDS])}" for name, found in zip(names, sizes)]
    return f"{_words('bars at', _categories(axes)) or 'bars'}; lengths: {'; '.join(listed)}" if bars else ""


def _ends(axes, handle):
    """Return the first and last values of a curve if it is a function of x, and not a drawing in the plane."""
    if axes.get_aspect() == "equal" or not hasattr(handle, "get_xdata"):
        return ""
    try:
        x, y = (np.asarray(values, dtype=float) for values in (handle.get_xdata(), handle.get_ydata()))
    except (TypeError, ValueError):
        return ""
    known = np.isfinite(x) & np.isfinite(y) if x.shape == y.shape else np.zeros(0, dtype=bool)
    x, y = (x[known], y[known]) if known.any() else (np.zeros(0), np.zeros(0))
    if len(x) < 3 or not (np.all(np.diff(x) > 0.0) or np.all(np.diff(x) < 0.0)):
        return ""
    first, last = (0, -1) if x[0] < x[-1] else (-1, 0)
    return f" from {y[first]:.3g} at {x[first]:.3g} to {y[last]:.3g} at {x[last]:.3g}"


def _categories(axes):
    """Return names that stand at an axis in place of numbers."""
    ticks = [plain(tick.get_text()) for tick in [*axes.get_xticklabels(), *axes.get_yticklabels()]]
    return [tick for tick in ticks if re.search(r"[^\W\d_]", tick)]


def _words(what, words, most=MOST_WORDS):
    words = [word for word in words if word]
    return f"{what}: {', '.join(words[:most])}{' and others' if words[most:] else ''}" if words else ""


# ---------------------------------------------------------------------------------------------- shown with its words

class _Described:
    """Draws a figure as a picture with its description.  The two forms of one display share the drawing."""

    def __init__(self, draw):
        self.draw, self.kept = draw, WeakKeyDictionary()

    def made(self, figure):
        drawn = self.draw(figure)
        png, metadata = drawn if isinstance(drawn, tuple) else (drawn, {})
        return png and (png, {**metadata, "alt": describe(figure)})

    def __call__(self, figure):
        return self.kept.pop(figure, None) or self.made(figure)


def install(shell):
    """Let every figure that this kernel shows carry its description."""
    pictures = shell.display_formatter.formatters["image/png"]

    def as_html(figure):
        try:
            draw = pictures.lookup_by_type(Figure)
        except KeyError:                         # this kernel draws no PNG
            return {}
        if not isinstance(draw, _Described):     # IPython sets it anew when one of its options for figures changes
            draw = _Described(draw)
            pictures.for_type(Figure, draw)
        picture = draw.made(figure)
        if not picture:
            return {}
        draw.kept[figure] = picture
        png, metadata = picture
        size = "".join(f' {name}="{metadata[name]}"' for name in ("width", "height") if name in metadata)
        return {"text/html": f'<img alt="{escape(metadata["alt"])}"{size} src="data:image/png;base64,{png}">'}

    # the formatters of single types forget what is known of figures when an option changes; this one does not
    shell.display_formatter.mimebundle_formatter.for_type(Figure, as_html)
