// What is known about the observation of a pedestrian, in words.

// How well the pedestrian was observed.
function qualityWords(who) {
  const { unseen, age, deviation } = who.quality;
  const parts = [];
  if (unseen > 0) parts.push(`${unseen} of its ${OBSERVED} observed steps lie before its first observation`);
  if (age >= 0.05) parts.push(`last seen ${age.toFixed(1)} s before`);
  if (deviation >= 0.01) parts.push(`position known to ${(100 * deviation).toFixed(0)} cm`);
  return parts.length === 0 ? "" : `Observation: ${parts.join(", ")}. `;
}

// Similarity of the observed motion to the forecaster's training data.
function familiarityWords(who) {
  if (who.familiarity === null) return "";
  const share = who.familiarity < 0.01 ? "less than 1" : Math.round(100 * who.familiarity);
  return `Familiarity ${who.familiarity.toFixed(2)}: ${share} % of training motions are as unusual. `;
}
