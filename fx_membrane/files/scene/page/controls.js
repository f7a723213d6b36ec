// Controls, keys and pointer.
const SWITCHES = ["mesh", "supports", "loads", "reactions", "axes", "common"];
const control = Object.fromEntries(
  ["stage", "field", "slider", "factor", ...SWITCHES].map((name) => [name, document.getElementById(name)]),
);

function nice(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [5, 2, 1].find((digit) => digit * power <= value);
}

function fill() {
  scene.stages.forEach((stage, number) => control.stage.append(new Option(stage.name, number)));
  const groups = new Map();
  scene.fields.forEach((field, number) => {
    const group = field.group === "state" ? "cells" : field.group;
    if (!groups.has(group)) {
      groups.set(group, document.createElement("optgroup"));
      groups.get(group).label = group;
      control.field.append(groups.get(group));
    }
    groups.get(group).append(new Option(field.unit ? `${field.name} [${field.unit}]` : field.name, number));
  });
  control.slider.max = largestMove > 0 ? Math.max(2, nice((0.3 * size) / largestMove)) : 2;
  control.slider.step = control.slider.max / 200;
  document.getElementById("deformation").hidden = largestMove === 0;
  const triangles = parts.reduce((sum, part) => sum + (part.bar ? 0 : part.cells.length / 3), 0);
  const on = { mesh: triangles > 0 && triangles <= 5000, supports: true, axes: true };
  for (const name of SWITCHES) control[name].checked = Boolean(on[name]);
  control.common.closest("label").hidden = scene.stages.length < 2;
  const forced = (name) => scene.stages.some((stage) => stage[name].nodes);
  for (const name of ["loads", "reactions"]) control[name].closest("label").hidden = !forced(name);
  control.mesh.closest("label").hidden = triangles === 0;
  if (parts.length > 1) fillParts();
}

function fillParts() {
  for (const part of parts) {
    const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: true });
    box.addEventListener("change", () => {
      part.visible = box.checked;
      show();
    });
    const label = element("label");
    label.append(box, ` ${part.name}`);
    document.getElementById("parts").append(label);
  }
}

async function show() {
  for (const name of SWITCHES) choice[name] = control[name].checked;
  control.stage.value = scene.stages.indexOf(choice.stage);
  control.field.value = choice.field;
  control.factor.value = choice.factor;
  control.slider.value = choice.factor;
  document.getElementById("hover").hidden = true;
  showLegend();
  showNotes();
  await draw(choice);
  tell();
}

let waiting = false;

function soon() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    show();
  });
}

function chosen(change) {
  change();
  writeAddress();
  soon();
}

function moved(change) {
  remember();
  change();
  look();
}

function turned(aside, up) {
  const { eye, center } = camera;
  const [x, y, z] = AXES.map((axis) => eye[axis] - center[axis]);
  const around = Math.atan2(y, x) + aside;
  const height = Math.min(Math.max(Math.atan2(z, Math.hypot(x, y)) + up, -1.57), 1.57);
  const way = [Math.cos(height) * Math.cos(around), Math.cos(height) * Math.sin(around), Math.sin(height)];
  camera = { ...camera, eye: from(center, way) };
}

const KEYS = {
  ArrowLeft: () => turned(-0.15, 0),
  ArrowRight: () => turned(0.15, 0),
  ArrowUp: () => turned(0, 0.1),
  ArrowDown: () => turned(0, -0.1),
  "+": () => (zoom *= 1.25),
  "-": () => (zoom *= 0.8),
};

function listen() {
  control.stage.addEventListener("change", () => chosen(() => (choice.stage = scene.stages[control.stage.value])));
  control.field.addEventListener("change", () => chosen(() => (choice.field = Number(control.field.value))));
  for (const name of ["slider", "factor"]) {
    control[name].addEventListener(name === "slider" ? "input" : "change", () =>
      chosen(() => (choice.factor = bounded(Number(control[name].value)))),
    );
  }
  for (const name of SWITCHES) control[name].addEventListener("change", soon);
  for (const button of document.querySelectorAll("button")) {
    const { view, zoom: times } = button.dataset;
    button.addEventListener("click", () => moved(() => (view ? (camera = cameraOf(view)) : (zoom *= Number(times)))));
  }
  document.getElementById("controls").addEventListener("submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", () => {
    readAddress();
    soon();
  });
  figure.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      moved(() => (zoom *= Math.exp(-0.002 * Math.max(-200, Math.min(200, event.deltaY)))));
    },
    { passive: false },
  );
  figure.addEventListener("keydown", (event) => {
    if (!KEYS[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    moved(KEYS[event.key]);
  });
}

// The footer grows and shrinks with its legend, which resizes the picture without a resize of the window.
function listenToSize() {
  new ResizeObserver(async () => {
    document.getElementById("hover").hidden = true;
    remember();
    await Plotly.Plots.resize(figure);
    look();
  }).observe(figure);
}

function listenToPointer() {
  const box = document.getElementById("hover");
  let pointer = { x: 0, y: 0 };
  figure.addEventListener("pointermove", (event) => (pointer = { x: event.clientX, y: event.clientY }), true);
  figure.addEventListener("pointerdown", (event) => (pointer = { x: event.clientX, y: event.clientY }), true);
  const tellPoint = (event) => {
    const { curveNumber, pointNumber } = event.points[0];
    box.textContent = words(curveNumber, pointNumber, choice).join("\n");
    box.hidden = false;
    box.style.left = box.style.top = "0"; // its width is that of its words, not of the room that is left
    box.style.left = `${Math.max(4, Math.min(pointer.x + 14, window.innerWidth - box.offsetWidth - 4))}px`;
    box.style.top = `${Math.max(4, Math.min(pointer.y + 14, window.innerHeight - box.offsetHeight - 4))}px`;
  };
  figure.on("plotly_hover", tellPoint);
  figure.on("plotly_click", tellPoint);
  figure.on("plotly_unhover", () => (box.hidden = true));
  figure.addEventListener("pointerleave", () => (box.hidden = true));
}

fill();
readAddress();
listen();
show().then(() => {
  listenToPointer();
  listenToSize();
});
