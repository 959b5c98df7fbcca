// Metres to pixels: equal on both axes, y up.

const LEAST_SPAN = 4;

function boundsOf(places) {
  const low = [Infinity, Infinity];
  const high = [-Infinity, -Infinity];
  for (const place of places) {
    for (const axis of [0, 1]) {
      low[axis] = Math.min(low[axis], place[axis]);
      high[axis] = Math.max(high[axis], place[axis]);
    }
  }
  return { low, high };
}

// All positions of a pedestrian: past, true future, forecast, goals.
function* placesOf(pedestrian, allHypotheses) {
  yield* pedestrian.observed;
  yield* pedestrian.truth;
  for (const hypothesis of pedestrian.hypotheses) {
    if (allHypotheses || hypothesis.index === pedestrian.representative) {
      yield* hypothesis.path;
      if (hypothesis.goal) yield hypothesis.goal;
    }
  }
}

// The view that shows these positions and `room` times their extent, in a canvas of this size.
function viewOf(places, width, height, room) {
  const { low, high } = boundsOf(places);
  const margin = Math.min(34, 0.09 * Math.min(width, height));
  const fit = (axis, pixels) => (pixels - 2 * margin) / Math.max(room * (high[axis] - low[axis]), LEAST_SPAN);
  // Space for the stamp above and the scale below.
  const scale = Math.min(fit(0, width), fit(1, height - 40));
  const centre = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
  return {
    scale,
    px: ([x, y]) => [width / 2 + scale * (x - centre[0]), height / 2 - scale * (y - centre[1])],
    metres: ([x, y]) => [centre[0] + (x - width / 2) / scale, centre[1] - (y - height / 2) / scale],
  };
}
