// Numbers and sentences as Python writes them, so that the page says what an FMU says.

/** A float as Python's repr: "1.0", "1e-05". */
export function repr(x) {
  if (!Number.isFinite(x)) return Number.isNaN(x) ? "nan" : x > 0 ? "inf" : "-inf";
  const size = Math.abs(x);
  if (size !== 0 && (size < 1e-4 || size >= 1e16)) return exponential(x.toExponential());
  return Number.isInteger(x) ? x.toFixed(1) : String(x);
}

/** A number in Python's format "g" with so many digits. */
export function general(x, digits = 6) {
  if (!Number.isFinite(x)) return repr(x);
  if (x === 0) return "0";
  const text = x.toExponential(digits - 1);
  const power = Number(text.slice(text.indexOf("e") + 1));
  if (power < -4 || power >= digits) return exponential(text.replace(/\.?0*e/, "e"));
  const fixed = x.toFixed(Math.max(0, digits - 1 - power));
  return fixed.includes(".") ? fixed.replace(/\.?0+$/, "") : fixed;
}

function exponential(text) {
  return text.replace(/e([+-])(\d)$/, "e$10$2");
}

function formatted(value, spec) {
  if (typeof value === "string") return value;
  const [, digits, kind] = /^(?:\.(\d+))?([a-z])?$/.exec(spec ?? "") ?? [];
  if (kind === "g") return general(value, digits === undefined ? 6 : Number(digits));
  if (kind === "f") return value.toFixed(Number(digits ?? 6));
  if (kind === "e") return exponential(value.toExponential(Number(digits ?? 6)));
  return repr(value);
}

/** A sentence of the declarations with its facts; a fact that is a string stands as it is. */
export function filled(sentence, facts) {
  return sentence.replace(/\{(\w+)(?:!r)?(?::([^}]*))?\}/g, (_, name, spec) => formatted(facts[name], spec));
}

const PREFIXES = [
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
];

/** A number for people: three digits and a prefix of its unit; SI prefixes only where the unit takes one. */
export function short(x, unit = "") {
  if (!Number.isFinite(x)) return "–";
  const space = unit ? " " : "";
  if (x === 0) return `0${space}${unit}`;
  if (!["N", "s", "W", "Pa"].includes(unit)) return `${digitsOf(x)}${space}${unit}`;
  const [factor, prefix] = PREFIXES.find(([each]) => Math.abs(x) >= each) ?? PREFIXES.at(-1);
  return `${digitsOf(x / factor)} ${prefix}${unit}`;
}

function digitsOf(x) {
  const size = Math.abs(x);
  if (size >= 1e6 || size < 1e-4) return x.toExponential(1).replace("e+", "e");
  return size >= 100 ? x.toFixed(0) : String(Number(x.toPrecision(3)));
}

/** A value of a declared quantity in the unit that people read. */
export function shownValue(declared, value) {
  return value * (declared.display?.[1] ?? 1);
}

/** The unit that people read. */
export function shownUnit(declared) {
  return declared.display?.[0] ?? declared.unit;
}

/** A name of a variable as words: "kite_mass" is "kite mass". */
export function words(name) {
  return name.replaceAll("_", " ");
}
