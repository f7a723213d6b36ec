// Traces of plotly: a mesh or lines for each part, edges, supports and arrows. Each corner of a cell has a point of its
// own, so that the point under the pointer tells the cell and the node.
const ARROW = 0.12; // length of the largest, of the size of the structure
const EVEN = { ambient: 0.95, diffuse: 0.25, specular: 0.05, roughness: 0.9, fresnel: 0.05 };

function cornersOf(part, at, gaps) {
  const step = part.corners + (gaps ? 1 : 0);
  const rows = (part.cells.length / part.corners) * step;
  const xyz = AXES.map(() => new Float64Array(rows).fill(NaN));
  for (let c = 0; c < part.cells.length; c++) {
    const row = Math.floor(c / part.corners) * step + (c % part.corners);
    for (let axis = 0; axis < 3; axis++) xyz[axis][row] = at[3 * part.cells[c] + axis];
  }
  return { x: xyz[0], y: xyz[1], z: xyz[2] };
}

// Values at the points of a part, and the number of their field; null where it has none.
function valuesOf(part, choice, gaps) {
  const field = scene.fields[choice.field];
  const step = part.corners + (gaps ? 1 : 0);
  const rows = (part.cells.length / part.corners) * step;
  if (field.group === "nodes") {
    const at = nodal(choice.stage, field);
    const corner = (row) => Math.floor(row / step) * part.corners + Math.min(row % step, part.corners - 1);
    return { number: choice.field, values: Float32Array.from({ length: rows }, (_, row) => at[part.cells[corner(row)]]) };
  }
  for (const number of part.bar ? [choice.field, forceField] : [choice.field]) {
    const cells = cellular(choice.stage, number, part);
    if (cells) return { number, values: Float32Array.from({ length: rows }, (_, row) => cells[Math.floor(row / step)]) };
  }
  return null;
}

function meshOf(part, at, choice) {
  const found = valuesOf(part, choice, false);
  const count = part.cells.length / 3;
  const corner = (first) => Int32Array.from({ length: count }, (_, cell) => 3 * cell + first);
  const look = { flatshading: true, lighting: EVEN, lightposition: { x: 1e3, y: -2e3, z: 5e3 } };
  // Without values all are zero, in one colour: plotly would keep the colours of the picture before.
  const none = { low: 0, high: 0, colours: [scene.colours.fabric] };
  const intensity = found ? found.values : new Float32Array(part.cells.length);
  const range = scale(found ? shades(found.number, choice.stage, choice.common) : none);
  const colour = { intensity, showscale: false, ...range };
  const trace = { type: "mesh3d", ...cornersOf(part, at, false), i: corner(0), j: corner(1), k: corner(2) };
  return { trace: { ...trace, ...look, ...colour }, owner: { part, step: 3 }, found };
}

function linesOf(part, at, choice) {
  const found = valuesOf(part, choice, true);
  const plain = part.kind === "mast" ? scene.colours.mast : scene.colours.ink;
  const range = found && scale(shades(found.number, choice.stage, choice.common));
  const line = found ? { color: found.values, showscale: false, ...range } : { color: plain };
  line.width = part.kind === "mast" ? 9 : 5;
  return { trace: { type: "scatter3d", mode: "lines", ...cornersOf(part, at, true), line }, owner: { part, step: 3 }, found };
}

const edgeCells = new Map();

function edgesOf(part, at) {
  if (!edgeCells.has(part)) {
    const seen = new Set();
    const rows = [];
    const beside = []; // a cell that has the edge
    for (let c = 0; c < part.cells.length; c += 3) {
      for (let side = 0; side < 3; side++) {
        const [a, b] = [part.cells[c + side], part.cells[c + ((side + 1) % 3)]].sort((m, n) => m - n);
        if (seen.has(a * nodes.length + b)) continue;
        seen.add(a * nodes.length + b);
        rows.push(a, b);
        beside.push(c / 3);
      }
    }
    edgeCells.set(part, { corners: 2, cells: Int32Array.from(rows), beside });
  }
  const edges = edgeCells.get(part);
  const line = { color: "#5a6772", width: 1 };
  return { trace: { type: "scatter3d", mode: "lines", ...cornersOf(edges, at, true), line }, owner: { part, edges, step: 3 } };
}

// Directions in which all nodes are held, as those across a strip, have no marks: they would hide its colours.
function supportsOf(at) {
  const everywhere = supports.reduce((all, held) => all & held, 7);
  const held = Int32Array.from(nodes.keys()).filter((node) => supports[node] & ~everywhere);
  const xyz = AXES.map((_, axis) => Float64Array.from(held, (node) => at[3 * node + axis]));
  const width = held.length > 500 ? 1.5 : held.length > 50 ? 2 : 3.5;
  const marker = { color: scene.colours.ink, size: width, symbol: Array.from(held, (n) => (supports[n] === 7 ? "square" : "diamond")) };
  const trace = { type: "scatter3d", mode: "markers", x: xyz[0], y: xyz[1], z: xyz[2], marker };
  return { trace, owner: { held } };
}

// Arrows that end at their nodes, each of a shaft and two barbs.
function arrowsOf(forces, at, colour) {
  const where = numbers(forces.nodes, "i4");
  const vectors = numbers(forces.vectors, "f4");
  let most = 0;
  for (let row = 0; row < where.length; row++) most = Math.max(most, Math.hypot(...vectors.subarray(3 * row, 3 * row + 3)));
  const xyz = [[], [], []];
  const draw = (from, to) => AXES.forEach((_, axis) => xyz[axis].push(from[axis], to[axis], NaN));
  for (let row = 0; row < where.length; row++) {
    const tip = at.subarray(3 * where[row], 3 * where[row] + 3);
    const way = Array.from(vectors.subarray(3 * row, 3 * row + 3), (f) => (f / most) * ARROW * size);
    const long = Math.hypot(...way);
    const across = Math.hypot(way[0], way[1]) > 0.01 * long ? [-way[1], way[0], 0] : [long, 0, 0];
    const wide = Math.hypot(...across);
    const back = (share, aside) => AXES.map((_, axis) => tip[axis] - share * way[axis] + (aside * long * across[axis]) / wide);
    draw(back(1, 0), tip);
    draw(back(0.3, 0.12), tip);
    draw(back(0.3, -0.12), tip);
  }
  return {
    trace: { type: "scatter3d", mode: "lines", x: xyz[0], y: xyz[1], z: xyz[2], line: { color: colour, width: 3 } },
    owner: { forces: where, vectors, step: 9 },
  };
}

// Each trace keeps its name over all pictures, so that plotly never updates one with the data of another. It must be fit
// for a selector of CSS.
function tracesOf(choice) {
  const at = positions(choice.stage, choice.factor);
  const drawn = [];
  const add = (uid, made) => {
    Object.assign(made.trace, { uid, hoverinfo: "none", showlegend: false });
    drawn.push(made);
  };
  parts.forEach((part, number) => {
    if (part.visible) add(`part-${number}`, part.bar ? linesOf(part, at, choice) : meshOf(part, at, choice));
    if (part.visible && choice.mesh && !part.bar) add(`edges-${number}`, edgesOf(part, at));
  });
  if (choice.supports) add("supports", supportsOf(at));
  if (choice.loads) add("loads", arrowsOf(choice.stage.loads, at, "#c2571a"));
  if (choice.reactions) add("reactions", arrowsOf(choice.stage.reactions, at, "#2563ad"));
  return drawn;
}
