"""A forecast as a matplotlib figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ddl_forecast._arrays import Floats, Integers

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# The colours of the player: forecasts are blue; orange is kept for what happened.
PAST, PATH, GOAL = "#222222", "#1d5fc2", "#123f84"


def draw(
    ax: Axes | None,
    past: Floats,
    unseen: Integers,
    paths: Floats,
    weights: Floats,
    goals: Floats | None,
    radii: Floats | None,
    level: float | None,
) -> Axes:
    """Draw the scene on these axes, or on new ones; `radii` (n, k) are of the region of `level` at the horizon.

    `unseen` (n,) positions at the start of `past` are dotted.
    """
    try:
        import matplotlib.pyplot as plt
        from matplotlib.collections import LineCollection
        from matplotlib.lines import Line2D
        from matplotlib.patches import Circle
    except ImportError:
        raise ImportError("plots need matplotlib: pip install matplotlib") from None
    if ax is None:
        _, ax = plt.subplots(figsize=(8, 5.5), layout="constrained")
    for i in range(len(paths)):
        now, weights_of = past[i, -1], weights[i]
        if radii is not None:
            for end, radius in zip(paths[i, :, -1], radii[i], strict=True):
                if not np.isnan(radius):
                    ax.add_patch(
                        Circle((float(end[0]), float(end[1])), float(radius), color=PATH, alpha=0.06, linewidth=0)
                    )
        lines = np.concatenate([np.broadcast_to(now, (len(weights_of), 1, 2)), paths[i]], axis=1)
        share = weights_of / weights_of.max()
        order = np.argsort(weights_of)
        ax.add_collection(
            LineCollection(
                [lines[k] for k in order],
                colors=[(*_rgb(PATH), 0.15 + 0.85 * float(share[k])) for k in order],
                linewidths=[0.6 + 2.0 * float(share[k]) for k in order],
                capstyle="round",
            )
        )
        if goals is not None:
            ax.scatter(
                goals[i, :, 0], goals[i, :, 1], 260 * weights_of, "none", edgecolors=GOAL, linewidths=0.9, zorder=3
            )
        seen, before = past[i, unseen[i] :], past[i, : unseen[i] + 1]
        ax.plot(seen[:, 0], seen[:, 1], color=PAST, linewidth=1.6, zorder=4)
        ax.plot(before[:, 0], before[:, 1], ":", color=PAST, linewidth=1.0, zorder=4)
        ax.plot(now[0], now[1], "o", color=PAST, markersize=5, zorder=5)
    legend = [
        Line2D([], [], color=PAST, marker="o", label="observed, 3.2 s"),
        Line2D([], [], color=PATH, linewidth=2, label="forecast, 4.8 s"),
    ]
    if unseen.any():
        legend.insert(1, Line2D([], [], color=PAST, linestyle=":", label="before the first observation"))
    if goals is not None and len(goals):
        ring = Line2D(
            [], [], color="none", marker="o", markerfacecolor="none", markeredgecolor=GOAL, label="goal, size by weight"
        )
        legend.append(ring)
    if level is not None:
        legend.append(
            Line2D(
                [],
                [],
                color=PATH,
                alpha=0.25,
                marker="o",
                markersize=10,
                linestyle="",
                label=f"{level:.0%} region at the horizon",
            )
        )
    ax.legend(handles=legend, loc="best", frameon=False, fontsize="small")
    ax.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    ax.margins(0.08)
    ax.autoscale_view()
    return ax


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5))
    return red, green, blue
