// Draws a moment onto a canvas.

const ARROW_SECONDS = 0.8;

function stroke(context, points, colour, width, alpha = 1, dash = []) {
  if (points.length < 2) return;
  context.globalAlpha = alpha;
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.beginPath();
  points.forEach(([x, y], at) => (at === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.stroke();
}

function dot(context, [x, y], radius, colour, alpha = 1, rim = null) {
  context.globalAlpha = alpha;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  if (rim) {
    context.strokeStyle = rim;
    context.lineWidth = 2;
    context.setLineDash([]);
    context.stroke();
  }
  context.fillStyle = colour;
  context.fill();
}

function ring(context, [x, y], radius, colour, width, alpha, fill) {
  context.globalAlpha = alpha;
  context.setLineDash([]);
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  if (fill) {
    context.fillStyle = fill;
    context.fill();
  }
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
}

function star(context, [x, y], radius, colour, alpha, rim) {
  context.globalAlpha = alpha;
  context.setLineDash([]);
  context.beginPath();
  for (let corner = 0; corner < 10; corner += 1) {
    const reach = corner % 2 ? 0.42 * radius : radius;
    const angle = (corner * Math.PI) / 5;
    context.lineTo(x + reach * Math.sin(angle), y - reach * Math.cos(angle));
  }
  context.closePath();
  context.fillStyle = colour;
  context.fill();
  if (rim) {
    context.strokeStyle = rim;
    context.lineWidth = 1;
    context.stroke();
  }
}

// The displacement in 0.8 s: its length is proportional to the speed.
function arrow(context, view, place, velocity, colour, width) {
  const from = view.px(place);
  const to = view.px([place[0] + ARROW_SECONDS * velocity[0], place[1] + ARROW_SECONDS * velocity[1]]);
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (length < 4) return;
  const head = Math.min(7, Math.max(3, 0.35 * length));
  const [ux, uy] = [dx / length, dy / length];
  const side = (sign) => [to[0] - head * ux - sign * 0.6 * head * uy, to[1] - head * uy + sign * 0.6 * head * ux];
  stroke(context, [from, to], colour, width);
  stroke(context, [side(1), to, side(-1)], colour, width);
}

function words(context, text, [x, y], palette, { weight = 400, align = "left", colour = palette["ink-2"], size = 11 } = {}) {
  context.globalAlpha = 1;
  context.font = `${weight} ${size}px ${palette.font}`;
  context.textAlign = align;
  context.textBaseline = "middle";
  context.setLineDash([]);
  context.lineJoin = "round";
  context.lineWidth = 3;
  context.strokeStyle = palette.panel;
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}

function grid(context, view, width, height, palette) {
  const metres = [0.5, 1, 2, 5, 10, 20, 50, 100].find((m) => m * view.scale >= 36) ?? 200;
  const [left, top] = view.metres([0, 0]);
  const [right, bottom] = view.metres([width, height]);
  for (let x = Math.ceil(left / metres) * metres; x <= right; x += metres) {
    const at = Math.round(view.px([x, 0])[0]) + 0.5;
    stroke(context, [[at, 0], [at, height]], palette["rule-soft"], 1);
  }
  for (let y = Math.ceil(bottom / metres) * metres; y <= top; y += metres) {
    const at = Math.round(view.px([0, y])[1]) + 0.5;
    stroke(context, [[0, at], [width, at]], palette["rule-soft"], 1);
  }
  const length = metres * view.scale;
  const y = height - 14.5;
  stroke(context, [[14.5, y - 4], [14.5, y], [14.5 + length, y], [14.5 + length, y - 4]], palette["ink-2"], 1.5);
  words(context, `${metres} m`, [22 + length, y - 1], palette);
}

// The positions of whole frames up to a time, and the position at the time itself.
function trail(observed, ahead, from, time) {
  const places = [];
  for (let frame = from; frame < time; frame += 1) places.push(placeAt(observed, ahead, frame));
  if (time >= from) places.push(placeAt(observed, ahead, time));
  return places;
}

// The path of a pedestrian: the true one as far as it was observed, then the forecast; of joint futures the chosen one.
function shownAhead(pedestrian, { joint, hypothesis, show, time }) {
  if (joint) return pedestrian.hypotheses[hypothesis].path;
  return show.truth && time <= knownUntil(pedestrian) ? pedestrian.truth : pedestrian.hypotheses[pedestrian.representative].path;
}

function drawOther(context, view, pedestrian, state, palette) {
  const { time, show } = state;
  const now = OBSERVED - 1;
  const known = knownUntil(pedestrian);
  const toPixels = (places) => places.map(view.px);
  stroke(context, toPixels(trail(pedestrian.observed, pedestrian.truth, 0, Math.min(time, now))), palette.other, 1.4, 0.8);
  if (show.truth) {
    stroke(context, toPixels(trail(pedestrian.observed, pedestrian.truth, now, known)), palette.other, 1, 0.35);
    stroke(context, toPixels(trail(pedestrian.observed, pedestrian.truth, now, Math.min(time, known))), palette.other, 1.4, 0.8);
  }
  if (show.everything) drawHypotheses(context, view, pedestrian, state, palette, 0.5);
  else if (time >= now) {
    const { path } = pedestrian.hypotheses[pedestrian.representative];
    stroke(context, toPixels([pedestrian.observed[now], ...path]), palette.accent, 1, 0.4, [3, 3]);
  }
  const ahead = shownAhead(pedestrian, state);
  dot(context, view.px(placeAt(pedestrian.observed, ahead, time)), 3.4, palette.other, 1, palette.panel);
}

// All hypotheses except the selected one; a larger weight gives a darker and broader line.
function drawHypotheses(context, view, pedestrian, state, palette, strength, chosen = -1) {
  const now = OBSERVED - 1;
  const { heaviest } = pedestrian;
  const start = pedestrian.observed[now];
  const early = state.time < now ? 0.45 : 1;
  for (const hypothesis of pedestrian.hypotheses) {
    if (hypothesis.index === chosen) continue;
    const share = hypothesis.weight / heaviest;
    const alpha = strength * early * (0.16 + 0.55 * share);
    stroke(context, [start, ...hypothesis.path].map(view.px), palette.accent, 0.8 + 1.2 * share, alpha);
    if (state.show.goals && hypothesis.goal) {
      ring(context, view.px(hypothesis.goal), 3 + 4 * Math.sqrt(share), palette.accent, 1, strength * early * (0.35 + 0.45 * share));
    }
    if (state.time > now) {
      const place = view.px(placeAt(pedestrian.observed, hypothesis.path, state.time));
      if (state.time >= FRAMES - 1) star(context, place, 3.2 + 1.6 * share, palette.accent, strength * (0.4 + 0.5 * share));
      else dot(context, place, 1.6 + 1.4 * share, palette.accent, strength * (0.4 + 0.5 * share));
    }
  }
}

// The 90 % region at the current step: discs around the hypotheses, as one area.
function drawRegion(context, view, pedestrian, time, palette) {
  const step = Math.min(Math.ceil(time), FRAMES - 1) - OBSERVED;
  if (step < 0 || !pedestrian.hypotheses[0].radii) return;
  context.globalAlpha = 0.14;
  context.fillStyle = palette.accent;
  context.beginPath();
  for (const { path, radii } of pedestrian.hypotheses) {
    if (radii[step] <= 0) continue;
    const [x, y] = view.px(path[step]);
    context.moveTo(x + radii[step] * view.scale, y);
    context.arc(x, y, radii[step] * view.scale, 0, 2 * Math.PI);
  }
  context.fill();
  context.globalAlpha = 1;
}

function drawChosen(context, view, pedestrian, state, palette) {
  const { time, show } = state;
  const now = OBSERVED - 1;
  if (show.region) drawRegion(context, view, pedestrian, time, palette);
  const known = knownUntil(pedestrian);
  const hypothesis = pedestrian.hypotheses[state.hypothesis ?? pedestrian.representative];
  const toPixels = (places) => places.map(view.px);
  if (show.hypotheses) drawHypotheses(context, view, pedestrian, state, palette, 1, hypothesis.index);
  const early = time < now ? 0.5 : 1;
  if (show.goals && hypothesis.goal) {
    ring(context, view.px(hypothesis.goal), 9, palette.accent, 2, early, palette["accent-soft"]);
  }
  stroke(context, toPixels([pedestrian.observed[now], ...hypothesis.path]), palette.accent, 2.2, 0.75 * early, [6, 4]);
  if (time > now) stroke(context, toPixels(trail(pedestrian.observed, hypothesis.path, now, time)), palette.accent, 3);
  star(context, view.px(hypothesis.path[HORIZON - 1]), 8, palette.accent, early, palette.panel);

  if (show.truth) {
    stroke(context, toPixels(trail(pedestrian.observed, pedestrian.truth, now, known)), palette.truth, 1.6, 0.4);
    stroke(context, toPixels(trail(pedestrian.observed, pedestrian.truth, now, Math.min(time, known))), palette.truth, 3);
  }
  stroke(context, toPixels(trail(pedestrian.observed, pedestrian.truth, 0, Math.min(time, now))), palette.ink, 1.2, 0.5);
  pedestrian.observed.forEach((place, frame) => {
    // A pedestrian that appeared late has no earlier positions.
    if (frame < pedestrian.quality.unseen) ring(context, view.px(place), 2.2, palette.ink, 1, frame <= time ? 0.6 : 0.25);
    else dot(context, view.px(place), 2.6, palette.ink, frame <= time ? 1 : 0.25);
  });

  if (time > now) {
    const place = placeAt(pedestrian.observed, hypothesis.path, time);
    arrow(context, view, place, velocityAt(pedestrian.observed, hypothesis.path, time), palette["accent-deep"], 2);
    dot(context, view.px(place), 5.5, palette.accent, 1, palette.panel);
  }
  if (time <= now || (show.truth && time <= known)) {
    const place = placeAt(pedestrian.observed, pedestrian.truth, time);
    const colour = time <= now ? palette.ink : palette.truth;
    arrow(context, view, place, velocityAt(pedestrian.observed, time <= now ? [] : pedestrian.truth, time), colour, 2);
    dot(context, view.px(place), 5.5, colour, 1, palette.panel);
  }
}

// Numbers beside the pedestrians without overlaps, the selected one last.
function drawNumbers(context, view, moment, state, palette) {
  const taken = [];
  const order = moment.pedestrians.map((_, at) => at).filter((at) => at !== state.pedestrian);
  order.unshift(state.pedestrian);
  for (const at of order) {
    const pedestrian = moment.pedestrians[at];
    if (at !== state.pedestrian && !state.show.others) continue;
    const ahead = shownAhead(pedestrian, state);
    const [x, y] = view.px(placeAt(pedestrian.observed, ahead, state.time));
    const box = [x + 6, y - 18, x + 12 + 7 * String(pedestrian.pedestrian).length, y - 4];
    if (taken.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])) continue;
    taken.push(box);
    const chosen = at === state.pedestrian;
    words(context, String(pedestrian.pedestrian), [x + 8, y - 11], palette, chosen ? { weight: 700, colour: palette.ink, size: 12 } : {});
  }
}

function drawScene(context, view, size, moment, state, palette) {
  const { width, height, ratio } = size;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.globalAlpha = 1;
  context.clearRect(0, 0, width, height);
  context.lineJoin = "round";
  context.lineCap = "butt";
  grid(context, view, width, height, palette);
  const drawThis = state.joint ? drawInFuture : drawOther;
  if (state.show.others) {
    moment.pedestrians.forEach((pedestrian, at) => {
      if (at !== state.pedestrian) drawThis(context, view, pedestrian, state, palette);
    });
  }
  if (state.joint && state.show.others) {
    drawGroups(context, view, moment, state, palette);
    drawPlaces(context, view, moment, state, palette);
  }
  drawChosen(context, view, moment.pedestrians[state.pedestrian], state, palette);
  if (state.joint) drawConflicts(context, view, moment, state, palette);
  drawNumbers(context, view, moment, state, palette);
  context.globalAlpha = 1;
}
