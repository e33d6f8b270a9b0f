// Where the ends of the tether are in a scene, as `files/flights.py`: formulas of time; velocities are their rates.

import { clamp, polar } from "./vectors.js";

const DIFFERENCE = 1e-3; // s; the error of five points is its fourth power times the fifth derivative over 30

const swing = (amplitude, period, time) => amplitude * Math.sin(((2 * Math.PI) / period) * time);

/** A smooth step from 0 to 1 for u from 0 to 1. */
function ramp(u) {
  const x = clamp(u, 0, 1);
  return x ** 3 * (x * (6 * x - 15) + 10);
}

/** Integral of `ramp` from 0 to u. */
function rampIntegral(u) {
  if (u > 1) return u - 0.5;
  const x = Math.max(u, 0);
  return x ** 4 * (x * (x - 3) + 2.5);
}

const STILL = { ground: () => [0, 0, 0], reeled: () => 0 };

/** Half width [rad] of a figure of eight for which one lap is lap times speed long. */
function widthOfEight(f) {
  const count = 400;
  let sum = 0;
  for (let k = 0; k < count; k++) {
    const u = (2 * Math.PI * k) / count;
    sum += Math.hypot(Math.cos(u), 2 * f.flatness * Math.cos(2 * u));
  }
  return (f.speed * f.lap) / (f.distance * ((2 * Math.PI * sum) / count));
}

/** By kind of flight: a function of its quantities that gives kite, ground and reeled, functions of time [s]. */
const KINDS = {
  circle(f) {
    const [sin, cos] = [Math.cos(f.axis_elevation), Math.sin(f.axis_elevation)];
    const kite = (time) => {
      const [x, y, z] = polar(f.distance, Math.PI / 2 - f.half_angle, f.rate * time);
      return [x, cos * y - sin * z, sin * y + cos * z];
    };
    return { ...STILL, kite };
  },
  figure_of_eight(f) {
    const width = widthOfEight(f);
    const kite = (time) => {
      const u = ((2 * Math.PI) / f.lap) * time;
      return polar(f.distance, f.elevation + f.flatness * width * Math.sin(2 * u), width * Math.sin(u));
    };
    return { ...STILL, kite };
  },
  parked(f) {
    return { ...STILL, kite: (time) => polar(f.distance, f.elevation, swing(f.sway / f.distance, f.sway_period, time)) };
  },
  launch(f) {
    const angle = (time) => f.elevation + ramp(time / f.climb_time) * (f.final_elevation - f.elevation);
    return { ...STILL, kite: (time) => polar(f.distance, angle(time), 0) };
  },
  landing(f) {
    const kite = (time) => {
      const part = ramp(time / f.landing_time);
      const distance = f.distance + part * (f.final_distance - f.distance);
      return polar(distance, f.elevation + part * (f.final_elevation - f.elevation), 0);
    };
    return { ...STILL, kite, reeled: (time) => -f.reeled_in * ramp(time / f.landing_time) };
  },
  towing(f) {
    const ground = (time) => [f.speed * f.ramp_time * rampIntegral(time / f.ramp_time), 0, 0];
    const kite = (time) => {
      const [x, y, z] = polar(f.distance, f.elevation, Math.PI + swing(f.weave, f.weave_period, time));
      return [ground(time)[0] + x, y, z];
    };
    return { ...STILL, ground, kite };
  },
  reel(f) {
    const r = f.ramp_time;
    const turns = [
      [1, 0],
      [-2, f.phase_time - 0.5 * r],
      [1, 2 * f.phase_time - r],
    ];
    const cycle = (time) => turns.reduce((sum, [factor, begin]) => sum + factor * rampIntegral((time - begin) / r), 0);
    // one cycle in the scene file; the page flies it again and again
    const reeled = (time) => f.speed * r * cycle(time - 2 * f.phase_time * Math.floor(time / (2 * f.phase_time)));
    const kite = (time) => polar(f.distance + reeled(time), f.elevation, swing(f.weave, f.weave_period, time));
    return { ...STILL, reeled, kite };
  },
  free_end(f) {
    const ground = (time) => {
      const angle = f.rate * f.ramp_time * rampIntegral(time / f.ramp_time);
      const up = f.height + f.heave * (1 - Math.cos(((2 * Math.PI) / f.heave_period) * time));
      return [f.radius * Math.cos(angle), f.radius * Math.sin(angle), up];
    };
    return { ground, reeled: (time) => f.speed * f.ramp_time * rampIntegral(time / f.ramp_time), kite: () => ground(0) };
  },
};

/** Rate of a function of time, a number or a vector. */
function rate(f, time) {
  const h = DIFFERENCE;
  const [a, b, c, d] = [f(time - 2 * h), f(time - h), f(time + h), f(time + 2 * h)];
  const central = (p, q, r, s) => (p - s + 8 * (r - q)) / (12 * h);
  return typeof a === "number" ? central(a, b, c, d) : a.map((_, i) => central(a[i], b[i], c[i], d[i]));
}

/** Motion of a prescribed flight: a function of time [s] with position and velocity of both ends and the winch. */
export function motionOf(kind, quantities) {
  const { kite, ground, reeled } = KINDS[kind](quantities);
  return (time) => ({
    kite: kite(time),
    kiteVelocity: rate(kite, time),
    ground: ground(time),
    groundVelocity: rate(ground, time),
    reeled: reeled(time),
    reelOutSpeed: rate(reeled, time),
  });
}

/** Wind at the reference height [m/s] with gusts, v (1 + g sin^2(pi t/P)). */
export function windAt(wind, time) {
  const factor = 1 + wind.gust * Math.sin((Math.PI / wind.gust_period) * time) ** 2;
  return wind.velocity.map((each) => factor * each);
}

/** Where a mass at the free end rests, see `FreeEnd.at_rest`: along the sum of its load and its weight. */
export function atRest(f, tether, gravity) {
  const perMetre = (tether.density * Math.PI * tether.diameter ** 2) / 4;
  const mass = f.kite_mass + 0.5 * perMetre * tether.initial_length;
  const [x, y, z] = loadOf(f);
  const force = [x, y, z - mass * gravity];
  const tension = Math.hypot(...force);
  const along = tension ? force.map((each) => each / tension) : [0, 0, -1];
  const length = tether.initial_length * (1 + tension / tether.axial_stiffness);
  return KINDS.free_end(f)
    .ground(0)
    .map((each, i) => each + length * along[i]);
}

/** Constant force on that mass besides its weight [N]. */
export function loadOf(f) {
  return [f.pull * Math.cos(f.elevation), 0, f.pull * Math.sin(f.elevation)];
}
