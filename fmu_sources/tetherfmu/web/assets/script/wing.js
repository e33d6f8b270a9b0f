// A soft kite that flies free on `TetherDynamicFree`, and who steers it: the wing and the controller of the example FMUs
// (examples/fmus/aerodynamics.py, flight_controller.py, air.py), with the same quantities.

import { add, clamp, cross, dot, norm, scale, unit } from "./vectors.js";

const SLOWEST = 1; // apparent wind below which the weight does not turn the kite faster [m/s]
const SLOWEST_STEERED = 3; // apparent wind for which the steering is computed at least [m/s]
const UPWARD = (100 * Math.PI) / 180; // elevation of the target while reeling in, beyond the zenith [rad]
const FADING = (20 * Math.PI) / 180; // below `steepest`, where reeling in becomes slower [rad]
const BY_HAND = 1,
  PUMPING = 3; // choices of `autopilot`, beside figures of eight
const TRACTION = 1,
  REEL_IN = 2;

const UNIFORM = 1,
  POWER_LAW = 2,
  LOGARITHMIC = 3,
  EXPLOG = 4; // choices of `wind_profile`

/** Wind at a height [m] over wind at the reference height; an error for a law that is not here. */
export function windFactor(z, air) {
  const h = air.wind_reference_height,
    roughness = air.surface_roughness;
  const power = z > 0 ? (z / h) ** air.wind_exponent : 0;
  const logarithm = z > roughness ? Math.log(z / roughness) / Math.log(h / roughness) : 0;
  if (air.wind_profile === UNIFORM) return 1;
  if (air.wind_profile === POWER_LAW) return power;
  if (air.wind_profile === LOGARITHMIC) return logarithm;
  if (air.wind_profile === EXPLOG) return Math.max(0, 2 * logarithm - power);
  throw new Error(`wind_profile is ${air.wind_profile}, a law that wing.js does not know`);
}

/** Density of the air at a height [m]. */
function density(z, air) {
  const scaleHeight = air.air_density_scale_height;
  return scaleHeight > 0 ? air.air_density * Math.exp(-z / scaleHeight) : air.air_density;
}

/** Component along r x z: to the right as seen from the ground station. */
const rightward = (a, r) => a[0] * r[1] - a[1] * r[0];
/** Angle of a vector across r from the zenith to the right [rad]. */
export const angleOf = (a, r) => Math.atan2(rightward(a, r), a[2] - dot(a, r) * r[2]);

/** Heading after a turn about r [rad], across r. */
function turned(heading, r, angle) {
  const x = unit(add(heading, scale(-dot(heading, r), r)));
  return add(scale(Math.cos(angle), x), scale(Math.sin(angle), cross(r, x)));
}

/** Direction with this azimuth and elevation. */
function direction(azimuth, elevation) {
  const across = Math.cos(elevation);
  return [across * Math.cos(azimuth), across * Math.sin(azimuth), Math.sin(elevation)];
}

/** Direction to the point phi of the figure of eight, and its rate over phi. */
function pointOfEight(flight, phi) {
  const { downwind, half_width: wide, half_height: high, elevation } = flight;
  const across = wide * Math.cos(phi) * Math.cos(elevation);
  return [
    direction(downwind + wide * Math.sin(phi), elevation + high * Math.sin(2 * phi)),
    Math.hypot(across, 2 * high * Math.cos(2 * phi)),
  ];
}

/** Lift plus drag [N] in the apparent wind `felt`, as `aerodynamics.load`. */
export function wingLoad(position, heading, felt, steering, depower, wing, air) {
  const squared = dot(felt, felt);
  const across = cross(cross(unit(position), heading), felt);
  const length = norm(across);
  const area = 0.5 * density(position[2], air) * wing.wing_area;
  const lift = wing.powered_lift + depower * (wing.depowered_lift - wing.powered_lift);
  const drag = wing.powered_drag + depower * (wing.depowered_drag - wing.powered_drag);
  const along = area * drag * (1 + wing.steering_drag * Math.abs(steering)) * Math.sqrt(squared);
  return add(scale(along, felt), scale(length > 0 ? (area * lift * squared) / length : 0, across));
}

/** The kite and who steers it; `memory` is all that changes. */
export class Wing {
  constructor(wing, flight, air) {
    Object.assign(this, { wing, flight, air });
    this.memory = { heading: null, phi: Math.PI / 2, depower: 0, phase: TRACTION, steering: 0 };
  }

  /** Load on the kite [N] and reel-out speed [m/s] now.  hand : { steering, depower, reelOutSpeed } of who flies it. */
  fly(position, velocity, wind, tension, length, hand, step) {
    const { memory, wing, flight } = this;
    const r = unit(position);
    const zenith = [-r[2] * r[0], -r[2] * r[1], 1 - r[2] * r[2]];
    memory.heading ??= turned(unit(norm(zenith) > 1e-9 ? zenith : [-1, 0, 0]), r, wing.initial_heading);
    memory.heading = turned(memory.heading, r, 0);
    const felt = add(scale(windFactor(position[2], this.air), wind), scale(-1, velocity));
    const given = flight.autopilot === BY_HAND ? hand : this.steered(r, norm(felt), tension, length, hand, step);
    memory.steering = clamp(given.steering, -1, 1);
    memory.depower = given.depower;
    const speed = Math.max(norm(felt), SLOWEST);
    const byWeight = (wing.turning_by_weight / speed) * rightward(memory.heading, r);
    const load = wingLoad(position, memory.heading, felt, memory.steering, memory.depower, wing, this.air);
    memory.heading = turned(memory.heading, r, step * (wing.turning * speed * memory.steering + byWeight));
    return { load, reelOutSpeed: given.reelOutSpeed };
  }

  /** What the controller does, as `FlightController`. */
  steered(r, speed, tension, length, hand, step) {
    const { memory, flight, wing } = this;
    const pumping = flight.autopilot === PUMPING;
    if (!pumping || length <= flight.shortest_length) memory.phase = TRACTION;
    else if (length >= flight.longest_length) memory.phase = REEL_IN;
    const reelingIn = memory.phase === REEL_IN;
    const change = flight.depower_rate * step;
    const depower = pumping ? clamp(reelingIn ? 1 : 0, memory.depower - change, memory.depower + change) : hand.depower;
    if (reelingIn) memory.phi = Math.PI / 2;
    let [target, rate] = pointOfEight(flight, memory.phi);
    if (reelingIn) target = direction(flight.downwind, UPWARD);
    else {
      const ahead = Math.atan2(norm(cross(r, target)), dot(r, target));
      memory.phi =
        (memory.phi + Math.max(0, flight.look_ahead - ahead) / Math.max(rate, flight.half_height)) % (2 * Math.PI);
      [target] = pointOfEight(flight, memory.phi);
    }
    const heading = angleOf(memory.heading, r);
    const turn = angleOf(target, r) - heading + Math.PI;
    const error = turn - 2 * Math.PI * Math.floor(turn / (2 * Math.PI)) - Math.PI;
    const fast = Math.max(speed, SLOWEST_STEERED);
    const byWeight = (wing.turning_by_weight / fast) * Math.sin(heading) * Math.hypot(r[0], r[1]);
    const out = Math.sqrt(Math.max(tension, 0) / flight.tension_over_squared_speed);
    const steepness = clamp((flight.steepest - Math.asin(clamp(r[2], -1, 1))) / FADING, 0, 1);
    const back = flight.reel_in_speed * Math.max(0, 1 - tension / flight.reel_in_tension) * steepness;
    return {
      steering: (flight.course_gain * error - byWeight) / (wing.turning * fast),
      depower,
      reelOutSpeed: pumping ? (1 - depower) * out - depower * back : hand.reelOutSpeed,
    };
  }
}
