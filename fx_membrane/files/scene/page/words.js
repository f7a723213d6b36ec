// Words beside the picture: legends, notes and remarks, and data for scripts.
function showLegend() {
  const legend = document.getElementById("legend");
  legend.replaceChildren(legendOf(choice.field, choice.stage, choice.common));
  const group = scene.fields[choice.field].group;
  if (group === "membranes" && forceField >= 0) legend.append(legendOf(forceField, choice.stage, choice.common));
}

function showNotes() {
  const notes = [];
  const states = stateField >= 0 && choice.stage.fields[stateField];
  if (states && choice.field !== stateField) {
    const loose = STATES.map((state, number) => [state, states.counts[number]]).slice(1).filter(([, count]) => count);
    const told = loose.map(([state, count]) => `${count} cells ${state}`).join(", ");
    notes.push(told ? `${told}.` : "All cells are taut.");
  }
  for (const name of ["loads", "reactions"]) {
    if (choice[name] && choice.stage[name].of > 1) notes.push(`One in ${choice.stage[name].of} of the ${name} is drawn.`);
  }
  notes.push(...choice.stage.notes);
  if (scene.coarse) notes.push(scene.coarse);
  document.getElementById("notes").textContent = notes.join(" ");
  const remarks = document.getElementById("remarks");
  const count = choice.stage.remarks.length;
  remarks.hidden = !count;
  remarks.querySelector("summary").textContent = `Read first: ${count} remark${count === 1 ? "" : "s"} on this stage`;
  remarks.querySelector("ul").replaceChildren(...choice.stage.remarks.map((remark) => element("li", "", remark)));
}

// For scripts and tests: what is shown, and the least and largest of the values that are drawn.
function tell() {
  const entry = choice.stage.fields[choice.field] || {};
  const told = { stage: choice.stage.name, field: scene.fields[choice.field].name, scale: choice.factor };
  Object.assign(told, { least: entry.least ?? null, largest: entry.largest ?? null });
  let [least, largest] = [Infinity, -Infinity];
  for (const { found } of drawn) {
    for (const value of found && found.number === choice.field ? found.values : []) {
      if (value < least) least = value;
      if (value > largest) largest = value;
    }
  }
  document.body.dataset.shown = JSON.stringify({ ...told, drawn: least <= largest ? [least, largest] : null });
}
