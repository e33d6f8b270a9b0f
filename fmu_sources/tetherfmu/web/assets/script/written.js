// What the page says in words and numbers: commands, the table of the tethers, sentences.

import { buildCommand, hasScene, parametersToSet, sceneFile } from "./home.js";
import { REFERENCE } from "./simulation.js";
import { short } from "./text.js";
import { norm } from "./vectors.js";

const COLUMNS = ["force on the kite", "largest tension", "error", "a step takes", "times real time"];
const BY_HAND = 1; // choice of `autopilot`

const by = (id) => document.getElementById(id);

/** A dot in the colour of a tether. */
function dotOf(colour) {
  const dot = Object.assign(document.createElement("span"), { className: "dot" });
  dot.style.background = colour;
  return dot;
}

/** Write what does not change while a simulation flies; asked(change) : to change its settings and begin anew. */
export function writeSettings(simulation, asked) {
  const { settings, declared } = simulation;
  by("scene").value = settings.scene;
  by("speed").value = settings.speed;
  by("step").value = settings.step;
  by("about").textContent = declared.scenes[settings.scene].about;
  by("steer").hidden = !(settings.kind === "free" && settings.flight.autopilot === BY_HAND);
  const finer = simulation.flown.find((each) => each.name === REFERENCE)?.tether;
  by("finer").textContent = finer ? `${finer.segments} segments, tolerance 1e-6` : "off";
  by("command").textContent = buildCommand(declared, simulation);
  const lines = parametersToSet(declared, simulation);
  by("more").hidden = lines.length === 0;
  by("parameters").textContent = lines.join("\n");
  by("file").hidden = !hasScene(settings);
  by("toml").textContent = hasScene(settings) ? sceneFile(declared, settings) : "";
  writeRows(simulation, asked);
}

/** Rows of the table, one for each tether that could fly. */
function writeRows({ driver, flown, declared }, asked) {
  const body = by("tethers").tBodies[0];
  body.replaceChildren();
  const listed = [
    ...declared.variants.filter((each) => driver.free || !each.free),
    { name: REFERENCE, class: "finer TetherDynamic", colour: declared.colours.reference },
  ];
  for (const { name, class: title, colour, free: isMaster } of listed) {
    const row = body.insertRow();
    row.dataset.tether = name;
    const box = Object.assign(document.createElement("input"), { type: "checkbox", disabled: Boolean(isMaster) });
    box.checked = flown.some((each) => each.name === name);
    box.addEventListener("change", () =>
      asked((settings) => {
        const others = settings.shown.filter((each) => each !== name);
        if (name === REFERENCE) settings.reference = box.checked;
        else settings.shown = box.checked ? [...others, name] : others;
      }),
    );
    const label = document.createElement("label");
    label.append(box, dotOf(colour), title);
    row.insertCell().append(label);
    for (const head of COLUMNS) row.insertCell().dataset.head = head;
  }
}

/** Write what changes while a simulation flies; clock : text.  fps : frames a second. */
export function writeNumbers(simulation, clock, fps, view) {
  by("clock").textContent = clock;
  by("legend").textContent = view.legend(simulation);
  by("frames").textContent = `${fps.toFixed(0)} frames a second.`;
  for (const row of by("tethers").tBodies[0].rows) {
    const each = simulation.flown.find(({ name }) => name === row.dataset.tether);
    numbersOf(simulation, each).forEach((text, k) => (row.cells[k + 1].textContent = text));
  }
  say(sentencesOf(simulation));
}

/** Numbers of a tether for its row, texts. */
function numbersOf(simulation, each) {
  if (!each?.flies) return [each ? "refused" : "", "", "", "", ""];
  const error = each.name === REFERENCE ? NaN : simulation.error(each.name);
  return [
    short(norm(each.tether.vector("kite_force")), "N"),
    short(each.tether.scalar("max_tension"), "N"),
    Number.isFinite(error) ? `${short(100 * error)} %` : "–",
    short(each.cost / 1000, "s"),
    short((1000 * simulation.step) / each.cost),
  ];
}

/** What there is to say: kind, sentence with the names of the tethers that it is about, and their colours. */
function sentencesOf(simulation) {
  const found = new Map();
  const doubt = simulation.doubt();
  if (doubt) found.set(doubt, { kind: "warning", names: [], colours: [] });
  for (const each of simulation.flown) {
    const said = simulation.said(each);
    const sentence = said.map(([, text]) => text).join("; ");
    if (!found.has(sentence)) found.set(sentence, { kind: said[0][0], names: [], colours: [] });
    const isReference = each.name === REFERENCE;
    found.get(sentence).names.push(isReference ? "finer" : each.variant.class);
    found.get(sentence).colours.push(isReference ? simulation.declared.colours.reference : each.variant.colour);
  }
  return [...found].map(([sentence, { kind, names, colours }]) => {
    return { kind, colours, text: names.length ? `${names.join(", ")}: ${sentence}` : sentence };
  });
}

let saidLast = "";

/** Write sentences where they are new; refusals and warnings also for those who hear the page. */
function say(lines) {
  const text = JSON.stringify(lines);
  if (text === saidLast) return;
  saidLast = text;
  const urgent = lines.filter(({ kind }) => kind === "refused" || kind === "warning");
  by("alert").textContent = urgent.map((each) => each.text).join("; ");
  by("said").replaceChildren(
    ...lines.map(({ kind, colours, text: sentence }) => {
      const item = Object.assign(document.createElement("li"), { className: kind });
      item.append(...colours.map(dotOf), sentence);
      return item;
    }),
  );
}
