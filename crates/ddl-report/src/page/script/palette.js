// The colours of the page for a canvas, which does not support CSS variables.

const PALETTE_NAMES = ["ink", "ink-2", "paper", "panel", "rule", "rule-soft", "other", "accent", "accent-deep", "accent-soft", "truth", "third", "warn-rule"];

// A probe element resolves the variables of the theme.
function readPalette() {
  const probe = document.createElement("span");
  probe.hidden = true;
  document.body.append(probe);
  const palette = {};
  for (const name of PALETTE_NAMES) {
    probe.style.color = `var(--${name})`;
    palette[name] = getComputedStyle(probe).color;
  }
  palette.font = getComputedStyle(document.body).fontFamily;
  probe.remove();
  return palette;
}
