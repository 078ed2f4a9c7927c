"""What a figure shows, in words, for readers who cannot see it.  Runs in the kernel that executes a notebook."""

from functools import partial

from matplotlib.figure import Figure

MOST_CURVES = 8              # that one description names


def describe(figure):
    """Return one sentence per plot of a figure: its quantities, its title and its curves."""
    sentences = [" ".join(sentence.split()) for axes in figure.axes if (sentence := _sentence(axes))]
    return " ".join(sentences) or "Drawing without axes."


def _sentence(axes):
    x, y = axes.get_xlabel(), axes.get_ylabel()
    parts = [axes.get_title() or axes.get_title("left"), f"{y} against {x}" if x and y else x or y]
    curves = [label for label in axes.get_legend_handles_labels()[1] if label]
    if curves:
        parts.append("curves: " + ", ".join(curves[:MOST_CURVES]) + (" and others" if curves[MOST_CURVES:] else ""))
    return "; ".join(filter(None, parts)) and "Plot: " + "; ".join(filter(None, parts)) + "."


def install(shell):
    """Let every figure that this kernel shows carry its description as metadata."""
    formatter = shell.display_formatter.formatters["image/png"]
    formatter.for_type(Figure, partial(_described, formatter.lookup_by_type(Figure)))


def _described(draw, figure):
    png = draw(figure)
    return (png, {"alt": describe(figure)}) if isinstance(png, (str, bytes)) else png
