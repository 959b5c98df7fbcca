// The player: the selection, and the parts of the page that depend on it.

// The close-up includes the neighbourhood of the pedestrian.
const CLOSE_UP_ROOM = 1.25;

const byId = (id) => document.getElementById(id);

function makePlayer(moments) {
  const stage = document.querySelector(".stage");
  const canvas = byId("scene");
  const context = canvas.getContext("2d");
  const decoded = new Map();
  const forecasters = new Set(moments.map((moment) => moment.forecaster));
  const recordings = [];
  for (const moment of moments) {
    const name = recordingName(moment);
    if (!recordings.includes(name)) recordings.push(name);
  }
  // Joint futures are stepped through, so that a hypothesis is always chosen: the same one of everybody.
  const joint = moments.every((moment) => moment.joint);
  byId("player").classList.toggle("joint", joint);
  const state = {
    joint,
    moment: 0,
    pedestrian: 0,
    hypothesis: null,
    links: [],
    conflicts: [],
    time: OBSERVED - 1,
    show: { truth: true, hypotheses: !joint, goals: true, region: !joint, others: true, everything: false, whole: false },
  };
  let palette = readPalette();
  let size = { width: 0, height: 0, ratio: 1 };
  let view = null;
  let waiting = false;
  const chart = makePhiChart(byId("phi"));
  const list = makeHypothesisList(byId("hypotheses"), chooseHypothesis);
  const futures = makeFuturesControl(followHypothesis, (on) => ["hypotheses", "everything"].forEach((name) => setShow(name, on)));
  const clock = makeClock(showTime, (playing) => {
    byId("play").setAttribute("aria-pressed", playing);
    // A screen reader gets the time after a stop, not every frame.
    for (const id of ["time-words", "now-words"]) byId(id).setAttribute("aria-live", playing ? "off" : "polite");
    byId("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  });

  function recordingName(moment) {
    const fold = moment.fold === moment.recording ? "" : ` (fold ${moment.fold})`;
    const who = forecasters.size > 1 ? `, ${moment.forecaster}` : "";
    return `${moment.recording}${fold}${who}`;
  }

  function momentAt(at) {
    if (!decoded.has(at)) decoded.set(at, decodeMoment(moments[at]));
    return decoded.get(at);
  }

  const current = () => momentAt(state.moment);
  const pedestrian = () => current().pedestrians[state.pedestrian];
  // In place of a choice: each pedestrian's representative hypothesis, or the likeliest future.
  const unchosen = () => (joint ? likeliestFuture(current()) : null);
  const chosenHypothesis = () => state.hypothesis ?? pedestrian().representative;

  function fillSelect(select, options, value) {
    select.replaceChildren(...options.map(([key, text]) => new Option(text, key, false, String(key) === String(value))));
  }

  function momentsOf(name) {
    return moments.map((_, at) => at).filter((at) => recordingName(moments[at]) === name);
  }

  // Draws at most once before the next picture.
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      draw();
    });
  }

  function draw() {
    if (!view) return;
    drawScene(context, view, size, current(), state, palette);
  }

  function fit() {
    const box = canvas.getBoundingClientRect();
    if (box.width === 0) return;
    const ratio = window.devicePixelRatio || 1;
    size = { width: box.width, height: box.height, ratio };
    canvas.width = Math.round(box.width * ratio);
    canvas.height = Math.round(box.height * ratio);
    const places = [];
    if (state.show.whole) current().pedestrians.forEach((who, at) => places.push(...placesOf(who, joint || at === state.pedestrian)));
    else places.push(...placesOf(pedestrian(), true));
    view = viewOf(places, size.width, size.height, state.show.whole ? 1 : CLOSE_UP_ROOM);
    redraw();
  }

  function showTime(time) {
    state.time = time;
    const frame = Math.floor(time + 1e-9);
    const seconds = (time - (OBSERVED - 1)) * SECONDS_A_FRAME;
    const part = frame < OBSERVED ? `observed step ${frame + 1} of ${OBSERVED}` : `forecast step ${frame - OBSERVED + 1} of ${HORIZON}`;
    const sign = seconds < -1e-9 ? "−" : seconds > 1e-9 ? "+" : "";
    byId("time-words").textContent = `${sign}${Math.abs(seconds).toFixed(1)} s, ${part}`;
    byId("time").value = frame + 1;
    byId("time").setAttribute("aria-valuetext", byId("time-words").textContent);
    const who = pedestrian();
    const ahead = frame >= OBSERVED - 1 && time > OBSERVED - 1 ? who.hypotheses[chosenHypothesis()].path : who.truth;
    const [x, y] = placeAt(who.observed, ahead, time);
    const what = time > OBSERVED - 1 ? "forecast" : "observed";
    // At the opening moment the speed is that of the last observed step.
    const speed = Math.hypot(...velocityAt(who.observed, what === "forecast" ? ahead : [], time));
    byId("now-words").textContent = `${what} at (${x.toFixed(2)}, ${y.toFixed(2)}) m, ${speed.toFixed(2)} m/s`;
    canvas.dataset.time = time.toFixed(3);
    chart.moveTo(time);
    redraw();
  }

  function showPedestrian() {
    const moment = current();
    const who = pedestrian();
    const errors = pedestrianErrors(who);
    const chosen = chosenHypothesis();
    byId("choose-pedestrian").value = state.pedestrian;
    byId("pedestrian-name").textContent = `Pedestrian ${who.pedestrian}`;
    // Without a true future there are no errors, and their fields are hidden.
    stage.classList.toggle("unmeasured", errors.minAde === null);
    byId("min-ade").textContent = errorWords(errors.minAde);
    byId("min-fde").textContent = errorWords(errors.minFde);
    const count = who.hypotheses.length;
    const best = count === 1 ? "Of its one hypothesis" : `Best of ${count} hypotheses, two separate minima`;
    const measured = errors.minAde === null
      ? `Not measured: observed for ${who.truth.length} of the ${HORIZON} forecast steps. `
      : `${best}; from positions rounded to the millimetre. `;
    byId("convention-words").textContent =
      measured + qualityWords(who) + familiarityWords(who) +
      `Forecast by ${moment.forecaster}; ${moment.recording}, ${whenWords(moment)}.`;
    canvas.setAttribute(
      "aria-label",
      `The scene from above: ${moment.pedestrians.length} pedestrians of ${moment.recording}, ${whenWords(moment)}; pedestrian ${who.pedestrian} is chosen`,
    );
    chart.draw(who, chosen);
    list.draw(who, errors, chosen);
    showVerdict();
    fit();
    showTime(state.time);
  }

  function chooseHypothesis(index) {
    // A second click selects the representative hypothesis.
    followHypothesis(state.hypothesis === index ? unchosen() : index);
  }

  function followHypothesis(index) {
    state.hypothesis = index;
    const chosen = chosenHypothesis();
    if (joint) showFuture();
    list.mark(chosen);
    chart.draw(pedestrian(), chosen);
    showVerdict();
    showTime(state.time);
  }

  function showFuture() {
    state.conflicts = conflictsOf(current(), state.hypothesis);
    futures.show(current(), state.hypothesis, state.conflicts);
  }

  function showVerdict() {
    const who = pedestrian();
    const chosen = chosenHypothesis();
    const stands = !joint && chosen === who.representative && who.hypotheses.length > 1 ? ", the representative one" : "";
    byId("certificate-words").textContent = `${joint ? "Future" : "Hypothesis"} ${chosen + 1}${stands}: ${verdictWords(who, who.hypotheses[chosen])}.`;
  }

  function choosePedestrian(at) {
    const count = current().pedestrians.length;
    state.pedestrian = (at + count) % count;
    if (!joint) state.hypothesis = null;
    showPedestrian();
  }

  function chooseMoment(at, who = 0) {
    state.moment = (at + moments.length) % moments.length;
    const moment = current();
    const name = recordingName(moment);
    fillSelect(byId("choose-recording"), recordings.map((r) => [r, r]), name);
    fillSelect(
      byId("choose-moment"),
      momentsOf(name).map((m) => {
        const people = moments[m].pedestrians.length;
        return [m, [whenWords(moments[m]), `${people} ${people === 1 ? "pedestrian" : "pedestrians"}`].join(", ")];
      }),
      state.moment,
    );
    fillSelect(byId("choose-pedestrian"), moment.pedestrians.map((w, i) => [i, `pedestrian ${w.pedestrian}`]), 0);
    state.hypothesis = unchosen();
    if (joint) {
      state.links = groupLinks(moment);
      showFuture();
    }
    choosePedestrian(who);
  }

  function setShow(name, on) {
    state.show[name] = on;
    byId(`show-${name}`).checked = on;
    if (name === "whole") fit();
    redraw();
  }

  byId("play").addEventListener("click", clock.toggle);
  byId("back").addEventListener("click", () => clock.step(-1));
  byId("forth").addEventListener("click", () => clock.step(1));
  byId("time").addEventListener("input", (event) => {
    clock.play(false);
    clock.set(Number(event.target.value) - 1);
  });
  byId("choose-recording").addEventListener("change", (event) => chooseMoment(momentsOf(event.target.value)[0]));
  byId("choose-moment").addEventListener("change", (event) => chooseMoment(Number(event.target.value)));
  byId("choose-pedestrian").addEventListener("change", (event) => choosePedestrian(Number(event.target.value)));
  for (const [name, on] of Object.entries(state.show)) {
    byId(`show-${name}`).checked = on;
    byId(`show-${name}`).addEventListener("change", (event) => setShow(name, event.target.checked));
  }
  canvas.addEventListener("click", (event) => {
    const box = canvas.getBoundingClientRect();
    const found = nearestPedestrian([event.clientX - box.left, event.clientY - box.top], view, current(), state);
    if (found !== undefined) choosePedestrian(found);
    stage.focus({ preventScroll: true });
  });
  onThemeChange(() => {
    palette = readPalette();
    redraw();
  });
  new ResizeObserver(fit).observe(canvas);
  if (document.body.dataset.first === "busiest") {
    setShow("whole", true);
    // The moment with the most known futures; without known futures, the one with the most pedestrians.
    const known = moments.map(({ pedestrians }) => pedestrians.filter((who) => who.truth.length === 2 * HORIZON).length);
    const people = moments.map(({ pedestrians }) => pedestrians.length);
    const score = Math.max(...known) > 0 ? known : people;
    const first = score.indexOf(Math.max(...score));
    // Of these, the pedestrian that moved farthest.
    const far = ({ truth }) => (truth.length === HORIZON ? distance(truth[0], truth[HORIZON - 1]) : -1);
    const ways = momentAt(first).pedestrians.map(far);
    chooseMoment(first, ways.indexOf(Math.max(...ways)));
  } else {
    chooseMoment(0);
  }

  return {
    clock,
    nextPedestrian: (by) => choosePedestrian(state.pedestrian + by),
    nextMoment: (by) => chooseMoment(state.moment + by),
    nextRecording: () => {
      const at = recordings.indexOf(recordingName(current()));
      chooseMoment(momentsOf(recordings[(at + 1) % recordings.length])[0]);
    },
    nextFuture: (by) => {
      const count = pedestrian().hypotheses.length;
      if (joint) followHypothesis((state.hypothesis + by + count) % count);
    },
    toggle: (name) => (joint && ["hypotheses", "everything"].includes(name) ? futures.toggleAll() : setShow(name, !state.show[name])),
    sortByWeight: () => list.sort("weight"),
    stage,
    // For measurements: the time of one drawing with all hypotheses, in milliseconds.
    measure: (times) => {
      const before = state.show.everything;
      state.show.everything = true;
      const start = performance.now();
      for (let i = 0; i < times; i += 1) draw();
      context.getImageData(0, 0, 1, 1);
      const spent = (performance.now() - start) / times;
      state.show.everything = before;
      draw();
      return spent;
    },
  };
}
