// Training curves: the pointer shows the values of an epoch.

{
  const curves = embedded("curves-json");

  const readOut = (svg, event) => {
    const data = svg.parentElement.dataset;
    const box = svg.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * svg.viewBox.baseVal.width;
    const share = (x - data.left) / (data.right - data.left);
    const first = Number(data.first);
    const epoch = Math.round(first + Math.min(Math.max(share, 0), 1) * (Number(data.last) - first));
    const parts = [];
    for (const curve of curves) {
      if (curve.fold !== data.fold || (data.quantity === "loss" && curve.loss !== data.loss)) continue;
      const point = curve.epochs.find((p) => p.epoch === epoch);
      const value = point?.[data.quantity];
      if (value != null) parts.push(`${curve.variant}, seed ${curve.seed}: ${Number(value.toPrecision(4))}`);
    }
    return parts.length ? `Epoch ${epoch}. ${parts.join("; ")}` : "\u00a0";
  };

  for (const svg of document.querySelectorAll("svg.curves")) {
    const caption = svg.parentElement.querySelector("figcaption");
    svg.addEventListener("pointermove", (event) => (caption.textContent = readOut(svg, event)));
    svg.addEventListener("pointerdown", (event) => (caption.textContent = readOut(svg, event)));
    svg.addEventListener("pointerleave", () => (caption.textContent = "\u00a0"));
  }
}
