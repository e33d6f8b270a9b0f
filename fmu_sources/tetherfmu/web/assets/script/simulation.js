// The tethers that fly side by side with the same inputs, what they say, and a finer one beside them.

import { driverOf } from "./drivers.js";
import { Refused, Tether } from "./library.js";
import { Record } from "./record.js";
import { filled, short } from "./text.js";
import { norm, sub } from "./vectors.js";

export const REFERENCE = "reference";
const FINER = 4; // segments of the finer tether for one: of order 2, it is 16 times more exact
const AT_LEAST = 80; // segments of it
const TIGHT = 1e-6; // its relative tolerance
const JUDGED = 10; // seconds over which errors are averaged
const MEASURED = 1.5; // ms that a measurement of the cost takes
const MEASUREMENTS = 7; // of which the cost is the median
const SNAP = 2; // tension over its mean of the last seconds, after slack, that is a snap load ...
const SNAP_WEIGHTS = 5; // ... and weights of the tether that it exceeds that by
const AFTER_SLACK = 1; // s
const MEAN_TIME = 5; // s
const SHOWN_FOR = 5; // s, how long a snap load is shown

/** One tether with what is known of it besides its state. */
class Flown {
  constructor(name, variant) {
    Object.assign(this, { name, variant, refusal: null, costs: [] });
    this.memory = { slackAt: -Infinity, mean: NaN, snap: null };
  }

  get flies() {
    return this.tether !== undefined && this.refusal === null;
  }

  /** Time of a step [ms]: the median of the last measurements, as another program may have interrupted one. */
  get cost() {
    return this.costs.toSorted((a, b) => a - b)[Math.floor(this.costs.length / 2)] ?? NaN;
  }
}

/** Whether two trees have the same keys, with numbers or vectors at their ends; null stands for what is not known yet. */
function haveOneForm(a, b) {
  if (a === null || b === null) return true;
  if (typeof a !== "object" || typeof b !== "object") return Number.isFinite(a) && typeof b === "number";
  const keys = Object.keys({ ...a, ...b });
  return keys.every(
    (key) =>
      (key in a || b[key] === null) &&
      (key in b || Number.isFinite(a[key])) &&
      (!(key in b) || haveOneForm(a[key] ?? null, b[key])),
  );
}

export class Simulation {
  /** settings : see `settings.js`. A tether that is refused says so in its `refusal`. */
  constructor(library, settings) {
    const { declared } = library;
    Object.assign(this, { library, settings, declared, step: settings.step, count: 0 });
    library.clear();
    this.driver = driverOf(settings);
    const wanted = declared.variants.filter((each) => (each.free ? this.driver.free : settings.shown.includes(each.name)));
    this.flown = wanted.map((variant) => this.made(variant.name, variant, settings.values));
    if (settings.reference) this.flown.unshift(this.reference());
    this.master = this.flown.find((each) => each.variant.free);
    this.start();
    this.record = new Record(this.flown.map((each) => each.name));
    this.sample();
  }

  /** Weight of the tether at the start [N]. */
  get weight() {
    const { density, diameter, initial_length, gravity } = this.settings.values;
    return density * (Math.PI / 4) * diameter ** 2 * initial_length * gravity;
  }

  get time() {
    return this.count * this.step;
  }

  made(name, variant, values) {
    const flown = new Flown(name, variant);
    this.attempt(flown, () => (flown.tether = new Tether(this.library, variant, values)));
    return flown;
  }

  reference() {
    const { values } = this.settings;
    const dynamic = this.declared.variants.find((each) => each.waves && !each.free);
    const most = this.declared.parameters.find((each) => each.name === "segments").maximum;
    const segments = Math.min(most, Math.max(AT_LEAST, FINER * values.segments));
    return this.made(REFERENCE, dynamic, { ...values, segments, relative_tolerance: TIGHT, fixed_step: 0 });
  }

  /** Do something with a tether; what it refuses is kept. */
  attempt(flown, action) {
    try {
      action();
    } catch (problem) {
      if (!(problem instanceof Refused)) throw problem;
      flown.refusal = problem.message;
    }
  }

  start() {
    const kite = this.driver.free ? this.driver.start() : null;
    const first = this.driver.inputs(0, kite && { ...kite, tension: 0, length: this.settings.values.initial_length }, 0);
    for (const each of this.flown) {
      if (!each.flies) continue;
      this.give(each, first, true);
      each.tether.give("winch_length", 0); // at the start: initial_length
      this.attempt(each, () => each.tether.start());
    }
  }

  /** Whether an input of the winch has an effect; its speed has one at the start, whatever controls it. */
  controls(name, atStart) {
    const control = this.declared.winch_inputs[name];
    const isStart = atStart && name === "reel_out_speed";
    return control === undefined || control === this.settings.values.winch_control || isStart;
  }

  give({ tether, variant }, given, atStart = false) {
    for (const [name, value] of Object.entries(given)) {
      if (!this.controls(name, atStart)) continue;
      const isOfKite = name === "kite_position" || name === "kite_velocity";
      if (variant.free ? isOfKite && !atStart : name === "kite_load") continue;
      tether.give(name, value);
    }
  }

  /** Motion of the free kite, as its tether gives it; null of a kite that is led. */
  kite() {
    if (!this.master) return null;
    const { tether } = this.master;
    return {
      position: tether.vector("kite_position"),
      velocity: tether.vector("kite_velocity"),
      tension: tether.scalar("ground_tension"),
      length: tether.scalar("tether_length"),
    };
  }

  /** Whether there is anything that can go on. */
  get goesOn() {
    return this.master ? this.master.flies : this.flown.some((each) => each.flies);
  }

  /** One communication step of all tethers.  measured : the tether whose cost is to be measured, or none. */
  advance(measured = null) {
    const given = this.driver.inputs(this.time, this.kite(), this.step);
    this.given = given;
    for (const each of this.flown) {
      if (!each.flies) continue;
      this.give(each, given);
      this.attempt(each, () => {
        if (each === measured) this.measure(each);
        each.tether.advance(this.step);
      });
    }
    this.count += 1;
    this.driver.advance(this.step);
    this.note();
    if (this.record.isDue(this.time)) this.sample();
  }

  /** Time of a step [ms]: the same one again and again, each time from the state of before. */
  measure(each) {
    const { tether } = each;
    const view = (address) => this.library.view(address, tether.sizes.state);
    const began = performance.now();
    let passed = 0,
      count = 0;
    while (passed < MEASURED) {
      tether.advance(this.step);
      view(tether.state).set(view(tether.before));
      count += 1;
      passed = performance.now() - began;
    }
    each.costs = [...each.costs, passed / count].slice(-MEASUREMENTS);
  }

  /** Notice slack and snap loads. */
  note() {
    for (const { flies, tether, memory } of this.flown) {
      if (!flies) continue;
      const tension = tether.scalar("max_tension");
      if (tether.scalar("slack_segments") > 0) memory.slackAt = this.time;
      const since = this.time - memory.slackAt;
      if (since < AFTER_SLACK && tension > SNAP * Math.max(0, memory.mean) + SNAP_WEIGHTS * this.weight) {
        const old = !memory.snap || this.time - memory.snap.time > SHOWN_FOR;
        if (old || tension > memory.snap.tension) memory.snap = { time: this.time, tension };
      }
      const weight = Math.min(1, this.step / MEAN_TIME);
      memory.mean = Number.isNaN(memory.mean) ? tension : memory.mean + weight * (tension - memory.mean);
    }
  }

  sample() {
    const exact = this.flown.find((each) => each.name === REFERENCE && each.flies);
    const of = {};
    for (const { name, flies, tether, variant } of this.flown) {
      if (!flies) continue;
      const force = tether.vector("kite_force");
      of[name] = {
        kite_force: norm(force),
        ground_force: norm(tether.vector("ground_force")),
        max_tension: tether.scalar("max_tension"),
        slack: tether.scalar("slack_segments") / (variant.nodes ? tether.segments : 1),
        error: exact ? norm(sub(force, exact.tether.vector("kite_force"))) : NaN,
      };
    }
    this.record.keep(this.time, of);
  }

  /** Error of the force on the kite over the last seconds, part of the force of the finer tether; NaN if not known. */
  error(name) {
    return this.record.rms(name, "error", JUDGED) / this.record.rms(REFERENCE, "kite_force", JUDGED);
  }

  /** What there is to say of a tether, sentences with their kind: refused, warning, slack, snap, ground, fine. */
  said(flown) {
    if (flown.refusal !== null) return [["refused", flown.refusal]];
    const { tether, variant, memory } = flown;
    const found = [];
    const slack = tether.scalar("slack_segments"),
      lying = tether.scalar("grounded_length");
    if (memory.snap && this.time - memory.snap.time < SHOWN_FOR) {
      found.push(["snap", `snap load of ${short(memory.snap.tension, "N")} at ${memory.snap.time.toFixed(2)} s`]);
    }
    if (slack > 0) found.push(["slack", variant.nodes ? `slack in ${slack} of ${tether.segments} segments` : "slack"]);
    if (lying > 0) found.push(["ground", `${short(lying, "m")} lie on the ground`]);
    for (const warning of tether.warnings()) found.push(["warning", warning]);
    return found.length ? found : [["fine", "taut"]];
  }

  /** A doubt about the parameters, or none. */
  doubt() {
    const { values } = this.settings;
    const isBeyond = ({ name, side, limit }) => values[name] && side * (values[name] - limit) > 0;
    const found = this.declared.sentences.doubts.find(isBeyond);
    return found ? filled(found.sentence, { value: values[found.name] }) : null;
  }

  /** All that is needed to go on from here, for `take`. */
  saved() {
    return {
      count: this.count,
      driver: structuredClone(this.driver.memory),
      tethers: Object.fromEntries(this.flown.filter((each) => each.flies).map((each) => [each.name, each.tether.saved()])),
    };
  }

  /** Go on from what `saved` gave; `Refused` if it belongs to other tethers. */
  take({ count, driver, tethers }) {
    const here = this.driver.memory;
    if (!(Number.isInteger(count) && count >= 0 && haveOneForm(driver, here))) {
      throw new Refused("the saved state is not one of this flight");
    }
    for (const each of this.flown) if (each.tether && tethers[each.name]) each.tether.take(tethers[each.name]);
    this.count = count;
    this.driver.memory = structuredClone(driver);
    for (const each of this.flown) {
      if (tethers[each.name]) each.refusal = null;
      each.memory = { slackAt: -Infinity, mean: NaN, snap: null };
    }
    this.record = new Record(this.flown.map((each) => each.name));
    this.sample();
  }
}
