"""How large the type of a figure is where a reader sees it.  It is measured on the drawn figure."""

from matplotlib import pyplot as plt
from matplotlib.text import Text

PAGE = 1000                  # width that a page has for a figure: JupyterLab with its sidebar, 1,280 px wide [px]
DOTS = 100                   # of a figure in a notebook, per inch, where the page is wide enough [px]
POINT = 96 / 72              # [px]
LEAST = 9.0                  # size of type that can be read beside the text of a notebook [points]


def smallest_type(figure, dots=DOTS):
    """Return [size in points, text] of the smallest type in a drawn figure, as a page shows it.

    The picture is cropped to what is drawn, so a legend beside the plots makes it wider, and its type smaller.
    An index or an exponent has seven tenths of the size of its text; it is not looked at.
    """
    wide = figure.get_tightbbox().width + 2.0 * plt.rcParams["savefig.pad_inches"]
    shown = min(dots, PAGE / wide) / 72.0 / POINT                        # points on the page per point of the figure
    sizes = [[shown * text.get_fontsize(), text.get_text()] for text in figure.findobj(Text) if is_seen(text)]
    return min(sizes, default=[LEAST, ""])


def is_seen(text):
    return bool(text.get_text().strip()) and text.get_visible() and (text.axes is None or text.axes.get_visible())


def install():
    """Let each figure that this kernel shows carry the size of its smallest type, beside its description."""
    from validate.notebook import figures
    made = figures._Described.made

    def measured(self, figure):
        picture = made(self, figure)
        return picture and (picture[0], {**picture[1], "type": smallest_type(figure)})
    figures._Described.made = measured
