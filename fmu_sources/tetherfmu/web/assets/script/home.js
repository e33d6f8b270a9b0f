// Take it home: the command and the files that make the FMUs of what is on the screen.

import { REFERENCE } from "./simulation.js";
import { repr } from "./text.js";

const DIAMETER_SCALES = ["axial_stiffness", "axial_damping"]; // grow with its square in `tetherfmu build --diameter`
const SECTIONS = { Tether: "tether", Environment: "environment", Ground: "ground" }; // of a scene file
const OF_THE_PAGE = ["pointer", "free"]; // kinds of flights that no scene file has

const number = (declared, value) => (declared.kind === "Real" ? repr(value) : String(value));

/** Start values of a parameter in an FMU built with `--diameter`. */
function builtWith(declared, values) {
  const starts = Object.fromEntries(declared.parameters.map((each) => [each.name, each.start]));
  const area = (values.diameter / starts.diameter) ** 2;
  for (const name of DIAMETER_SCALES) starts[name] *= area;
  return { ...starts, segments: values.segments, diameter: values.diameter };
}

/** The command that builds the FMUs of the tethers on the screen. */
export function buildCommand(declared, simulation) {
  const { values } = simulation.settings;
  const names = simulation.flown.filter((each) => each.name !== REFERENCE).map((each) => each.variant.class);
  const plain = Object.fromEntries(declared.parameters.map((each) => [each.name, each]));
  const options = ["segments", "diameter"]
    .filter((name) => values[name] !== plain[name].start)
    .map((name) => `--${name} ${number(plain[name], values[name])}`);
  return ["tetherfmu build", ...names, ...options].join(" ");
}

/** Parameters that the FMUs then need besides their start values, lines "name = value". */
export function parametersToSet(declared, simulation) {
  const { values, kind } = simulation.settings;
  const starts = builtWith(declared, values);
  const same = (a, b) => Math.abs(a - b) <= 1e-12 * Math.abs(b);
  const free = simulation.driver.free;
  const lines = declared.parameters
    .filter((each) => (each.group !== "FreeKite" || free) && !same(values[each.name], starts[each.name]))
    .map(
      (each) =>
        `${each.name} = ${number(each, values[each.name])}${each.choices ? `  # ${each.choices[values[each.name] - 1]}` : ""}`,
    );
  if (free) {
    const { position, velocity } = simulation.driver.start();
    for (const [name, vector] of [
      ["position", position],
      ["velocity", velocity],
    ]) {
      vector.forEach((each, i) => lines.push(`initial_kite_${name}[${i + 1}] = ${repr(each)}`));
    }
  } else if (kind !== "pointer") {
    const { kite_position: first, kite_velocity: rate } = simulation.driver.inputs(0);
    const vector = (numbers) => `[${numbers.map((each) => repr(Number(each.toFixed(9)))).join(", ")}]`;
    lines.push("# inputs at the start:", `# kite_position = ${vector(first)}`, `# kite_velocity = ${vector(rate)}`);
  }
  return lines;
}

/** Whether there is a scene file of what is on the screen. */
export const hasScene = (settings) => !OF_THE_PAGE.includes(settings.kind);

/** Whether the wind is that of a log. */
export const hasOwnWind = ({ log }) => Boolean(log?.split("\n", 1)[0].includes("wind_velocity"));

/** Text of the scene file (TOML) of what is on the screen. */
export function sceneFile(declared, settings) {
  const { kind, values, flight, wind, duration, scene } = settings;
  const { about, file } = declared.scenes[scene];
  const lines = [`# ${about}`, "# From the page that tetherfmu web writes.", `duration = ${repr(duration)}`, "", "[flight]"];
  lines.push(...(file ? ['kind = "series"', `file = ${JSON.stringify(file)}`] : [`kind = "${kind}"`]));
  for (const each of declared.flights[kind].quantities) lines.push(`${each.name} = ${number(each, flight[each.name])}`);
  for (const [group, section] of Object.entries(SECTIONS)) {
    const changed = declared.parameters.filter(
      (each) =>
        each.group === group &&
        each.name !== "segments" &&
        (each.name === "initial_length" || values[each.name] !== each.start),
    );
    const listed = section === "ground" && values.ground_contact === 1 ? [] : changed;
    if (listed.length) lines.push("", `[${section}]`);
    for (const each of listed) {
      const key = section === "ground" ? each.name.slice("ground_".length) : each.name;
      lines.push(
        each.choices ? `${key} = "${each.choices[values[each.name] - 1]}"` : `${key} = ${number(each, values[each.name])}`,
      );
    }
  }
  if (!hasOwnWind(settings)) {
    lines.push("", "[wind]", `velocity = [${wind.velocity.map(repr).join(", ")}]`);
    for (const each of declared.wind)
      if (wind[each.name] !== each.start) lines.push(`${each.name} = ${repr(wind[each.name])}`);
  }
  lines.push("", "[wanted]", 'outputs = ["kite_force"]', "allowed_error = 0.05", "");
  return lines.join("\n");
}
