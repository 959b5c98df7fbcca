"""A forecast as a figure of matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ddl_forecast._forecast import Forecast

PAST, PATH, GOAL = "#222222", "#d9601a", "#1a7f5a"


def draw(forecast: Forecast, ax: Axes | None, level: float | None) -> Axes:
    """The scene on these axes, or on new ones."""
    try:
        import matplotlib.pyplot as plt
        from matplotlib.collections import LineCollection
        from matplotlib.lines import Line2D
        from matplotlib.patches import Circle
    except ImportError:
        raise ImportError("plots need matplotlib: pip install matplotlib") from None
    if ax is None:
        _, ax = plt.subplots(figsize=(8, 5.5), layout="constrained")
    shown = np.flatnonzero(forecast.valid)
    radii = None if level is None else forecast.regions(level)[..., -1]
    for i in shown:
        now, weights, ends = forecast.past[i, -1], forecast.weights[i], forecast.paths[i, :, -1]
        if radii is not None:
            for end, radius in zip(ends, radii[i], strict=True):
                if not np.isnan(radius):
                    ax.add_patch(Circle((float(end[0]), float(end[1])), float(radius), color=PATH, alpha=0.06, linewidth=0))
        paths = np.concatenate([np.broadcast_to(now, (len(weights), 1, 2)), forecast.paths[i]], axis=1)
        share = weights / weights.max()
        order = np.argsort(weights)
        ax.add_collection(
            LineCollection(
                [paths[k] for k in order],
                colors=[(*_rgb(PATH), 0.15 + 0.85 * float(share[k])) for k in order],
                linewidths=[0.6 + 2.0 * float(share[k]) for k in order],
                capstyle="round",
            )
        )
        if forecast.goals is not None:
            ax.scatter(forecast.goals[i, :, 0], forecast.goals[i, :, 1], 260 * weights, "none", edgecolors=GOAL, linewidths=0.9, zorder=3)
        ax.plot(forecast.past[i, :, 0], forecast.past[i, :, 1], color=PAST, linewidth=1.6, zorder=4)
        ax.plot(now[0], now[1], "o", color=PAST, markersize=5, zorder=5)
    legend = [Line2D([], [], color=PAST, marker="o", label="observed, 3.2 s"), Line2D([], [], color=PATH, linewidth=2, label="forecast, 4.8 s")]
    if forecast.goals is not None and len(shown):
        ring = Line2D([], [], color="none", marker="o", markerfacecolor="none", markeredgecolor=GOAL, label="goal, as large as its weight")
        legend.append(ring)
    if level is not None:
        legend.append(Line2D([], [], color=PATH, alpha=0.25, marker="o", markersize=10, linestyle="", label=f"{level:.0%} region at the end"))
    ax.legend(handles=legend, loc="best", frameon=False, fontsize="small")
    ax.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    ax.margins(0.08)
    ax.autoscale_view()
    return ax


def _rgb(colour: str) -> tuple[float, float, float]:
    red, green, blue = (int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5))
    return red, green, blue
