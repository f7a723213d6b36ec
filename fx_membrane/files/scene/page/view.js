// The picture: axes to one scale, an orthographic camera, and the values under the pointer.
const figure = document.getElementById("figure");
const VIEWS = {
  oblique: { eye: { x: 1.1, y: -1.76, z: 1.21 } },
  plan: { eye: { x: 0, y: -0.002, z: 2.4 } },
  front: { eye: { x: 0, y: -2.4, z: 0 } },
  side: { eye: { x: 2.4, y: 0, z: 0 } },
};
const CONFIG = {
  displaylogo: false,
  scrollZoom: false, // plotly's own zoom of an orthographic camera warns in the console, and forgets itself
  modeBarButtons: [["toImage"]],
  toImageButtonOptions: { filename: "scene" },
};
let zoom = 1;
let drawn = [];
let spans = [1, 1, 1];

// Length of the longest structure that fits at any turn: plotly's orthographic camera sees a height of 2.
function fit() {
  return Math.min(2.1, (1.7 * figure.clientWidth) / Math.max(figure.clientHeight, 1));
}

function aspects() {
  return Object.fromEntries(AXES.map((axis, at) => [axis, (zoom * fit() * spans[at]) / size]));
}

function cameraOf(view) {
  const middle = { x: 0, y: 0, z: 0 };
  return { ...VIEWS[view], center: middle, up: { x: 0, y: 0, z: 1 }, projection: { type: "orthographic" } };
}

let camera = cameraOf("oblique");

// The user turns plotly's own copy of the camera: it is taken over before the next drawing.
function remember() {
  if (figure.layout) camera = figure.layout.scene.camera;
}

function axesOf(traces, visible) {
  const layout = { aspectmode: "manual", dragmode: "turntable", hovermode: "closest", camera };
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
  layout.aspectratio = aspects();
  AXES.forEach((axis, at) => {
    const away = scene.origin[at];
    const beside = away ? ` ${away < 0 ? "−" : "+"} ${Math.abs(away)}` : "";
    layout[`${axis}axis`] = {
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
  return layout;
}

function draw(choice) {
  remember();
  drawn = tracesOf(choice);
  const layout = {
    scene: axesOf(drawn, choice.axes),
    margin: { l: 0, r: 0, t: 0, b: 0 },
    paper_bgcolor: "#ffffff",
    font: { family: "system-ui, 'DejaVu Sans', sans-serif", size: 12, color: scene.colours.ink },
  };
  return Plotly.react(figure, drawn.map(({ trace }) => trace), layout, CONFIG);
}

function look() {
  return Plotly.relayout(figure, { "scene.camera": camera, "scene.aspectratio": aspects() });
}

function place(node) {
  return AXES.map((_, axis) => shown(points[3 * node + axis] + scene.origin[axis])).join(", ");
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
    if (values) lines.push(`${scene.fields[number].name} ${shown(values[row])} ${scene.fields[number].unit}`);
  }
  return lines;
}

// Lines on a point of a trace: its cell and its nearest node.
function words(curve, point, choice) {
  const { owner } = drawn[curve];
  if (owner.held) return nodeWords(owner.held[point], choice);
  const row = Math.floor(point / owner.step);
  if (owner.forces) return nodeWords(owner.forces[row], choice);
  const { corners, cells } = owner.part || owner.edges;
  const node = cells[row * corners + Math.min(point % owner.step, corners - 1)];
  return [...(owner.part ? cellWords(owner.part, row, choice) : []), ...nodeWords(node, choice)];
}
