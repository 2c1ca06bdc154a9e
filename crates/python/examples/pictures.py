"""Make the pictures of docs/python.md: `python examples/pictures.py`, with matplotlib installed."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import segue

OUT = Path(__file__).resolve().parents[3] / "assets" / "readme"


def blend(axes):
    """Draw the heights of both feet over a blend, and when they are planted."""
    walk, run = segue.builtin("walk"), segue.builtin("run")
    made = segue.blend(walk, run, window=20)
    times = np.arange(made.frames) / made.fps
    places = made.global_positions()
    for side, colour in (("left", "tab:blue"), ("right", "tab:orange")):
        foot = made.names.index(made.roles[f"{side} foot"])
        axes.plot(times, 100 * places[:, foot, 1], colour, label=f"{side} ankle")
    planted = segue.contacts(made)
    for row, colour in enumerate(("tab:blue", "tab:orange")):
        axes.fill_between(times, -4 * row - 4, -4 * row - 1, planted[:, row], color=colour, lw=0)
    window = made.transition
    axes.axvspan(window["start_s"], window["end_s"], color="0.85")
    axes.set(xlabel="time (s)", ylabel="height (cm)", title="segue.blend(walk, run, window=20)")
    axes.legend(frameon=False, fontsize=8)


def distances(axes):
    """Draw the distances of a walk and a start, with the transitions of their graph."""
    clips = [segue.builtin(name) for name in ("walk", "start")]
    found = segue.distance_matrix(clips, window=20)
    picture = axes.imshow(found.cm, cmap="magma", vmax=30)
    graph = segue.graph(clips, window=20, threshold_cm=8, prune=False)
    jumps = graph.jumps
    axes.plot(
        found.starts[jumps[:, 2]] + jumps[:, 3], found.starts[jumps[:, 0]] + jumps[:, 1], "c.", ms=3
    )
    axes.figure.colorbar(picture, ax=axes, label="cm", fraction=0.046)
    axes.set(title="segue.distance_matrix and segue.graph", xlabel="frame", ylabel="frame")


def walk(axes):
    """Draw the way of a walk through a graph from above."""
    names = ("walk", "walk_left", "walk_right", "start", "stop", "idle")
    graph = segue.graph([segue.builtin(name) for name in names], threshold_cm=8)
    made = graph.walk(seconds=60, seed=7)
    places = made.global_positions()
    for column, (side, colour) in enumerate((("left", "tab:blue"), ("right", "tab:orange"))):
        foot = made.names.index(made.roles[f"{side} foot"])
        on_ground = places[segue.contacts(made)[:, column], foot]
        axes.plot(on_ground[:, 0], on_ground[:, 2], ".", color=colour, ms=2)
    axes.plot(made.root[:, 0], made.root[:, 2], "0.6", lw=0.8, zorder=0)
    axes.set(title="graph.walk(seconds=60, seed=7)", xlabel="x (m)", ylabel="z (m)", aspect="equal")


def main():
    """Draw all."""
    figure, axes = plt.subplots(1, 3, figsize=(14, 4.2), dpi=80, layout="constrained")
    for draw, own in zip((blend, distances, walk), axes):
        draw(own)
    path = OUT / "python.webp"
    figure.savefig(path, pil_kwargs={"quality": 80})
    print(f"{path}: {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
