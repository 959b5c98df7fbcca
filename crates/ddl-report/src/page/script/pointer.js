// What a pointer points at.

// The index of the pedestrian whose path, past and forecast, is nearest a pixel; undefined if all are far away.
function nearestPedestrian(at, view, moment, state) {
  let best = null;
  moment.pedestrians.forEach((who, index) => {
    const ahead = shownAhead(who, state);
    const here = view.px(placeAt(who.observed, ahead, state.time));
    const others = [...who.observed, ...ahead].map(view.px);
    const reach = Math.min(Math.hypot(here[0] - at[0], here[1] - at[1]) - 8, ...others.map((p) => Math.hypot(p[0] - at[0], p[1] - at[1])));
    if (reach < 22 && (!best || reach < best.reach)) best = { index, reach };
  });
  return best?.index;
}
