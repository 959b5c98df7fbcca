// The npm package of `cargo xtask web` in node against the program: node --test tests/page/check_npm.mjs
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import init, { forecast, Live } from "../../target/web/npm/node.js";

const TOLERANCE = 1e-5; // m
const SAMPLE = "datasets/sample.csv";
const bytes = readFileSync(SAMPLE);

function program(words, input) {
  const done = spawnSync("target/debug/ddl", words, { input, encoding: "utf8", maxBuffer: 1 << 30 });
  assert.equal(done.status, 0, done.stderr);
  return { lines: done.stdout.trim().split("\n").map((line) => JSON.parse(line)), told: done.stderr };
}

function same(found, expected, where = "") {
  if (typeof expected === "number") assert.ok(Math.abs(found - expected) <= TOLERANCE, `${where}: ${found}, ${expected}`);
  else if (expected === null || typeof expected !== "object") assert.equal(found, expected, where);
  else {
    assert.deepEqual(Object.keys(found), Object.keys(expected), where);
    for (const key of Object.keys(expected)) same(found[key], expected[key], `${where}.${key}`);
  }
}

// Joint futures are drawn: where a number lies on the edge of a draw, its last bit decides (check_web.py).
const REDRAWN = 0.05;

function agree(found, expected, where) {
  assert.equal(found.length, expected.length, where);
  const differing = [];
  found.forEach((line, at) => {
    try {
      same(line, expected[at], `${where} ${at}`);
    } catch (error) {
      differing.push(error);
    }
  });
  const most = where.includes("--joint") ? REDRAWN * expected.length : 0;
  if (differing.length > most) throw differing[0];
  console.log(`${where}: ${expected.length - differing.length} of ${expected.length} agree`);
}

// The rows of the sample at ten frames a second, as a tracker gives them.
const rows = bytes.toString().trim().split("\n").slice(1, 400).map((line) => line.split(",").map(Number));
const frames = [...new Set(rows.map(([frame]) => frame))];

function live(options) {
  const place = new Live({ fps: 10, ...options });
  const answers = frames.flatMap((frame) => {
    const here = rows.filter((row) => row[0] === frame);
    const ids = Float64Array.from(here, (row) => row[1]);
    return place.observe(frame, ids, Float64Array.from(here.flatMap((row) => row.slice(2)))).forecasts;
  });
  place.free();
  return answers;
}

test("forecasts of a file are those of the program", async () => {
  await init();
  for (const [options, words] of [
    [{}, []],
    [{ joint: true }, ["--joint"]],
    [{ last: true, whole: true }, ["--last", "--whole"]],
    [{ region: [0.5, 0.9] }, ["--region", "0.5,0.9"]],
    [{ fps: 5, every: 0.8 }, ["--fps", "5", "--every", "0.8"]],
  ]) {
    const expected = program(["forecast", SAMPLE, "--format", "jsonl", ...words]);
    const { notes, forecasts } = forecast(SAMPLE, bytes, options);
    agree(forecasts, expected.lines, ["a file", ...words].join(" "));
    for (const note of notes) assert.ok(expected.told.includes(note), note);
  }
});

test("unfamiliar motions are told as by the program, live once", () => {
  const unlike = ["frame,pedestrian,x,y"];
  for (let t = 0; t < 12; t += 1) unlike.push(`${t},4,${t},${2 * (t % 2)}`);
  const text = `${unlike.join("\n")}\n`;
  const of = (notes) => notes.filter((note) => note.includes("unlike the training motions"));
  const { notes } = forecast("unlike.csv", Buffer.from(text), { fps: 2.5 });
  assert.equal(of(notes).length, 1);
  const place = new Live({ fps: 2.5 });
  const told = unlike.slice(1).flatMap((row) => {
    const [frame, id, x, y] = row.split(",").map(Number);
    return place.observe(frame, Float64Array.of(id), Float64Array.of(x, y)).notes;
  });
  place.free();
  assert.equal(of(told).length, 1);
});

test("live forecasts are those of the program", () => {
  const text = "frame,pedestrian,x,y\n" + rows.map((row) => row.join(",")).join("\n") + "\n";
  for (const [options, words] of [[{}, []], [{ joint: true }, ["--joint"]], [{ region: [0.9] }, ["--region", "0.9"]]]) {
    const expected = program(["forecast", "-", "--fps", "10", "--format", "jsonl", ...words], text);
    agree(live(options), expected.lines, ["live", ...words].join(" "));
  }
});

test("between two moments nothing is due", () => {
  const place = new Live({ every: 0.4 });
  for (let tick = 0; tick < 20; tick += 1) {
    const { due, forecasts } = place.observe(0.1 * tick, Float64Array.of(7), Float64Array.of(0.1 * tick, 1));
    assert.deepEqual([due, forecasts.length], [tick % 4 === 0, tick % 4 === 0 ? 1 : 0]);
  }
});

test("a memory grows, times are seconds, and a faulty frame changes nothing", () => {
  const place = new Live({ memory: true });
  for (let step = 0; step < 60; step += 1) {
    const { forecasts } = place.observe(0.4 * step, Float64Array.of(7), Float64Array.of(0.5 * step, 1));
    assert.equal(forecasts.length, step === 0 ? 0 : 1);
  }
  assert.ok(place.remembered() > 0);
  assert.throws(() => place.observe(1, Float64Array.of(7), Float64Array.of(0, 0)), /^at 1 s \(frames are microseconds\): frame 1000000 comes after/);
  assert.throws(() => place.observe(30, Float64Array.of(7), Float64Array.of(0)), /two for each id/);
  assert.throws(() => place.observe(30, Float64Array.of(7.5), Float64Array.of(0, 0)), /whole number/);
  assert.equal(place.observe(24, Float64Array.of(7), Float64Array.of(30, 1)).forecasts.length, 1);
  assert.throws(() => forecast("a.csv", Buffer.from("frame,pedestrian,x,y\n0,1,left,2\n")), /a\.csv, line 2, field 3/);
  assert.throws(() => forecast("a.csv", Buffer.from("\x89MCAP0\r\n", "latin1")), /a\.csv: an MCAP file/);
  assert.throws(() => forecast("a.csv", bytes.toString()), /the bytes of the file are no Uint8Array/);
  const row = (_, i) => `${Math.floor(i / 1000)},${i % 1000},${0.4 * Math.floor(i / 1000)},${i % 1000}`;
  const many = ["frame,pedestrian,x,y", ...Array.from({ length: 42_000 }, row)].join("\n");
  assert.throws(() => forecast("a.csv", Buffer.from(many), { fps: 2.5 }), /41000 forecasts exceed the 40000/);
  assert.throws(() => forecast({}, bytes), /the name of the file is no string/);
  for (const moment of [NaN, 1e10]) {
    assert.throws(() => place.observe(moment, Float64Array.of(7), Float64Array.of(0, 0)), /a number of seconds/);
  }
  assert.throws(() => place.observe(30, Float64Array.of(7), Float64Array.of(1e8, 0)), /is no position/);
  for (const number of [NaN, Infinity]) assert.throws(() => new Live({ maxAge: number }), /maxAge is/);
  assert.throws(() => forecast(SAMPLE, bytes, { region: [NaN] }), /region is/);
  for (const options of [{ unit: "m" }, { homography: "1" }, { keep: "a=b" }, { last: true }, { moments: 1 }]) {
    assert.throws(() => new Live(options), { message: /^\w+ is an option of files/ });
  }
  assert.throws(() => forecast(SAMPLE, bytes, { fsp: 5 }), /unknown field `fsp`/);
  assert.throws(() => forecast(SAMPLE, bytes, { region: [2] }), /probability of a region/);
});

test("joint futures of 25 people, in milliseconds", () => {
  const place = new Live({ joint: true });
  const ids = Float64Array.from({ length: 25 }, (_, i) => i);
  const times = [];
  for (let step = 0; step < 40; step += 1) {
    const xy = Float64Array.from([...ids].flatMap((i) => [(i % 5) * 2 + 0.5 * step * (-1) ** i, Math.floor(i / 5) * 1.5]));
    const start = performance.now();
    const { forecasts } = place.observe(0.4 * step, ids, xy);
    times.push(performance.now() - start);
    if (step > 0) assert.equal(forecasts[0].futures[0].paths.length, 25);
  }
  times.sort((a, b) => a - b);
  console.log(`25 people x 20 joint futures: median ${times[20].toFixed(0)} ms, least ${times[1].toFixed(0)} ms`);
  assert.ok(times[20] < 300);
});
