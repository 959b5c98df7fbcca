// Draws the chosen future of everybody: paths, lines between those who walk together, and conflicts.

function futurePlace(moment, at, state) {
  const { observed, hypotheses } = moment.pedestrians[at];
  return placeAt(observed, hypotheses[state.hypothesis].path, state.time);
}

// A pedestrian who is not the selected one, on its path in the chosen future.
function drawInFuture(context, view, pedestrian, state, palette) {
  const { time, show } = state;
  const now = OBSERVED - 1;
  const { observed, truth } = pedestrian;
  const { path } = pedestrian.hypotheses[state.hypothesis];
  const toPixels = (places) => places.map(view.px);
  stroke(context, toPixels(trail(observed, truth, 0, Math.min(time, now))), palette.other, 1.4, 0.8);
  if (show.everything) drawHypotheses(context, view, pedestrian, state, palette, 0.45, state.hypothesis);
  if (show.truth) {
    const known = knownUntil(pedestrian);
    stroke(context, toPixels(trail(observed, truth, now, known)), palette.truth, 1.2, 0.35);
    stroke(context, toPixels(trail(observed, truth, now, Math.min(time, known))), palette.truth, 1.6, 0.8);
  }
  const early = time < now ? 0.5 : 1;
  stroke(context, toPixels([observed[now], ...path]), palette.accent, 1.8, 0.75 * early, [6, 4]);
  if (time > now) stroke(context, toPixels(trail(observed, path, now, time)), palette.accent, 2.4);
  star(context, view.px(path[HORIZON - 1]), 5.5, palette.accent, early, palette.panel);
}

function drawGroups(context, view, moment, state, palette) {
  context.lineCap = "round";
  for (const pair of state.links) {
    const ends = pair.map((at) => view.px(futurePlace(moment, at, state)));
    stroke(context, ends, palette.third, 5, 0.75);
  }
  context.lineCap = "butt";
}

// The dots of the others, above the lines between them.
function drawPlaces(context, view, moment, state, palette) {
  const colour = state.time > OBSERVED - 1 ? palette.accent : palette.other;
  moment.pedestrians.forEach((_, at) => {
    if (at !== state.pedestrian) dot(context, view.px(futurePlace(moment, at, state)), 4.2, colour, 1, palette.panel);
  });
}

// A ring where two come closest, bold and between the two while they are too close.
function drawConflicts(context, view, moment, state, palette) {
  for (const { pair, since, until, nearest } of state.conflicts) {
    if (!state.show.others && !pair.includes(state.pedestrian)) continue;
    const active = since <= state.time && state.time <= until;
    const at = { ...state, time: active ? state.time : nearest };
    const [a, b] = pair.map((who) => futurePlace(moment, who, at));
    const middle = view.px([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]);
    const radius = Math.max(CONFLICT * view.scale, 9);
    ring(context, middle, radius, palette["warn-rule"], active ? 3 : 1.6, active ? 1 : 0.8);
  }
}
