// The hypotheses of a pedestrian as a table: weight, errors, verdict; sortable.

const SORT_DOWN = { weight: true, index: false, ade: false, fde: false };

function makeHypothesisList(table, choose) {
  const body = table.tBodies[0];
  let sortBy = "weight";
  let shown = null;

  function order(rows) {
    const sign = SORT_DOWN[sortBy] ? -1 : 1;
    return rows.sort((a, b) => sign * (a[sortBy] - b[sortBy]) || a.index - b.index);
  }

  function row(item, heaviest, chosen) {
    const tr = document.createElement("tr");
    tr.dataset.index = item.index;
    tr.setAttribute("aria-selected", item.index === chosen);
    const head = document.createElement("th");
    head.scope = "row";
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = item.index + 1;
    button.setAttribute("aria-label", `Hypothesis ${item.index + 1}`);
    head.append(button);
    const weight = document.createElement("td");
    weight.className = "weight";
    const bar = document.createElement("span");
    bar.className = "bar-of-weight";
    bar.style.setProperty("--share", (item.weight / heaviest).toFixed(3));
    weight.append(bar, item.weight.toFixed(3));
    tr.append(head, weight);
    for (const text of [errorWords(item.ade), errorWords(item.fde)]) {
      tr.append(Object.assign(document.createElement("td"), { textContent: text }));
    }
    tr.append(Object.assign(document.createElement("td"), { className: "text", textContent: item.verdict }));
    return tr;
  }

  function draw(pedestrian, errors, chosen) {
    shown = { pedestrian, errors, chosen };
    const items = pedestrian.hypotheses.map((h) => ({
      index: h.index,
      weight: h.weight,
      ...errors.each[h.index],
      verdict: verdictWords(pedestrian, h),
    }));
    const { heaviest } = pedestrian;
    body.replaceChildren(...order(items).map((item) => row(item, heaviest, chosen)));
    for (const button of table.tHead.querySelectorAll("button")) {
      const mine = button.dataset.sort === sortBy;
      button.parentElement.setAttribute("aria-sort", mine ? (SORT_DOWN[sortBy] ? "descending" : "ascending") : "none");
    }
  }

  function mark(chosen) {
    if (shown) shown.chosen = chosen;
    for (const tr of body.rows) tr.setAttribute("aria-selected", Number(tr.dataset.index) === chosen);
  }

  function sort(by) {
    sortBy = by;
    if (shown) draw(shown.pedestrian, shown.errors, shown.chosen);
  }

  body.addEventListener("click", (event) => {
    const tr = event.target.closest("tr");
    if (tr) choose(Number(tr.dataset.index));
  });
  table.tHead.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (button) sort(button.dataset.sort);
  });
  return { draw, mark, sort };
}
