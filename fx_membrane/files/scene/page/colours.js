// Colours of a field in bands, from its least to its largest value, and their legend.
const BANDS = 16;
const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
const BLUE = "#3b4cc0";
const GREY = "#dddddd";
const RED = "#b40426";

function mixed(one, other, share) {
  const channel = (at) => {
    const [a, b] = [one, other].map((colour) => parseInt(colour.slice(at, at + 2), 16));
    return Math.round(a + (b - a) * share).toString(16).padStart(2, "0");
  };
  return "#" + channel(1) + channel(3) + channel(5);
}

function sequential(share) {
  const place = share * (VIRIDIS.length - 1);
  const first = Math.min(Math.floor(place), VIRIDIS.length - 2);
  return mixed(VIRIDIS[first], VIRIDIS[first + 1], place - first);
}

// Range and colours of a field; where both signs matter, grey is at zero.
function shades(number, stage, common) {
  const field = scene.fields[number];
  if (field.group === "state") return { low: -0.5, high: 2.5, colours: scene.colours.states };
  const entries = (common ? scene.stages : [stage]).map((entry) => entry.fields[number]);
  const known = entries.filter((entry) => entry && entry.least !== null);
  if (!known.length) return { low: 0, high: 1, colours: [scene.colours.fabric] };
  const low = Math.min(...known.map((entry) => entry.least));
  const high = Math.max(...known.map((entry) => entry.largest));
  const most = Math.max(-low, high);
  if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) return { low, high, colours: [sequential(0.5)] };
  const signed = Math.min(-low, high) > 0.02 * most;
  const colours = Array.from({ length: BANDS }, (_, band) => {
    const value = low + ((band + 0.5) / BANDS) * (high - low);
    if (signed) return mixed(GREY, value < 0 ? BLUE : RED, Math.abs(value) / most);
    return sequential(band / (BANDS - 1));
  });
  return { low, high, colours };
}

function scale({ low, high, colours }) {
  const stops = colours.flatMap((colour, band) => [
    [band / colours.length, colour],
    [(band + 1) / colours.length, colour],
  ]);
  const room = high > low ? 0 : Math.abs(high) || 1;
  return { colorscale: stops, cmin: low - room, cmax: high + room };
}

function element(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

function legendOf(number, stage, common) {
  const field = scene.fields[number];
  const entry = stage.fields[number];
  const range = shades(number, stage, common);
  const row = element("div", "row");
  row.append(element("h2", "", field.unit ? `${field.name} [${field.unit}]` : field.name));
  if (field.group === "state") return stateLegend(row, entry);
  const bar = element("div", "bar");
  for (const colour of range.colours) {
    const band = element("span");
    band.style.background = colour;
    bar.append(band);
  }
  const ends = element("div", "ends");
  const mean = (range.low + range.high) / 2;
  const middle = Math.abs(mean) > 1e-9 * (range.high - range.low) ? mean : 0; // else rounding of a zero
  const ticks = range.colours.length > 1 ? [range.low, middle, range.high] : [range.high];
  ends.append(...ticks.map((value) => element("span", "", entry ? shown(value) : "")));
  const scaleBox = element("div", "scale");
  scaleBox.append(bar, ends);
  row.append(scaleBox);
  const words = element("p", "extremes");
  for (const end of ["least", "largest"]) {
    const line = element("span");
    line.append(`${end} `, element("b", end, shown(entry && entry[end])), `, ${(entry && entry[`${end}_at`]) || "no cell"}`);
    words.append(line);
  }
  row.append(words);
  return row;
}

function stateLegend(row, entry) {
  const swatches = element("div", "swatches");
  STATES.forEach((state, number) => {
    const swatch = element("span", "swatch", `${state}: ${entry ? entry.counts[number] : 0} cells`);
    swatch.style.setProperty("--colour", scene.colours.states[number]);
    swatches.append(swatch);
  });
  row.append(swatches);
  return row;
}
