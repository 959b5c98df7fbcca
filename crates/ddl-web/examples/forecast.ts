// Forecasts of a file and of live tracks. In a browser the bytes are those of a chosen file.
import { readFileSync } from "node:fs";
import init, { forecast, Live, type PedestrianForecast, type SceneForecast } from "ddl-forecast";

await init();

const bytes = readFileSync(process.argv[2] ?? "tracks.csv");
const { notes, forecasts } = forecast("tracks.csv", bytes, { last: true });
for (const note of notes) console.error(note);
for (const { pedestrian, hypotheses } of forecasts as PedestrianForecast[]) {
  const likeliest = hypotheses.reduce((best, one) => (one.weight > best.weight ? one : best));
  const [x, y] = likeliest.positions[11];
  console.log(`pedestrian ${pedestrian} in 4.8 s: (${x.toFixed(2)}, ${y.toFixed(2)}) m`);
}

// Two pedestrians, ten times a second.
const live = new Live({ fps: 10, joint: true });
for (let frame = 0; frame < 30; frame += 1) {
  const x = 0.13 * frame;
  const answer = live.observe(frame, Float64Array.of(1, 2), Float64Array.of(x, 0, 9 - x, 0.4));
  for (const { futures } of answer.forecasts as SceneForecast[]) {
    if (frame === 29) console.log(`${futures.length} joint futures, the first of weight ${futures[0].weight.toFixed(2)}`);
  }
}
live.free();
