// A kite that follows the pointer on a sphere around the ground station, smoothly and no faster than it may.

import { clamp, polar } from "./vectors.js";

const HIGHEST = 1.5; // elevation [rad]
const LOWEST = 0.02;

/** Follows a target as a mass on a spring with critical damping, in distance, elevation and azimuth. */
export class Follower {
  /** flight : quantities of the kind `pointer`. */
  constructor(flight) {
    this.flight = flight;
    this.memory = { now: [flight.distance, flight.elevation, 0], rate: [0, 0, 0], target: [flight.elevation, 0] };
  }

  /** Lead the kite to an elevation and an azimuth [rad]. */
  lead(elevation, azimuth) {
    const turns = Math.round((this.memory.now[2] - azimuth) / (2 * Math.PI));
    this.memory.target = [clamp(elevation, LOWEST, HIGHEST), azimuth + 2 * Math.PI * turns];
  }

  /** Move on by a step [s]. */
  advance(step) {
    const { now, rate, target } = this.memory;
    const w = 2 / this.flight.response_time;
    const fastest = this.flight.speed / now[0];
    const goals = [this.flight.distance, ...target];
    const limits = [this.flight.speed, fastest, fastest / Math.max(0.1, Math.cos(now[1]))];
    for (let i = 0; i < 3; i++) {
      // exact for a goal that stays: x = (a + b t) exp(-w t)
      const a = now[i] - goals[i],
        b = rate[i] + w * a,
        fade = Math.exp(-w * step);
      const next = clamp((b - w * (a + b * step)) * fade, -limits[i], limits[i]);
      now[i] += 0.5 * step * (rate[i] + next);
      rate[i] = next;
    }
  }

  /** Position [m] and velocity [m/s] of the kite. */
  motion() {
    const [distance, elevation, azimuth] = this.memory.now;
    const [away, up, around] = this.memory.rate;
    const [ce, se, ca, sa] = [Math.cos(elevation), Math.sin(elevation), Math.cos(azimuth), Math.sin(azimuth)];
    const grow = [
      [ce * ca, ce * sa, se],
      [-distance * se * ca, -distance * se * sa, distance * ce],
      [-distance * ce * sa, distance * ce * ca, 0],
    ];
    return {
      kite: polar(distance, elevation, azimuth),
      kiteVelocity: [0, 1, 2].map((i) => away * grow[0][i] + up * grow[1][i] + around * grow[2][i]),
    };
  }
}
