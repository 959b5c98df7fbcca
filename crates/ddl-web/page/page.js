// The page: takes a file, lets the worker forecast it, and shows the answer.

const byId = (id) => document.getElementById(id);
const embedded = (id) => byId(id).textContent;
const many = (count, one, more) => `${count} ${count === 1 ? one : more}`;

let file = null;
let isNew = false;
let asked = 0;
let worker = start();

function start() {
  const started = new Worker(URL.createObjectURL(new Blob([embedded("worker")], { type: "text/javascript" })));
  started.onmessage = ({ data }) => answered(data);
  started.onerror = (event) => fail(event.message || "this browser cannot run the forecaster: it needs WebAssembly with SIMD");
  started.postMessage({ packed: embedded("forecaster").trim() });
  return started;
}

function answered(data) {
  if (data.id === undefined) {
    if (data.error) fail(data.error);
    else if (!file) byId("state").textContent = "The model is loaded.";
    return;
  }
  if (data.broken) {
    worker.terminate();
    worker = start();
    // What waited for the old worker is asked again.
    if (data.id !== asked) ask();
  }
  // Only the answer to the last question counts.
  if (data.id !== asked) return;
  if (data.broken) fail(`${file.name}: the file is too large for a tab, or the forecaster has a defect (${data.error})`);
  else if (data.error) fail(data.error);
  else show(data.view, data.seconds);
}

function fail(words) {
  byId("state").textContent = "";
  // Notes stand before an error, as the program prints them.
  byId("error").textContent = words.replace(/[^\n]*$/, "error: $&");
  for (const id of ["told", "player", "more"]) byId(id).hidden = true;
  byId("error").hidden = false;
}

async function options() {
  const given = { joint: byId("joint").checked, memory: byId("memory").checked };
  for (const field of byId("options").elements) {
    if (field.type === "checkbox") given[field.name] = field.checked;
    else if (field.type === "file") {
      if (field.files[0]) given[field.name] = await field.files[0].text();
    } else if (field.value !== "") given[field.name] = field.type === "number" ? Number(field.value) : field.value;
  }
  return given;
}

async function ask() {
  if (!file) return;
  asked += 1;
  const id = asked;
  byId("error").hidden = true;
  byId("state").textContent = `Forecasting ${file.name}.`;
  try {
    worker.postMessage({ id, name: file.name, bytes: new Uint8Array(await file.arrayBuffer()), options: await options() });
  } catch (error) {
    fail(`${file.name}: ${error.message}`);
  }
}

function show(view, seconds) {
  const { data } = view;
  byId("state").textContent = `Forecast in ${seconds.toFixed(1)} s, in this tab.`;
  byId("name").textContent = file.name;
  const speed = data.median_speed === null ? "" : `; half of the steps are slower than ${data.median_speed.toFixed(2)} m/s`;
  byId("data").textContent =
    `${many(data.pedestrians, "pedestrian", "pedestrians")} in ${many(data.frames, "frame", "frames")}, ${data.seconds.toFixed(0)} s; ` +
    `x from ${data.low[0].toFixed(1)} to ${data.high[0].toFixed(1)} m, y from ${data.low[1].toFixed(1)} to ${data.high[1].toFixed(1)} m${speed}.`;
  byId("notes").replaceChildren(...view.notes.map((note) => {
    const item = document.createElement("li");
    item.textContent = note;
    item.classList.toggle("warning", note.startsWith("warning: "));
    return item;
  }));
  const picture = new DOMParser().parseFromString(view.place, "image/svg+xml").documentElement;
  // Here it has the colours of the page, in the file those of white paper.
  picture.querySelector("style").remove();
  byId("place").replaceChildren(document.importNode(picture, true));
  for (const id of ["told", "player", "more"]) byId(id).hidden = false;
  play(view.page);
  offer("save-lines", view.lines, "application/x-ndjson", "forecasts.jsonl");
  offer("save-page", view.page, "text/html", "forecasts.html");
  offer("save-place", view.place, "image/svg+xml", "place.svg");
}

// The player's page in a frame of its height; its bar and title are those of this page.
function play(page) {
  const frame = byId("player");
  frame.onload = () => {
    const inner = frame.contentDocument;
    const style = inner.createElement("style");
    style.textContent = ".bar, .kicker, h1 { display: none; } main > header { padding: 0; } html { overflow: hidden; }";
    inner.head.append(style);
    new frame.contentWindow.ResizeObserver(() => {
      frame.style.height = `${inner.body.offsetHeight}px`;
    }).observe(inner.body);
    if (isNew) byId("told").scrollIntoView();
    isNew = false;
    document.body.dataset.shown = asked;
  };
  frame.srcdoc = page;
}

function offer(id, text, type, ending) {
  const link = byId(id);
  URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = `${file.name.replace(/\.[^.]*$/, "")}-${ending}`;
}

function open(chosen) {
  file = chosen;
  isNew = true;
  ask();
}

byId("file").addEventListener("change", (event) => event.target.files[0] && open(event.target.files[0]));
byId("example").addEventListener("click", () => open(new File([embedded("sample")], "sample.csv")));
for (const id of ["options", "joint", "memory"]) byId(id).addEventListener("change", ask);
byId("options").addEventListener("submit", (event) => event.preventDefault());
for (const [name, over] of [["dragover", true], ["dragleave", false], ["drop", false]]) {
  document.addEventListener(name, (event) => {
    event.preventDefault();
    byId("drop").classList.toggle("over", over);
    if (name === "drop" && event.dataTransfer.files[0]) open(event.dataTransfer.files[0]);
  });
}
