// The picture: axes to one scale, an orthographic camera, and the values under the pointer.
const figure = document.getElementById("figure");
const DISTANCE = 2.4;
const VIEWS = { oblique: [1, -1.6, 1.1], plan: [0, -0.001, 1], front: [0, -1, 0], side: [1, 0, 0] }; // z is up in all
const CONFIG = {
  displaylogo: false,
  scrollZoom: false, // the page has its own, beside buttons and keys
  modeBarButtons: [["toImage"]],
  toImageButtonOptions: { filename: "scene" },
};
let zoom = 1;
let drawn = [];
let spans = [1, 1, 1];

// Length of the longest structure that fits at any turn: plotly's orthographic camera sees a height of 2.
// The box of the axes leaves room for their numbers in the first view.
function fit() {
  return Math.min(2.1, 1.85 / boxHeight(), (1.5 * figure.clientWidth) / Math.max(figure.clientHeight, 1));
}

// Height of the box of the axes in the oblique view, of a structure of length one.
function boxHeight() {
  const [x, y, z] = VIEWS.oblique.map(Math.abs);
  const flat = Math.hypot(x, y);
  return (spans[2] * flat + (z * (spans[0] * x + spans[1] * y)) / flat) / Math.hypot(x, y, z) / size;
}

function aspects() {
  return Object.fromEntries(AXES.map((axis, at) => [axis, (zoom * fit() * spans[at]) / size]));
}

// The eye at its distance from a centre, in a direction: plotly moves it nearer to zoom, which shows nothing here.
function from(center, way) {
  const long = Math.hypot(...way) / DISTANCE;
  return Object.fromEntries(AXES.map((axis, at) => [axis, center[axis] + way[at] / long]));
}

function cameraOf(view) {
  const center = { x: 0, y: 0, z: 0 };
  return { eye: from(center, VIEWS[view]), center, up: { x: 0, y: 0, z: 1 }, projection: { type: "orthographic" } };
}

let camera = cameraOf("oblique");

// The user turns plotly's own copy of the camera: it is taken over before the next drawing.
function remember() {
  if (!figure.layout) return;
  const { eye, center } = figure.layout.scene.camera;
  const way = AXES.map((axis) => eye[axis] - center[axis]);
  camera = { ...camera, eye: from(center, way), center };
}

function axesOf(traces, visible) {
  const axes = { aspectmode: "manual", dragmode: "turntable", hovermode: "closest", camera };
  const ends = AXES.map((axis) => {
    const end = [Infinity, -Infinity];
    for (const { trace } of traces) {
      for (const x of trace[axis]) {
        if (x < end[0]) end[0] = x;
        if (x > end[1]) end[1] = x;
      }
    }
    return end[0] <= end[1] ? end : [-size, size];
  });
  const room = 0.04 * size;
  spans = ends.map(([low, high]) => high - low + 2 * room);
  axes.aspectratio = aspects();
  AXES.forEach((axis, at) => {
    const away = scene.origin[at];
    const beside = away ? ` ${away < 0 ? "−" : "+"} ${Math.abs(away)}` : "";
    axes[`${axis}axis`] = {
      range: [ends[at][0] - room, ends[at][1] + room],
      title: { text: `${axis} [${scene.length}]${beside}` },
      visible,
      showspikes: false,
      nticks: 5,
      color: "#5a6772",
      gridcolor: "#cfd6dc",
      zeroline: false,
      showbackground: false,
    };
  });
  return axes;
}

// One layout for all drawings: plotly's mouse keeps the first one.
const layout = {
  scene: {},
  margin: { l: 0, r: 0, t: 0, b: 0 },
  paper_bgcolor: "#ffffff",
  font: { family: "system-ui, 'DejaVu Sans', sans-serif", size: 12, color: scene.colours.ink },
};

function draw(choice) {
  remember();
  drawn = tracesOf(choice);
  Object.assign(layout.scene, axesOf(drawn, choice.axes));
  return Plotly.react(figure, drawn.map(({ trace }) => trace), layout, CONFIG);
}

function look() {
  return Plotly.relayout(figure, { "scene.camera": camera, "scene.aspectratio": aspects() });
}

function place(node) {
  const digits = Math.min(Math.max(0, 4 - Math.floor(Math.log10(size))), 20);
  return AXES.map((_, axis) => Number((points[3 * node + axis] + scene.origin[axis]).toFixed(digits))).join(", ");
}

function vector(values, at) {
  return AXES.map((_, axis) => shown(values[at + axis])).join(", ");
}

function nodeWords(node, choice) {
  const lines = [`node ${nodes[node]} at (${place(node)})`];
  if (choice.stage.displacement) {
    const moved = numbers(choice.stage.displacement, "f4");
    const length = shown(Math.hypot(...moved.subarray(3 * node, 3 * node + 3)));
    lines.push(`displacement ${length} ${scene.length}: (${vector(moved, 3 * node)})`);
  }
  const held = supports[node];
  if (held) lines.push(`held in ${AXES.filter((_, axis) => held & (1 << axis)).join("")}`);
  for (const [name, forces] of [["load", choice.stage.loads], ["reaction", choice.stage.reactions]]) {
    const row = numbers(forces.nodes, "i4").indexOf(node);
    if (row >= 0) lines.push(`${name} (${vector(numbers(forces.vectors, "f4"), 3 * row)}) ${scene.force}`);
  }
  return lines;
}

function cellWords(part, row, choice) {
  const states = cellular(choice.stage, stateField, part);
  const lines = [`${part.name}, cell ${part.numbers[row]}${states ? `, ${STATES[states[row]]}` : ""}`];
  for (const number of new Set([choice.field, part.bar ? forceField : choice.field])) {
    const values = number === stateField ? null : cellular(choice.stage, number, part);
    const { name, unit } = scene.fields[number];
    if (values) lines.push(`${name} ${shown(values[row])}${unit === "-" ? "" : ` ${unit}`}`);
  }
  return lines;
}

// Lines on a point of a trace: its cell, or one beside its edge, and its nearest node.
function words(curve, point, choice) {
  const { owner } = drawn[curve];
  if (owner.held) return nodeWords(owner.held[point], choice);
  const row = Math.floor(point / owner.step);
  if (owner.forces) return nodeWords(owner.forces[row], choice);
  const { corners, cells } = owner.edges || owner.part;
  const node = cells[row * corners + Math.min(point % owner.step, corners - 1)];
  return [...cellWords(owner.part, owner.edges ? owner.edges.beside[row] : row, choice), ...nodeWords(node, choice)];
}
