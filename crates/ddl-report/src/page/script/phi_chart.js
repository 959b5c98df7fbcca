// Phi over time: one line for each hypothesis, with a cursor at the time of the player.

const PHI = { width: 336, height: 150, left: 34, right: 326, top: 8, bottom: 122 };

function svgElement(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].find((digit) => digit * power >= 0.999 * least) * power;
}

function makePhiChart(svg) {
  svg.setAttribute("viewBox", `0 0 ${PHI.width} ${PHI.height}`);
  let cursor = null;
  let marker = null;
  let values = null;
  let up = null;
  const across = (t) => PHI.left + (t / HORIZON) * (PHI.right - PHI.left);

  // Lines of a pedestrian; the selected hypothesis is drawn last.
  function draw(pedestrian, chosen) {
    svg.replaceChildren();
    const lines = pedestrian.hypotheses.map((hypothesis) => phi(pedestrian, hypothesis));
    values = lines[chosen];
    const known = lines.filter((line) => line);
    if (known.length === 0) {
      cursor = null;
      svg.append(svgElement("text", { x: PHI.left, y: PHI.height / 2 }, "This forecast has no goals."));
      return;
    }
    const largest = Math.max(...known.flat(), 0.1);
    const step = roundStep(largest / 3);
    const high = Math.ceil(largest / step - 1e-9) * step;
    up = (value) => PHI.bottom - (value / high) * (PHI.bottom - PHI.top);
    for (let value = 0; value <= high * 1.0001; value += step) {
      svg.append(svgElement("line", { class: value ? "grid" : "axis", x1: PHI.left, x2: PHI.right, y1: up(value), y2: up(value) }));
      const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      svg.append(svgElement("text", { class: "small end", x: PHI.left - 6, y: up(value) + 4 }, value ? value.toFixed(decimals) : "0"));
    }
    for (const t of [0, 3, 6, 9, 12]) {
      const label = t === 0 ? "now" : `+${(t * SECONDS_A_FRAME).toFixed(1)} s`;
      const place = t === HORIZON ? "end" : "middle";
      svg.append(svgElement("text", { class: `small ${place}`, x: t === HORIZON ? PHI.right + 6 : across(t), y: PHI.bottom + 16 }, label));
    }
    const { heaviest } = pedestrian;
    const order = pedestrian.hypotheses.map((_, k) => k).filter((k) => k !== chosen && lines[k]);
    if (values) order.push(chosen);
    for (const k of order) {
      const points = lines[k].map((value, t) => `${across(t).toFixed(1)},${up(value).toFixed(1)}`).join(" ");
      const share = pedestrian.hypotheses[k].weight / heaviest;
      const style = k === chosen ? "" : `opacity:${(0.16 + 0.5 * share).toFixed(2)};stroke-width:${(0.8 + 0.8 * share).toFixed(1)}`;
      svg.append(svgElement("polyline", { class: k === chosen ? "line chosen" : "line", points, style }));
    }
    cursor = svgElement("line", { class: "cursor", y1: PHI.top, y2: PHI.bottom });
    marker = svgElement("circle", { class: "dot", r: 4.5 });
    svg.append(cursor, marker);
  }

  // Moves the cursor; before the forecast it stays at the start.
  function moveTo(time) {
    if (!cursor) return;
    const t = Math.max(0, time - (OBSERVED - 1));
    cursor.setAttribute("x1", across(t));
    cursor.setAttribute("x2", across(t));
    cursor.style.opacity = time < OBSERVED - 1 ? 0.25 : 1;
    marker.style.display = values ? "" : "none";
    if (!values) return;
    const before = Math.min(Math.floor(t), HORIZON - 1);
    const value = values[before] + (t - before) * (values[before + 1] - values[before]);
    marker.setAttribute("cx", across(t));
    marker.setAttribute("cy", up(value));
  }

  return { draw, moveTo };
}
