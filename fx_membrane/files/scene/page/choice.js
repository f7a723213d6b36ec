// The choice of the user: stage, field and factor of the displacements, also in the address of the page.
const FAR = 1e4; // displacements drawn larger than this multiple of the structure have no visible shape
const ROUNDING = 1e-9; // share of the structure below which displacements are rounding
const largestMove = moveOf(scene.stages);
const choice = { stage: scene.stages[0], field: firstField(scene.stages[0]), factor: 1 };

// The displacement, or without one the first field that differs from cell to cell, as the stress of a prestress.
function firstField(stage) {
  if (moveOf([stage]) > 0) return 0;
  const differs = ({ group }, at) => group !== "nodes" && group !== "state" && stage.fields[at]?.least < stage.fields[at]?.largest;
  return Math.max(0, scene.fields.findIndex(differs));
}

function moveOf(stages) {
  let most = 0;
  for (const stage of stages) {
    for (const x of stage.displacement ? numbers(stage.displacement, "f4") : []) most = Math.max(most, Math.abs(x));
  }
  return most > ROUNDING * size ? most : 0;
}

function numberOf(entries, given, otherwise) {
  const named = entries.findIndex((entry) => entry.name === given);
  if (named >= 0) return named;
  return /^\d+$/.test(given || "") && Number(given) < entries.length ? Number(given) : otherwise;
}

function readAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  choice.stage = scene.stages[numberOf(scene.stages, given.get("stage"), scene.stages.indexOf(choice.stage))];
  choice.field = numberOf(scene.fields, given.get("field"), choice.field);
  choice.factor = bounded(given.has("scale") ? Number(given.get("scale")) : choice.factor);
}

function writeAddress() {
  const kept = { stage: choice.stage.name, field: scene.fields[choice.field].name };
  if (largestMove > 0) kept.scale = choice.factor;
  history.replaceState(null, "", `#${new URLSearchParams(kept)}`);
}

function bounded(factor) {
  const most = largestMove > 0 ? (FAR * size) / largestMove : 1;
  return Number.isFinite(factor) ? Math.min(Math.max(factor, -most), most) : 1;
}
