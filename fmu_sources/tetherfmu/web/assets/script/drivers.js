// Who moves the ends of the tether: a scene, the pointer, or for a free kite its wing or a load.

import { atRest, loadOf, motionOf, windAt } from "./flights.js";
import { flightOf } from "./log.js";
import { Follower } from "./pointer.js";
import { polar } from "./vectors.js";
import { Wing } from "./wing.js";

/** Driver of the kind of flight that the settings name, see `settings.js`; `Refused` if a log cannot be flown. */
export function driverOf(settings) {
  const kind = { pointer: ByPointer, free: ByWing, free_end: ByLoad, log: ByLog }[settings.kind] ?? ByScene;
  return new kind(settings);
}

/** What all drivers share: wind and winch. `memory` is all that changes. */
class Driver {
  free = false; // whether the tether moves the kite
  memory = { reeled: 0 };

  constructor(settings) {
    this.settings = settings;
    this.hand = settings.hand;
  }

  /** Inputs that do not depend on the kind of flight; reeled : length paid out [m]. */
  common(time, reelOutSpeed, reeled) {
    return {
      ground_position: [0, 0, 0],
      ground_velocity: [0, 0, 0],
      reel_out_speed: reelOutSpeed,
      wind_velocity: this.wind(time),
      winch_force: this.hand.winch_force,
      winch_length: this.settings.values.initial_length + reeled,
    };
  }

  wind(time) {
    return windAt(this.settings.wind, time);
  }

  /** Go on by a step [s] that was done. */
  advance() {}
}

class ByScene extends Driver {
  constructor(settings) {
    super(settings);
    this.motion = this.motionOf(settings);
  }

  motionOf({ kind, flight }) {
    return motionOf(kind, flight);
  }

  inputs(time) {
    const now = this.motion(time);
    return {
      ...this.common(time, now.reelOutSpeed, now.reeled),
      ground_position: now.ground,
      ground_velocity: now.groundVelocity,
      kite_position: now.kite,
      kite_velocity: now.kiteVelocity,
    };
  }
}

/** A log, which may have a wind of its own. */
class ByLog extends ByScene {
  motionOf({ log }) {
    const flight = flightOf(log);
    this.windOfLog = flight.wind;
    return flight.motion;
  }

  wind(time) {
    return this.windOfLog ? this.windOfLog(time) : super.wind(time);
  }
}

class ByPointer extends Driver {
  constructor(settings) {
    super(settings);
    this.follower = new Follower(settings.flight);
    this.memory.follower = this.follower.memory;
  }

  lead(elevation, azimuth) {
    this.follower.lead(elevation, azimuth);
  }

  inputs(time) {
    this.follower.memory = this.memory.follower;
    const { kite, kiteVelocity } = this.follower.motion();
    const speed = this.hand.reel_out_speed;
    return { ...this.common(time, speed, this.memory.reeled), kite_position: kite, kite_velocity: kiteVelocity };
  }

  advance(step) {
    this.follower.advance(step);
    this.memory.reeled += step * this.hand.reel_out_speed;
  }
}

/** A free end: `kite` has its position and velocity, which the tether gives. */
class Free extends Driver {
  free = true;

  inputs(time, kite, step) {
    const { load, reelOutSpeed, reeled, ...more } = this.loads(time, kite, step);
    this.memory.speed = reelOutSpeed;
    return {
      ...this.common(time, reelOutSpeed, reeled ?? this.memory.reeled),
      ...more,
      kite_load: load,
      kite_position: kite.position,
      kite_velocity: kite.velocity,
    };
  }

  advance(step) {
    this.memory.reeled += step * this.memory.speed;
  }
}

class ByWing extends Free {
  constructor(settings) {
    super(settings);
    this.wing = new Wing(settings.flight, settings.flight, settings.values);
    this.memory.wing = this.wing.memory;
  }

  /** Where the kite begins: at rest, on a taut tether. */
  start() {
    const { values, flight } = this.settings;
    return { position: polar(values.initial_length, flight.initial_elevation, flight.downwind), velocity: [0, 0, 0] };
  }

  loads(time, kite, step) {
    const { wing, hand, settings } = this;
    wing.memory = this.memory.wing;
    const wind = windAt(settings.wind, time);
    const flown = { steering: hand.steering, depower: hand.depower, reelOutSpeed: hand.reel_out_speed };
    return wing.fly(kite.position, kite.velocity, wind, kite.tension, kite.length, flown, step);
  }

  get heading() {
    return this.memory.wing.heading;
  }
}

class ByLoad extends Free {
  constructor(settings) {
    super(settings);
    this.motion = motionOf("free_end", settings.flight);
  }

  start() {
    const { values, flight } = this.settings;
    return { position: atRest(flight, values, values.gravity), velocity: [0, 0, 0] };
  }

  loads(time) {
    const { ground, groundVelocity, reelOutSpeed, reeled } = this.motion(time);
    const load = loadOf(this.settings.flight);
    return { load, reelOutSpeed, reeled, ground_position: ground, ground_velocity: groundVelocity };
  }
}
