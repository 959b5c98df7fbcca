// The embedded moments: whole millimetres and steps along a path become positions in metres.

const OBSERVED = 8;
const HORIZON = 12;
const FRAMES = OBSERVED + HORIZON;
const SECONDS_A_FRAME = 0.4;

function embedded(id) {
  return JSON.parse(document.getElementById(id).textContent);
}

// Steps in millimetres from a position in millimetres, as an array of [x, y] in metres.
function walked(from, steps) {
  let [x, y] = from;
  const path = [];
  for (let at = 0; at < steps.length; at += 2) {
    x += steps[at];
    y += steps[at + 1];
    path.push([x / 1000, y / 1000]);
  }
  return path;
}

function decodePedestrian(data) {
  let last = [0, 0];
  for (let at = 0; at < data.observed.length; at += 2) {
    last = [last[0] + data.observed[at], last[1] + data.observed[at + 1]];
  }
  const verdict = (letter) => (letter === "y" ? true : letter === "n" ? false : null);
  const hypotheses = data.paths.map((steps, index) => {
    const goal = data.goals[index];
    return {
      index,
      weight: data.weights[index] / 1000,
      path: walked(last, steps),
      // Radii of the discs of the 90 % region, in metres; 0 where this hypothesis has no disc.
      radii: data.radii?.[index].map((radius) => radius / 1000),
      goal: goal && [(last[0] + goal[0]) / 1000, (last[1] + goal[1]) / 1000],
      falls: verdict(data.falls[index]),
      certified: verdict(data.certified[index]),
    };
  });
  return {
    pedestrian: data.pedestrian,
    observed: walked([0, 0], data.observed),
    // The true future as far as it was observed: up to 12 positions.
    truth: walked(last, data.truth),
    quality: data.quality ?? { unseen: 0, age: 0, deviation: 0 },
    hypotheses,
    familiarity: data.familiarity === undefined ? null : data.familiarity / 1000,
    representative: data.representative,
    heaviest: Math.max(...hypotheses.map((h) => h.weight), 1e-9),
  };
}

// A moment is decoded when it is first shown, because a page may hold many.
function decodeMoment(data) {
  return { ...data, pedestrians: data.pedestrians.map(decodePedestrian) };
}

// The frame of a moment, or its time as the file has it.
function whenWords(moment) {
  return moment.when ?? `frame ${moment.frame}`;
}

// The last frame, counted from 0, with a known position of the pedestrian.
function knownUntil(pedestrian) {
  return OBSERVED - 1 + pedestrian.truth.length;
}

// The position at a time in frames from 0: interpolated between two frames, the last one after the end.
function placeAt(observed, ahead, time) {
  const last = OBSERVED - 1 + ahead.length;
  const at = Math.min(Math.max(time, 0), last);
  const frame = Math.floor(at);
  const place = (f) => (f < OBSERVED ? observed[f] : ahead[f - OBSERVED]);
  const [a, b] = [place(frame), place(Math.min(frame + 1, last))];
  const share = at - frame;
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
}

// The velocity in m/s of the step at this time; at the end that of the last step.
function velocityAt(observed, ahead, time) {
  const frame = Math.min(Math.floor(Math.max(time, 0)), OBSERVED + ahead.length - 2);
  const [a, b] = [placeAt(observed, ahead, frame), placeAt(observed, ahead, frame + 1)];
  return [(b[0] - a[0]) / SECONDS_A_FRAME, (b[1] - a[1]) / SECONDS_A_FRAME];
}
