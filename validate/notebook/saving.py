"""Films in the plane as files: a page that any browser plays, or a GIF."""

import json
import uuid
from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter

from solutions.checks import BadInput

from ..report import plots

SIGNS = {"o": "●", "s": "■", "^": "▲", "v": "▼", "D": "◆", "d": "♦", "P": "✚", "<": "◀", ">": "▶", "h": "⬢"}
FRAMES_PER_SECOND = 25       # of a GIF: viewers round longer times between pictures to 1/100 s
# JupyterLab reads single letters as commands while a film has the focus: M makes the cell text, and X cuts it.
# It still gets Escape, Shift+Enter, and keys with Ctrl, Alt or Meta.
KEEP_KEYS = ("if (!event.ctrlKey && !event.altKey && !event.metaKey && event.key !== 'Escape'"
             " && !(event.shiftKey && event.key === 'Enter')) event.stopPropagation()")


def keeping_keys(html):
    """Return the HTML of a film in an element that keeps the film's keys from the page around it."""
    return f'<div class="film" onkeydown="{escape(KEEP_KEYS)}">{html}</div>'


def film_html(picture, height=260):
    """Return the HTML of a film, its player included."""
    name = f"p{uuid.uuid4().hex}"
    runs = picture["films"]
    alone = runs if len(runs) == 1 else []                           # the player's bar names several
    key = " &nbsp; ".join(f'<span style="color:{run["colour"]}">{SIGNS.get(run.get("marker"), "●")}</span> '
                          f'{escape(run["label"])}' for run in alone)
    script = (Path(plots.__file__).parent / "player.js").read_text()
    style = f"width:100%;max-width:46rem;height:{height}px;background:#f6f7f8"
    return (keeping_keys(f'<canvas data-picture="{name}" style="{style}"></canvas><div>{key}</div>')
            + f'<script type="application/json" id="{name}">{json.dumps(picture)}</script>'
            f'<script>{script}</script>')


def save(picture, file):
    """Write a film to a file that ends with .html or .gif.  Raises BadInput for another ending."""
    if file.suffix == ".html":
        file.write_text(f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(file.stem)}</title>'
                        f"<body>{film_html(picture, 400)}</body></html>", encoding="utf-8")
    elif file.suffix == ".gif":
        _save_gif(picture, file)
    else:
        raise BadInput("the file of a film", file.name, "give a name that ends with .html or .gif")


def _save_gif(picture, file):
    """Draw every frame with matplotlib; the film lasts as long as it should, and then begins again."""
    films = [(run, np.array(run["frames"], dtype=float)) for run in picture["films"]]
    low = np.min([np.min(frames, axis=(0, 1)) for _, frames in films], axis=0)
    high = np.max([np.max(frames, axis=(0, 1)) for _, frames in films], axis=0)
    edge = 0.05 * np.max(high - low) + 1e-3
    fig, ax = plt.subplots(figsize=(6.4, 3.6))
    ax.set(aspect="equal", xlim=(low[0] - edge, high[0] + edge), ylim=(low[1] - edge, high[1] + edge),
           xlabel="x [m]", ylabel="y [m]")
    drawn = []
    for run, _ in films:
        drawn.append([ax.plot([], [], color=run["colour"], lw=1.5)[0] for _ in picture["links"]]
                     or [ax.plot([], [], run.get("marker", "o"), color=run["colour"], ms=4)[0]])
    count = max(2, round(picture["seconds"] * FRAMES_PER_SECOND))

    def show(k):
        for (_, frames), lines in zip(films, drawn):
            points = frames[round(k * (len(frames) - 1) / (count - 1))]
            for line, pair in zip(lines, picture["links"] or [list(range(len(points)))]):
                line.set_data(points[list(pair), 0], points[list(pair), 1])
    FuncAnimation(fig, show, frames=count, blit=False).save(file, writer=PillowWriter(fps=FRAMES_PER_SECOND))
    plt.close(fig)
