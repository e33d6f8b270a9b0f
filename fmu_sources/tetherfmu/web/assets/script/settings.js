// What is flown: a scene with what was changed in it, and how that stands in a link.

import { REFERENCE } from "./simulation.js";

const STEPS = { free: 0.005, free_end: 0.01 }; // s, of kinds of flights whose kite is free
const STEP = 0.02; // s, of the others
const QUASI_STEADY_START = 2; // choice of `initial_shape`: a led kite then starts without a jump
const GROUPS = { p: "values", f: "flight", w: "wind", h: "hand" }; // in a link
const SHOWN = ["quasi_steady", "dynamic"]; // unless a link says otherwise

const GROWING = ["axial_stiffness", "axial_damping"]; // with the area of the tether, unless they are set

const startsOf = (quantities) => Object.fromEntries(quantities.map((each) => [each.name, each.start]));

/** Give values of parameters another diameter [m]: stiffness and damping grow with the area, but those that were set. */
export function setDiameter(values, diameter, own) {
  const area = (diameter / values.diameter) ** 2;
  for (const name of GROWING) if (!own.has(name)) values[name] *= area;
  values.diameter = diameter;
}

/** Settings of a scene as it stands in its file. */
export function settingsOf(declared, name) {
  const scene = declared.scenes[name];
  const kind = declared.flights[scene.kind];
  const values = startsOf(declared.parameters);
  if (!kind.free) values.initial_shape = QUASI_STEADY_START;
  const flight = { ...startsOf(kind.quantities), ...scene.flight };
  if (scene.kind === "free_end") values.kite_mass = flight.kite_mass;
  return {
    scene: name,
    kind: scene.kind,
    duration: scene.duration,
    log: scene.log,
    values: { ...values, ...scene.parameters },
    own: new Set(), // parameters that were set here
    flight,
    wind: { ...startsOf(declared.wind), ...scene.wind, velocity: [...(scene.wind.velocity ?? [0, 0, 0])] },
    hand: { ...startsOf(declared.hand) },
    shown: [...SHOWN],
    reference: true,
    step: STEPS[scene.kind] ?? STEP,
    speed: 1,
  };
}

/** What differs from the scene, pairs (key, text): `p.segments`, `f.rate`, `w.velocity`, `show`, `step`, `speed`. */
export function changesOf(declared, settings) {
  const plain = settingsOf(declared, settings.scene);
  const { diameter } = plain.values;
  setDiameter(plain.values, settings.values.diameter, settings.own);
  plain.values.diameter = diameter;
  const found = [["scene", settings.scene]];
  for (const [letter, group] of Object.entries(GROUPS)) {
    for (const [name, value] of Object.entries(settings[group])) {
      if (String(value) !== String(plain[group][name])) found.push([`${letter}.${name}`, String(value)]);
    }
  }
  const shown = [...settings.shown, ...(settings.reference ? [REFERENCE] : [])].join(",");
  if (shown !== [...SHOWN, REFERENCE].join(",")) found.push(["show", shown]);
  for (const name of ["step", "speed"]) if (settings[name] !== plain[name]) found.push([name, String(settings[name])]);
  return found;
}

/** Settings of a link, whose unknown or wrong parts are left out. */
export function settingsFrom(declared, pairs) {
  const given = new Map(pairs);
  const first = Object.keys(declared.scenes)[0];
  const settings = settingsOf(declared, given.get("scene") in declared.scenes ? given.get("scene") : first);
  for (const [key, text] of given) {
    const [letter, name] = key.split(".");
    const group = settings[GROUPS[letter]];
    const value = name === "velocity" ? text.split(",").map(Number) : Number(text);
    const right = Array.isArray(value) ? value.length === 3 && value.every(Number.isFinite) : Number.isFinite(value);
    if (!group || !(name in group) || !right || key === "p.diameter") continue;
    group[name] = value;
    if (letter === "p") settings.own.add(name);
  }
  const diameter = Number(given.get("p.diameter"));
  if (diameter > 0) setDiameter(settings.values, diameter, settings.own);
  for (const name of ["step", "speed"]) if (Number(given.get(name)) > 0) settings[name] = Number(given.get(name));
  if (given.has("show")) {
    const names = given.get("show").split(",");
    settings.shown = declared.variants.map((each) => each.name).filter((each) => names.includes(each));
    settings.reference = names.includes(REFERENCE);
  }
  return settings;
}

/** What is wrong with a value of a declared quantity: "range", "whole", or null if it is allowed. */
export function problemWith(declared, value) {
  const { minimum, maximum } = declared;
  if (!Number.isFinite(value) || (minimum !== null && value < minimum) || (maximum !== null && value > maximum))
    return "range";
  return declared.kind === "Integer" && !Number.isInteger(value) ? "whole" : null;
}
