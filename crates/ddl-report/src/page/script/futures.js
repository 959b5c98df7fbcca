// The joint futures of a moment: hypothesis k of all pedestrians is future k.

// Pedestrians closer than this are in conflict, in metres.
const CONFLICT = 0.4;

function likeliestFuture(moment) {
  const { hypotheses } = moment.pedestrians[0];
  return hypotheses.reduce((best, h) => (h.weight > hypotheses[best].weight ? h.index : best), 0);
}

// The shares of a step, 0 to 1, between which two are in conflict, and the share of their smallest distance. Both move
// along straight lines, so that the difference of their positions is `from` at 0 and `to` at 1. Null without a conflict.
function conflictInStep(from, to) {
  const moved = [to[0] - from[0], to[1] - from[1]];
  const speed = moved[0] ** 2 + moved[1] ** 2;
  const slope = from[0] * moved[0] + from[1] * moved[1];
  const excess = from[0] ** 2 + from[1] ** 2 - CONFLICT ** 2;
  if (speed < 1e-12) return excess < 0 ? { low: 0, high: 1, nearest: 0 } : null;
  const root = slope ** 2 - speed * excess;
  if (root <= 0) return null;
  const low = Math.max((-slope - Math.sqrt(root)) / speed, 0);
  const high = Math.min((-slope + Math.sqrt(root)) / speed, 1);
  return low < high ? { low, high, nearest: Math.min(Math.max(-slope / speed, 0), 1) } : null;
}

// The conflicts of two paths that begin at the last observed step: from when to when, the time of the smallest distance
// (in frames, as the player counts), and this distance in metres.
function conflictsOfPair(a, b) {
  const difference = (step) => [b[step][0] - a[step][0], b[step][1] - a[step][1]];
  const found = [];
  for (let step = 0; step < HORIZON; step += 1) {
    const [from, to] = [difference(step), difference(step + 1)];
    const conflict = conflictInStep(from, to);
    if (!conflict) continue;
    const start = OBSERVED - 1 + step;
    const gap = Math.hypot(...[0, 1].map((axis) => from[axis] + conflict.nearest * (to[axis] - from[axis])));
    const last = found.at(-1);
    if (last && start + conflict.low - last.until < 1e-9) {
      last.until = start + conflict.high;
      if (gap < last.gap) Object.assign(last, { gap, nearest: start + conflict.nearest });
    } else {
      found.push({ since: start + conflict.low, until: start + conflict.high, nearest: start + conflict.nearest, gap });
    }
  }
  return found;
}

// The conflicts of future k, by the time of the smallest distance; `pair` has two indices of pedestrians.
function conflictsOf(moment, k) {
  const tracks = moment.pedestrians.map((who) => [who.observed[OBSERVED - 1], ...who.hypotheses[k].path]);
  const found = [];
  for (let i = 0; i < tracks.length; i += 1) {
    for (let j = i + 1; j < tracks.length; j += 1) {
      for (const conflict of conflictsOfPair(tracks[i], tracks[j])) found.push({ ...conflict, pair: [i, j] });
    }
  }
  return found.sort((a, b) => a.nearest - b.nearest);
}

// Pairs of indices that join each group by the shortest lines at the last observed step.
function groupLinks(moment) {
  const place = (at) => moment.pedestrians[at].observed[OBSERVED - 1];
  const links = [];
  for (const group of moment.groups ?? []) {
    const joined = [group[0]];
    const apart = group.slice(1);
    while (apart.length > 0) {
      let best = null;
      for (const from of joined) {
        for (const to of apart) {
          const length = distance(place(from), place(to));
          if (!best || length < best.length) best = { from, to, length };
        }
      }
      links.push([best.from, best.to]);
      joined.push(best.to);
      apart.splice(apart.indexOf(best.to), 1);
    }
  }
  return links;
}
