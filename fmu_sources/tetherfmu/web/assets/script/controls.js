// Sliders and lists, made from the declarations of the FMU: unit, limits and meaning of each quantity are theirs.

import { hasOwnWind } from "./home.js";
import { problemWith, setDiameter } from "./settings.js";
import { filled, repr, shownUnit, shownValue, words } from "./text.js";

const TICKS = 1000; // of a slider
const GROUPS = [
  // title, records of the parameters, open at first
  ["Tether", "Tether", true],
  ["Air and gravity", "Environment", false],
  ["Ground", "Ground", false],
  ["Winch", "Winch", false],
  ["Solver", "Solver", false],
];

const element = (name, attributes = {}, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
};

/** Place on a slider of a value, and back. */
function scaleOf([low, high, logarithmic], whole) {
  const free = logarithmic
    ? { part: (x) => Math.log(x / low) / Math.log(high / low), value: (p) => low * (high / low) ** p }
    : { part: (x) => (x - low) / (high - low), value: (p) => low + p * (high - low) };
  const rounded = (x) => (whole ? Math.round(x) : Number(x.toPrecision(3)));
  return { part: (x) => Math.min(1, Math.max(0, free.part(x))), value: (p) => rounded(free.value(p)) };
}

/** A slider with a number beside it; changed(value) is called with allowed values. */
function slider(declared, value, ignored, sentences, changed) {
  const id = `q-${declared.name}-${Math.random().toString(36).slice(2, 8)}`;
  const factor = declared.display?.[1] ?? 1;
  const unit = shownUnit(declared);
  const scale = scaleOf(declared.usual, declared.kind === "Integer");
  const problem = element("p", { className: "problem", hidden: true });
  const text = (x) => String(Number(shownValue(declared, x).toPrecision(6)));
  const range = element("input", { type: "range", id, min: 0, max: TICKS, value: Math.round(TICKS * scale.part(value)) });
  const number = element("input", {
    type: "text",
    inputMode: "decimal",
    value: text(value),
    ariaLabel: `${words(declared.name)} [${unit}]`,
  });
  const tell = (sentence) => {
    problem.textContent = sentence ?? "";
    problem.hidden = !sentence;
    number.ariaInvalid = sentence ? "true" : "false";
  };
  range.setAttribute("aria-valuetext", `${text(value)} ${unit}`);
  range.addEventListener("input", () => {
    const next = scale.value(range.value / TICKS);
    number.value = text(next);
    range.setAttribute("aria-valuetext", `${text(next)} ${unit}`);
    tell(null);
    changed(next);
  });
  number.addEventListener("change", () => {
    const next = number.value.trim() === "" ? NaN : Number(number.value.replace(",", ".")) / factor;
    const wrong = problemWith(declared, next);
    const shown = declared.kind === "Integer" && Number.isInteger(next) ? String(next) : repr(next);
    const value = Number.isNaN(next) ? `'${number.value.trim()}'` : shown; // what was typed
    const facts = { name: declared.name, value, range: declared.range };
    tell(wrong && filled(wrong === "whole" ? sentences.not_whole : sentences.out_of_range, facts));
    if (wrong) return;
    range.value = Math.round(TICKS * scale.part(next));
    changed(next);
  });
  const show = (next) => {
    range.value = Math.round(TICKS * scale.part(next));
    number.value = text(next);
    range.setAttribute("aria-valuetext", `${text(next)} ${unit}`);
    tell(null);
  };
  const label = element("label", { htmlFor: id, title: titleOf(declared, ignored) }, words(declared.name));
  if (ignored.length)
    label.append(element("small", {}, `no effect: ${ignored.map((each) => each.replace("Tether", "")).join(", ")}`));
  const shown = element("span", { className: "value" }, number, unit);
  return Object.assign(element("div", { className: "quantity" }, label, range, shown, problem), { show });
}

function titleOf(declared, ignored) {
  const more = ignored.length ? `; ignored by ${ignored.join(", ")}` : "";
  return `${declared.name}: ${declared.meaning}; ${declared.range}${more}`;
}

/** A list of the choices of an enumeration. */
function list(declared, value, ignored, changed) {
  const options = declared.choices
    .map((name, k) => ({ name, number: k + 1, title: declared.meanings[k] }))
    .filter(({ name }) => name);
  const select = element("select", { ariaLabel: words(declared.name) });
  for (const { name, number, title } of options)
    select.append(element("option", { value: number, selected: number === value, title }, words(name)));
  select.addEventListener("change", () => changed(Number(select.value)));
  const label = element("label", { title: titleOf(declared, ignored) }, words(declared.name), select);
  return element("div", { className: "quantity choice" }, label);
}

export class Controls {
  /** place : element of the panel.  changed(restart) : called after a setting was changed. */
  constructor(place, declared, changed) {
    Object.assign(this, {
      place,
      declared,
      changed,
      open: new Set(GROUPS.filter((each) => each[2]).map((each) => each[0])),
    });
    this.open.add("Flight").add("Wind");
  }

  /** Make the panel for settings, which it changes. */
  show(settings) {
    const { declared, place } = this;
    const kind = declared.flights[settings.kind];
    Object.assign(this, { settings, rows: {} });
    place.replaceChildren();
    const parts = new Set(kind.quantities.map((each) => each.group ?? "Flight"));
    for (const part of parts)
      this.group(
        part,
        kind.quantities.filter((each) => (each.group ?? "Flight") === part),
        settings.flight,
        true,
      );
    const hand = this.group(
      "By hand, at once",
      declared.hand.filter((each) => usedByHand(each, settings, declared.winch_inputs.winch_force)),
      settings.hand,
      false,
    );
    if (hand) hand.open = true;
    if (!hasOwnWind(settings)) this.wind(settings);
    for (const [title, record] of GROUPS) {
      this.group(
        title,
        declared.parameters.filter((each) => each.group === record),
        settings.values,
        true,
      );
    }
    if (settings.kind === "free")
      this.group(
        "Kite",
        declared.parameters.filter((each) => each.group === "FreeKite"),
        settings.values,
        true,
      );
  }

  group(title, quantities, values, restart) {
    if (!quantities.length) return null;
    const details = element("details", { open: this.open.has(title) }, element("summary", {}, title));
    details.addEventListener("toggle", () => (details.open ? this.open.add(title) : this.open.delete(title)));
    for (const each of quantities) {
      const ignored = this.ignoring(each.name);
      const set = (value) => {
        if (values === this.settings.values && each.name === "diameter") this.setDiameter(value);
        else values[each.name] = value;
        if (values === this.settings.values) this.settings.own.add(each.name);
        this.changed(restart);
      };
      this.rows[each.name] = each.choices
        ? list(each, values[each.name], ignored, set)
        : slider(each, values[each.name], ignored, this.declared.sentences, set);
      details.append(this.rows[each.name]);
    }
    this.place.append(details);
    return details;
  }

  /** Another diameter [m], and what grows with it, in the settings and on the screen. */
  setDiameter(diameter) {
    const { values, own } = this.settings;
    const before = { ...values };
    setDiameter(values, diameter, own);
    for (const name of Object.keys(before)) if (name !== "diameter" && values[name] !== before[name]) this.rows[name].show(values[name]);
  }

  /** Classes of the variants that ignore a parameter. */
  ignoring(name) {
    return this.declared.variants.filter((each) => name in each.ignored).map((each) => each.class);
  }

  /** Speed and direction of the wind instead of its components, and gusts. */
  wind(settings) {
    const { wind } = settings;
    const polar = {
      speed: Math.hypot(wind.velocity[0], wind.velocity[1]),
      direction: Math.atan2(wind.velocity[1], wind.velocity[0]),
    };
    const declared = this.declared.wind_velocity;
    const details = this.group("Wind", this.declared.wind, wind, false);
    const rows = declared.map((each) =>
      slider(each, polar[each.name], [], this.declared.sentences, (value) => {
        polar[each.name] = value;
        wind.velocity = [polar.speed * Math.cos(polar.direction), polar.speed * Math.sin(polar.direction), wind.velocity[2]];
        this.changed(false);
      }),
    );
    details.querySelector("summary").after(...rows);
  }
}

/** Whether what is set by hand has an effect; byForce : the winch control by force. */
function usedByHand({ name }, { kind, values, flight }, byForce) {
  const ownWinch = kind === "pointer" || kind === "free";
  const steered = kind === "free" && flight.autopilot === 1;
  if (name === "winch_force") return values.winch_control === byForce;
  if (name === "reel_out_speed")
    return ownWinch && values.winch_control !== byForce && !(kind === "free" && flight.autopilot === 3);
  return name === "depower" ? kind === "free" && flight.autopilot !== 3 : steered;
}
