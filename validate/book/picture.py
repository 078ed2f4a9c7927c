"""`python -m validate.book.picture [REPORT]`: draw the README's film of four scenes from the films of a report.

It writes docs/scenes.webp, which moves, and docs/scenes.png, one of its frames for readers who want less motion.
"""

import base64
from itertools import product
from pathlib import Path
from typing import Annotated

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import typer
from matplotlib.collections import LineCollection, PolyCollection
from PIL import Image

from ..check import Role
from ..run.command import start
from ..run.store import stored_report
from ..subject.modules import ROOT

SCENES = {                   # {scene: its title in the film}
    "spring_net": "springs: a net that is let go",
    "asymmetric_top": "rotation: a body turns over by itself",
    "dominoes": "contact and friction: dominoes",
    "rope": "constraints: a rope of ten links",
}
FILM, STILL = ROOT / "docs" / "scenes.webp", ROOT / "docs" / "scenes.png"
SIZE, DPI = (7.2, 4.4), 100  # of the film [in], [dots per inch]
PER_FRAME = 50               # [ms]
HOLD = 600                   # of the last frame [ms]
STILL_FRAME = 0.55           # share of the film after which the still is taken
LOOK = {Role.TRUTH: {"colour": "#8f8f8f", "width": 5.0, "style": "-", "alpha": 0.55},
        Role.OURS: {"colour": "#0072B2", "width": 1.8, "style": "-", "alpha": 1.0},
        Role.ENGINE: {"colour": "#D55E00", "width": 1.2, "style": (0, (3, 2)), "alpha": 1.0}}
KEY = {Role.TRUTH: "truth", Role.OURS: "the workbook", Role.ENGINE: "pymunk or pybullet"}
VIEW = np.array([[-0.45, -0.28], [0.95, -0.12], [0.0, 0.95]])       # of the plane on which space is drawn
TOWARDS = np.array([0.83, 0.5, 0.25])                               # from there to the reader
FACES = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]      # of a box


def rotated(q, r):
    """Return the vectors r (n, 3), rotated by the unit quaternion q = (x, y, z, w)."""
    return r + 2.0 * np.cross(q[:3], np.cross(q[:3], r) + q[3] * r)


def show_all(axes, low, high):
    """Choose the limits of axes so that they show these corners (2,), with a margin and one scale for both axes."""
    width, height = axes.get_position().size * SIZE
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    scale = 1.12 * max(half[0] / width, half[1] / height)
    axes.set(xlim=middle[0] + scale * np.array([-width, width]), ylim=middle[1] + scale * np.array([-height, height]))


class Flat:
    """A scene in the plane: points, and lines between them."""

    def __init__(self, axes, picture):
        self.links, self.parts = np.array(picture["links"], dtype=int), []
        self.runs = sorted(picture["films"], key=lambda run: list(LOOK).index(Role(run["role"])))
        self.frames = [np.array(run["frames"], dtype=float) for run in self.runs]
        every = np.concatenate([frames.reshape(-1, 2) for frames in self.frames])
        show_all(axes, every.min(axis=0), every.max(axis=0))
        for run in self.runs:
            look = LOOK[Role(run["role"])]
            lines = LineCollection([], colors=look["colour"], linewidths=look["width"], linestyles=[look["style"]],
                                   alpha=look["alpha"], capstyle="round")
            axes.add_collection(lines)
            self.parts.append(lines)

    def show(self, k):
        for part, frames in zip(self.parts, self.frames):
            part.set_segments(frames[k][self.links])


class Space:
    """A scene in space whose only body is a box."""

    def __init__(self, axes, picture):
        space, self.parts = picture["space"], []
        half = np.array(space["bodies"][0]["size"])
        self.corners = np.array(list(product((-1.0, 1.0), repeat=3))) * half
        self.runs = sorted(space["runs"], key=lambda run: list(LOOK).index(Role(run["look"])))
        length = 7 + 6 * len(space["arrows"])
        self.frames = [np.frombuffer(base64.b64decode(run["frames"]), dtype="<f4").reshape(-1, length).astype(float)
                       for run in self.runs]
        reach = 1.05 * np.linalg.norm(half)
        show_all(axes, np.array([-reach, -reach]), np.array([reach, reach]))
        for run in self.runs:
            role = Role(run["look"])
            look, ours = LOOK[role], role is Role.OURS
            faces = PolyCollection([], facecolors="none", edgecolors=look["colour"] if not ours else "#0b3a57",
                                   linewidths=look["width"] if not ours else 0.8, linestyles=[look["style"]],
                                   alpha=look["alpha"])
            axes.add_collection(faces)
            self.parts.append((faces, ours))

    def show(self, k):
        for (part, ours), frames in zip(self.parts, self.frames):
            corners = frames[k][:3] + rotated(frames[k][3:7], self.corners)
            normals = np.array([corners[list(face)].mean(axis=0) - frames[k][:3] for face in FACES])
            light = normals @ TOWARDS / np.linalg.norm(normals, axis=1)
            seen = [n for n in range(6) if light[n] > 0.0]
            part.set_verts([corners[list(FACES[n])] @ VIEW for n in seen])
            if ours:
                part.set_facecolor([mpl.colors.to_rgba("#0072B2", 0.35 + 0.6 * light[n]) for n in seen])


def film(scenes):
    """Draw all frames; a list of images."""
    plt.switch_backend("agg")
    figure, grid = plt.subplots(2, 2, figsize=SIZE, dpi=DPI)
    figure.subplots_adjust(left=0.02, right=0.98, top=0.94, bottom=0.09, wspace=0.05, hspace=0.16)
    panels = []
    for axes, (name, title) in zip(grid.flat, SCENES.items()):
        picture = scenes[name]["picture"]
        axes.set_title(title, fontsize=9.5, color="#1d2429")
        axes.set(xticks=[], yticks=[], facecolor="#f6f7f8")
        axes.spines[:].set_visible(False)
        panel = (Space if picture["space"] else Flat)(axes, picture)
        clock = axes.text(0.02, 0.03, "", transform=axes.transAxes, fontsize=8, color="#555555")
        panels.append((panel, clock, picture["seconds"]))
    lines = [plt.Line2D([], [], color=look["colour"], lw=look["width"], ls=look["style"], alpha=look["alpha"])
             for look in LOOK.values()]
    figure.legend(lines, [KEY[role] for role in LOOK], loc="lower center", ncols=3, fontsize=9, frameon=False)
    last = min(len(panel.frames[0]) for panel, _, _ in panels) - 1
    images = []
    for k in range(last + 1):
        for panel, clock, seconds in panels:
            panel.show(k)
            clock.set_text(f"t = {seconds * k / last:.2f} s")
        figure.canvas.draw()
        images.append(Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()))
    plt.close(figure)
    return images


def main(report: Annotated[Path, typer.Argument(help="Folder of a report.")] = Path("report")):
    """Draw the film and the picture of the README from the films of a report."""
    scenes = {scene["scene"]: scene for scene in stored_report(report)["scenes"]}
    images = film(scenes)
    durations = [PER_FRAME] * (len(images) - 1) + [HOLD]
    images[0].save(FILM, save_all=True, append_images=images[1:], duration=durations, loop=0, quality=60, method=6)
    images[round(STILL_FRAME * (len(images) - 1))].save(STILL, optimize=True)
    print(f"{FILM.relative_to(ROOT)}: {FILM.stat().st_size / 1e6:.2f} MB, {len(images)} frames")


if __name__ == "__main__":
    start("python -m validate.book.picture", main)
