// The slider of joint futures, the switch that shows all of them, and the words about the chosen one.

// Conflicts that are named; the picture marks all.
const NAMED_CONFLICTS = 3;

function conflictWords(moment, conflicts) {
  if (conflicts.length === 0) return "nobody";
  const name = (at) => moment.pedestrians[at].pedestrian;
  const one = ({ pair, nearest, gap }) => {
    const seconds = (nearest - (OBSERVED - 1)) * SECONDS_A_FRAME;
    return `${name(pair[0])} and ${name(pair[1])} at +${seconds.toFixed(1)}\u00a0s (${gap.toFixed(2)}\u00a0m)`;
  };
  const more = conflicts.length - NAMED_CONFLICTS;
  const named = conflicts.slice(0, NAMED_CONFLICTS).map(one);
  return `${named.join(", ")}${more > 0 ? `, and ${more} more` : ""}`;
}

// `choose` gets the index of a future, `showAll` whether all are shown.
function makeFuturesControl(choose, showAll) {
  const slider = document.getElementById("future");
  const all = document.getElementById("show-futures");
  slider.addEventListener("input", () => choose(Number(slider.value) - 1));
  all.addEventListener("change", () => showAll(all.checked));

  function show(moment, chosen, conflicts) {
    const { hypotheses } = moment.pedestrians[0];
    const weight = 100 * hypotheses[chosen].weight;
    const share = weight > 0 && weight < 1 ? "below 1" : weight.toFixed(0);
    const words = `future ${chosen + 1} of ${hypotheses.length} (weight ${share} %)`;
    slider.max = hypotheses.length;
    slider.value = chosen + 1;
    slider.setAttribute("aria-valuetext", words);
    document.getElementById("future-words").textContent = words;
    document.getElementById("future-name").textContent = `Future ${chosen + 1}`;
    document.getElementById("conflict-words").textContent = conflictWords(moment, conflicts);
  }

  return { show, toggleAll: () => all.click() };
}
