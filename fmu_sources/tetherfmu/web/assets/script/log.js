// A flight from a CSV file, made smooth as `files/series.py` does: C2 splines of positions, monotonic others.

import { Refused } from "./library.js";

const ENDS = ["kite", "ground"];
const vectorOf = (name) => [1, 2, 3].map((i) => `${name}[${i}]`);
const VECTORS = ["kite_position", "kite_velocity", "ground_position", "ground_velocity", "wind_velocity"];
const COLUMNS = ["time", ...VECTORS.flatMap(vectorOf), "reel_out_speed"];
const FEWEST_ROWS = 4; // that a C2 spline needs

/** Columns of a CSV file with a header row, numbers by name; `Refused` says what is wrong with it. */
export function columnsOf(text) {
  const [head, ...rows] = text
    .trim()
    .split(/\r?\n/)
    .map((line) => line.split(",").map((each) => each.trim()));
  for (const name of head) {
    if (!COLUMNS.includes(name)) throw new Refused(`unknown column '${name.slice(0, 40)}'; known are ${COLUMNS.join(", ")}`);
  }
  const columns = Object.fromEntries(head.map((name, k) => [name, rows.map((row) => Number(row[k] === "" ? NaN : row[k]))]));
  const given = VECTORS.filter((name) => name === "kite_position" || head.some((each) => each.startsWith(`${name}[`)));
  const missing = ["time", ...given.flatMap(vectorOf)].find((name) => !(name in columns));
  if (missing) throw new Refused(`the column ${missing} is missing`);
  for (const [name, values] of Object.entries(columns)) {
    const k = values.findIndex((each) => !Number.isFinite(each));
    if (k >= 0) throw new Refused(`row ${k + 2}, column ${name} has no number; it must be a finite number`);
  }
  if (rows.length < FEWEST_ROWS) throw new Refused(`has ${rows.length} rows; it must have at least ${FEWEST_ROWS}`);
  const k = columns.time.findIndex((time, i) => i > 0 && time <= columns.time[i - 1]);
  if (k > 0) throw new Refused(`row ${k + 2}: time must grow from row to row`);
  columns.time = columns.time.map((each, _, all) => each - all[0]);
  return columns;
}

/** Slopes of a C2 spline through values, whose third derivative does not jump at the second and the last but one. */
function smoothSlopes(x, y) {
  const n = x.length;
  const h = x.slice(1).map((each, k) => each - x[k]);
  const s = h.map((each, k) => (y[k + 1] - y[k]) / each);
  const [first, last] = [x[2] - x[0], x[n - 1] - x[n - 3]];
  const rows = y.map((_, k) => [h[k], 2 * (h[k - 1] + h[k]), h[k - 1], 3 * (h[k] * s[k - 1] + h[k - 1] * s[k])]);
  rows[0] = [0, h[1], first, ((h[0] + 2 * first) * h[1] * s[0] + h[0] ** 2 * s[1]) / first];
  rows[n - 1] = [last, h[n - 3], 0, (h[n - 2] ** 2 * s[n - 3] + (2 * last + h[n - 2]) * h[n - 3] * s[n - 2]) / last];
  for (let k = 1; k < n; k++) {
    const factor = rows[k][0] / rows[k - 1][1];
    rows[k][1] -= factor * rows[k - 1][2];
    rows[k][3] -= factor * rows[k - 1][3];
  }
  const slopes = Array(n);
  for (let k = n - 1; k >= 0; k--) slopes[k] = (rows[k][3] - (k < n - 1 ? rows[k][2] * slopes[k + 1] : 0)) / rows[k][1];
  return slopes;
}

/** Slopes of a spline that is monotonic where the values are (PCHIP). */
function monotonicSlopes(x, y) {
  const n = x.length;
  const h = x.slice(1).map((each, k) => each - x[k]);
  const s = h.map((each, k) => (y[k + 1] - y[k]) / each);
  const edge = (h0, h1, s0, s1) => {
    const slope = ((2 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
    if (Math.sign(slope) !== Math.sign(s0)) return 0;
    return Math.sign(s0) !== Math.sign(s1) && Math.abs(slope) > 3 * Math.abs(s0) ? 3 * s0 : slope;
  };
  return y.map((_, k) => {
    if (k === 0) return edge(h[0], h[1], s[0], s[1]);
    if (k === n - 1) return edge(h[n - 2], h[n - 3], s[n - 2], s[n - 3]);
    if (s[k - 1] * s[k] <= 0) return 0;
    const [before, after] = [2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]];
    return (before + after) / (before / s[k - 1] + after / s[k]);
  });
}

/** A cubic through values with slopes: functions `at`, `rate` and `integral` (from the first time on) of the time. */
function cubic(x, y, slopes) {
  const piece = (k) => {
    const h = x[k + 1] - x[k],
      s = (y[k + 1] - y[k]) / h;
    return [y[k], slopes[k], (3 * s - 2 * slopes[k] - slopes[k + 1]) / h, (slopes[k] + slopes[k + 1] - 2 * s) / h ** 2];
  };
  const whole = ([a, b, c, d], u) => u * (a + u * (b / 2 + u * (c / 3 + (u * d) / 4)));
  const sums = [0];
  for (let k = 0; k < x.length - 1; k++) sums.push(sums[k] + whole(piece(k), x[k + 1] - x[k]));
  const found = (time) => {
    let low = 0,
      high = x.length - 2;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (x[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return [low, time - x[low], piece(low)];
  };
  const at = (time) => {
    const [, u, [a, b, c, d]] = found(time);
    return a + u * (b + u * (c + u * d));
  };
  const rate = (time) => {
    const [, u, [, b, c, d]] = found(time);
    return b + u * (2 * c + 3 * u * d);
  };
  const integral = (time) => {
    const [k, u, coefficients] = found(time);
    return sums[k] + whole(coefficients, u);
  };
  return { at, rate, integral };
}

/** Motion of a log: a function of time [s] as `motionOf`, and its wind, or null; beyond its end all stays. */
export function flightOf(text) {
  const columns = columnsOf(text);
  const x = columns.time,
    end = x.at(-1);
  const curves = (name, slopes) =>
    name in columns ? cubic(x, columns[name], slopes(name)) : { at: () => 0, rate: () => 0, integral: () => 0 };
  const ends = ENDS.map((which) =>
    [1, 2, 3].map((i) => {
      const velocity = columns[`${which}_velocity[${i}]`];
      return curves(`${which}_position[${i}]`, (name) => velocity ?? smoothSlopes(x, columns[name]));
    }),
  );
  const monotonic = (name) => curves(name, () => monotonicSlopes(x, columns[name]));
  const speed = monotonic("reel_out_speed");
  const wind = "wind_velocity[1]" in columns ? vectorOf("wind_velocity").map(monotonic) : null;
  const motion = (time) => {
    const t = Math.min(time, end),
      moves = time <= end ? 1 : 0;
    const [[kite, kiteVelocity], [ground, groundVelocity]] = ends.map((each) => [
      each.map((curve) => curve.at(t)),
      each.map((curve) => moves * curve.rate(t)),
    ]);
    return { kite, kiteVelocity, ground, groundVelocity, reeled: speed.integral(t), reelOutSpeed: moves * speed.at(t) };
  };
  return { motion, wind: wind && ((time) => wind.map((each) => each.at(Math.min(time, end)))), duration: end };
}
