// The metrics of one pedestrian, as the evaluation defines them; all in metres.

const AT_GOAL = 1e-3;

function distance(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

// ADE: mean distance of the 12 positions from the true ones. FDE: distance of the last. Null without all 12 true positions.
function displacement(path, truth) {
  if (truth.length < path.length) return { ade: null, fde: null };
  const distances = path.map((place, at) => distance(place, truth[at]));
  const sum = distances.reduce((total, d) => total + d, 0);
  return { ade: sum / distances.length, fde: distances[distances.length - 1] };
}

// An error in metres; a dash if it is unknown.
function errorWords(error) {
  return error === null ? "–" : error.toFixed(3);
}

// minADE and minFDE: two separate minima over the hypotheses.
function pedestrianErrors(pedestrian) {
  const each = pedestrian.hypotheses.map((h) => displacement(h.path, pedestrian.truth));
  if (pedestrian.truth.length < HORIZON) return { each, minAde: null, minFde: null };
  return {
    each,
    minAde: Math.min(...each.map((e) => e.ade)),
    minFde: Math.min(...each.map((e) => e.fde)),
  };
}

// Phi: the distance to the goal, from the last observed frame (t = 0) to the 12th forecast one.
function phi(pedestrian, hypothesis) {
  if (!hypothesis.goal) return null;
  return [pedestrian.observed[OBSERVED - 1], ...hypothesis.path].map((place) => distance(place, hypothesis.goal));
}

// The verdict on the descent of Phi, in words. It belongs to the unrounded forecast.
function verdictWords(pedestrian, hypothesis) {
  const values = phi(pedestrian, hypothesis);
  if (!values) return "no goal, no Φ";
  const rises = [];
  for (let t = 1; t < values.length; t += 1) {
    const falls = values[t] < values[t - 1] || Math.max(values[t], values[t - 1]) <= AT_GOAL;
    if (!falls) rises.push(t);
  }
  let words;
  if (hypothesis.falls) words = `Φ falls at each of ${HORIZON} steps`;
  else if (rises.length === 0) words = "Φ rises by less than a millimetre";
  else if (rises.length === 1) words = `Φ does not fall at step ${rises[0]} of ${HORIZON}`;
  else words = `Φ does not fall at ${rises.length} of ${HORIZON} steps`;
  const certificate = { true: "; certified", false: "; not certified", null: "" };
  return words + certificate[hypothesis.certified];
}
