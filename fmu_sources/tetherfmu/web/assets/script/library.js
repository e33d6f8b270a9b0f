// The kernels: one WebAssembly file for all variants, and tethers that run in its memory.

import { filled } from "./text.js";

const PAGE = 65536; // bytes, by which a memory of WebAssembly grows
const FIRST_PAGES = 64;
const ALIGNED = 16; // bytes, for two lanes

/** The kernels of a WebAssembly file (bytes). */
export async function libraryOf(bytes, declared) {
  const memory = new WebAssembly.Memory({ initial: FIRST_PAGES });
  const { instance } = await WebAssembly.instantiate(bytes, { env: { memory, ...mathematics() } });
  return new Library(instance.exports, memory, declared);
}

/** The functions of a real number that the kernels take from JavaScript. */
function mathematics() {
  const { pow, log, exp, atan2, sinh, asinh, log1p } = Math;
  return { pow, log, exp, atan2, sinh, asinh, log1p };
}

const aligned = (address) => Math.ceil(address / ALIGNED) * ALIGNED;

/** Entry points and the memory that all tethers share; arrays are handed out one behind the other. */
export class Library {
  constructor(exports, memory, declared) {
    this.exports = exports;
    this.memory = memory;
    this.declared = declared;
    this.first = aligned(exports.__heap_base.value);
    this.clear();
  }

  /** Take all arrays back. */
  clear() {
    this.next = this.first;
    this.numbers = new Float64Array(this.memory.buffer);
  }

  /** Address of a new array of so many zeros. */
  array(count) {
    const address = this.next;
    this.next = aligned(this.next + 8 * count);
    const missing = this.next - this.memory.buffer.byteLength;
    if (missing > 0) this.memory.grow(Math.ceil(missing / PAGE));
    this.numbers = new Float64Array(this.memory.buffer);
    this.numbers.fill(0, address / 8, address / 8 + count);
    return address;
  }

  /** View of an array, which holds until the next one is made. */
  view(address, count) {
    return this.numbers.subarray(address / 8, address / 8 + count);
  }
}

/** A refusal; the message is the sentence of an FMU. */
export class Refused extends Error {}

/** One tether: its arrays, its start and its steps, as `runtime/instance.py`. */
export class Tether {
  /** values : parameters by name.  `Refused` says which is not allowed. */
  constructor(library, variant, values) {
    const { arrays, parameters } = library.declared;
    Object.assign(this, { library, variant, arrays });
    this.entry = (verb) => library.exports[`${variant.library}_${verb}`];
    const known = parameters.filter((each) => each.group !== "FreeKite" || variant.free);
    const numbers = known.map((each) => values[each.name] ?? each.start);
    const quantities = library.array(numbers.length);
    library.view(quantities, numbers.length).set(numbers);
    const segments = this.entry("segments")(1n, quantities);
    this.segments = Number(segments);
    this.points = variant.nodes ? this.segments + 1 : 33;
    this.plan = library.array(arrays.PLAN_SIZE);
    const plan = new BigInt64Array(library.memory.buffer, this.plan, arrays.PLAN_SIZE);
    const given = { LINES: 1n, SEGMENTS: segments, START_POINT: -1n, END_POINT: -1n, SHAPE_POINTS: BigInt(this.points) };
    for (const [name, number] of Object.entries(given)) plan[arrays.PLAN[name]] = number;
    this.entry("complete")(this.plan);
    const size = (name) => Number(plan[arrays.PLAN[`${name}_SIZE`]]);
    this.sizes = { parameters: size("PARAMETERS"), state: size("STATE"), outputs: size("OUTPUTS"), work: size("WORK") };
    this.parameters = library.array(this.sizes.parameters);
    const status = this.entry("pack")(1n, variant.free ? 1n : 0n, quantities, 0, this.parameters);
    if (status !== 0) throw new Refused(this.sentenceOfParameters(status, known, numbers));
    this.inputs = library.array(arrays.INPUTS);
    this.state = library.array(this.sizes.state);
    this.before = library.array(this.sizes.state);
    this.outputs = library.array(this.sizes.outputs);
    this.work = library.array(this.sizes.work);
    this.places = Object.fromEntries(library.declared.inputs.map((each) => [each.name, each.place]));
    this.at = Object.fromEntries(library.declared.outputs.map((each) => [each.name, each.place]));
    for (const each of library.declared.inputs) this.give(each.name, each.start);
  }

  /** Set an input, a number or three. */
  give(name, value) {
    const { numbers } = this.library;
    const place = this.inputs / 8 + this.places[name];
    if (typeof value === "number") numbers[place] = value;
    else for (let i = 0; i < value.length; i++) numbers[place + i] = value[i];
  }

  /** Find the first shape; `Refused` says why there is none. */
  start() {
    const status = this.entry("initialize")(
      this.plan,
      this.parameters,
      this.inputs,
      this.state,
      this.outputs,
      this.work,
    );
    if (status !== 0) throw new Refused(this.sentence(status, 0));
  }

  /** Do a communication step [s]; `Refused` says why it cannot be done, and the tether is as it was. */
  advance(step) {
    this.advanceEntry ??= this.entry("advance");
    const status = this.advanceEntry(
      this.plan,
      this.parameters,
      this.inputs,
      step,
      this.state,
      this.before,
      this.outputs,
      this.work,
    );
    if (status !== 0) throw new Refused(this.sentence(status, step));
  }

  /** An output that is a number. */
  scalar(name) {
    return this.library.numbers[this.outputs / 8 + this.at[name]];
  }

  /** An output that is a vector. */
  vector(name) {
    const place = this.outputs / 8 + this.at[name];
    return Array.from(this.library.numbers.subarray(place, place + 3));
  }

  /** Points of the shape, view (points x 3). */
  shape() {
    return this.library.view(this.outputs + 8 * this.arrays.SHAPE, 3 * this.points);
  }

  /** State and outputs for `take`. */
  saved() {
    return [this.state, this.outputs].map((address, k) =>
      Array.from(this.library.view(address, k ? this.sizes.outputs : this.sizes.state)),
    );
  }

  /** Continue from what `saved` gave, bit for bit. */
  take([state, outputs]) {
    if (state.length !== this.sizes.state || outputs.length !== this.sizes.outputs) {
      throw new Refused("the saved state is not one of this tether");
    }
    this.library.view(this.state, state.length).set(state);
    this.library.view(this.outputs, outputs.length).set(outputs);
  }

  /** Sentences on what has been implausible since the start. */
  warnings() {
    const { numbers, declared } = this.library;
    const place = this.state / 8;
    const kinds = numbers[place + this.arrays.WARNINGS];
    if (!kinds) return [];
    return declared.sentences.warnings.flatMap(({ sentence, facts }, kind) => {
      if (Math.floor(kinds / 2 ** kind) % 2 === 0) return [];
      const value = numbers[place + this.arrays.WARNED_VALUES + kind];
      const [segment, time] = [numbers[place + this.arrays.TORN_SEGMENT], numbers[place + this.arrays.TORN_AT]];
      return [filled(sentence, { ...facts, value, percent: 100 * value, strain: 100 * (value - 1), segment, time })];
    });
  }

  /** What a status says of a step [s] with the inputs of now. */
  sentence(status, step) {
    const { numbers, declared } = this.library;
    const input = (name, i = 0) => numbers[this.inputs / 8 + this.places[name] + i];
    const parameter = (name) => numbers[this.parameters / 8 + this.arrays[name]];
    const place = status >> 8;
    const named = declared.inputs.findLast((each) => each.place <= place);
    const longest = parameter("LONGEST_LENGTH");
    const ends = [0, 1, 2].map((i) => input("kite_position", i) - input("ground_position", i));
    return filled(declared.sentences.status[status & 0xff], {
      ...declared.sentences.limits,
      most: String(declared.sentences.limits.most),
      step,
      name: named.start.length > 1 ? `${named.name}[${place - named.place + 1}]` : named.name,
      value: numbers[this.inputs / 8 + place],
      reel_out_speed: input("reel_out_speed"),
      winch_force: input("winch_force"),
      winch_length: input("winch_length"),
      friction: parameter("WINCH_FRICTION"),
      shortest_stop: parameter("SHORTEST_LENGTH"),
      least_length: parameter("LEAST_LENGTH"),
      longest_stop: longest === this.arrays.NO_STOP ? Infinity : longest,
      length: numbers[this.state / 8 + this.arrays.LENGTH],
      distance: Math.hypot(...ends),
      relative_tolerance: parameter("RELATIVE_TOLERANCE"),
      fixed_step: parameter("FIXED_STEP"),
      budget: String(Math.floor(this.arrays.ITERATION_BUDGET / this.segments)),
    });
  }

  /** What a status says of parameters. */
  sentenceOfParameters(status, known, numbers) {
    const { sentences } = this.library.declared;
    const place = status >> 8;
    const value = (name) => numbers[known.findIndex((each) => each.name === name)];
    const whole = (x) => (Number.isInteger(x) ? String(x) : x);
    const segments = whole(value("segments"));
    return filled(sentences.status[status & 0xff], {
      ...sentences.limits,
      most: String(sentences.limits.most),
      name: known[place].name,
      value: known[place].kind === "Real" ? numbers[place] : whole(numbers[place]),
      range: known[place].range,
      roughness: value("surface_roughness"),
      height: value("wind_reference_height"),
      shortest_stop: value("shortest_length"),
      longest_stop: value("longest_length"),
      length: value("initial_length"),
      segments,
      in_all: segments,
    });
  }
}
