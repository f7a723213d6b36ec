"use strict";
// Data of the page. Numbers are base64 of little-endian arrays, decoded when they are first used.
const scene = JSON.parse(document.getElementById("data").textContent);
const KINDS = { f4: Float32Array, i4: Int32Array, u1: Uint8Array };
const decoded = { f4: new Map(), i4: new Map(), u1: new Map() };

function numbers(text, kind) {
  const known = decoded[kind];
  if (!known.has(text)) {
    const letters = atob(text);
    const bytes = new Uint8Array(letters.length);
    for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
    known.set(text, new KINDS[kind](bytes.buffer));
  }
  return known.get(text);
}

const STATES = ["taut", "wrinkled", "slack"];
const AXES = ["x", "y", "z"];
const nodes = numbers(scene.nodes, "i4");
const points = numbers(scene.points, "f4");
const supports = numbers(scene.supports, "u1");
const parts = scene.parts.map((part) => ({
  ...part,
  bar: part.kind !== "membrane",
  corners: part.kind === "membrane" ? 3 : 2,
  cells: numbers(part.cells, "i4"),
  numbers: numbers(part.numbers, "i4"),
  visible: true,
}));
const forceField = scene.fields.findIndex((field) => field.group === "cables and masts" && field.name === "force");
const stateField = scene.fields.findIndex((field) => field.group === "state");

function positions(stage, factor) {
  const moved = stage.displacement && numbers(stage.displacement, "f4");
  return moved ? points.map((x, i) => x + factor * moved[i]) : points;
}

// Values of a field of nodes: the size of the displacement, or its component.
function nodal(stage, field) {
  const moved = numbers(stage.displacement, "f4");
  const axis = AXES.indexOf(field.name.slice(-1));
  const values = new Float32Array(nodes.length);
  for (let n = 0; n < nodes.length; n++) {
    const at = 3 * n;
    values[n] = axis < 0 ? Math.hypot(moved[at], moved[at + 1], moved[at + 2]) : moved[at + axis];
  }
  return values;
}

// Values of a field in the cells of a part, or null.
function cellular(stage, number, part) {
  const entry = number < 0 ? null : stage.fields[number];
  const text = entry && entry.values && entry.values[part.name];
  if (text === undefined || text === null) return null;
  return numbers(text, scene.fields[number].group === "state" ? "u1" : "f4");
}

function extent(coordinates) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < coordinates.length; i++) {
    const axis = i % 3;
    if (coordinates[i] < low[axis]) low[axis] = coordinates[i];
    if (coordinates[i] > high[axis]) high[axis] = coordinates[i];
  }
  return { low, high, size: Math.hypot(...high.map((x, axis) => x - low[axis])) };
}

const size = extent(points).size;

function shown(value) {
  if (value === null || value === undefined) return "none";
  const size = Math.abs(value);
  if (size && (size < 1e-4 || size >= 1e7)) return Number(value.toPrecision(5)).toExponential();
  return String(Number(value.toPrecision(5)));
}
