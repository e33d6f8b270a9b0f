// From space to the window and back: a camera that looks at a sphere and turns around it.

import { add, clamp, cross, dot, norm, scale, sub, unit } from "./vectors.js";

const ANGLE = (38 * Math.PI) / 180; // of the view, across the smaller side of the window
const LOWEST = -0.3,
  STEEPEST = 1.55; // rad
const NEAR = 0.01; // of the distance: what is nearer is not drawn

export class Camera {
  constructor() {
    Object.assign(this, { azimuth: 0, elevation: 0.22, zoom: 1, centre: [0, 0, 0], radius: 1, width: 1, height: 1 });
    this.settle();
  }

  /** Look at a sphere. */
  fit(centre, radius) {
    Object.assign(this, { centre, radius });
    this.settle();
  }

  resize(width, height) {
    Object.assign(this, { width, height });
    this.settle();
  }

  turn(azimuth, elevation) {
    this.azimuth += azimuth;
    this.elevation = clamp(this.elevation + elevation, LOWEST, STEEPEST);
    this.settle();
  }

  closer(factor) {
    this.zoom = clamp(this.zoom * factor, 0.2, 20);
    this.settle();
  }

  /** Where it looks from, text for a link. */
  place() {
    return [this.azimuth, this.elevation, this.zoom].map((each) => each.toFixed(3)).join(",");
  }

  /** Look from where a link says; nothing else is taken. */
  look(text) {
    const [azimuth, elevation, zoom] = (text ?? "").split(",").map(Number);
    if (![azimuth, elevation, zoom].every(Number.isFinite) || !(zoom > 0)) return;
    Object.assign(this, { azimuth, elevation: clamp(elevation, LOWEST, STEEPEST), zoom: clamp(zoom, 0.2, 20) });
    this.settle();
  }

  /** Compute what projections need. */
  settle() {
    const across = Math.cos(this.elevation);
    const back = [across * Math.cos(this.azimuth), across * Math.sin(this.azimuth), Math.sin(this.elevation)];
    this.distance = (1.08 * this.radius) / Math.sin(ANGLE / 2) / this.zoom;
    this.eye = add(this.centre, scale(this.distance, back));
    this.forward = scale(-1, back);
    this.right = unit(cross(this.forward, [0, 0, 1]));
    this.up = cross(this.right, this.forward);
    this.focus = (0.5 * Math.min(this.width, this.height)) / Math.tan(ANGLE / 2);
  }

  /** Place in the window [px], and distance; null behind the camera. */
  project(point) {
    const away = sub(point, this.eye);
    const depth = dot(away, this.forward);
    if (depth < NEAR * this.distance) return null;
    const size = this.focus / depth;
    return [this.width / 2 + size * dot(away, this.right), this.height / 2 - size * dot(away, this.up), size];
  }

  /** Both ends of a line in the window, cut off behind the camera; null if nothing is left. */
  line(a, b) {
    const depth = (p) => dot(sub(p, this.eye), this.forward) - NEAR * this.distance;
    const [da, db] = [depth(a), depth(b)];
    if (da < 0 && db < 0) return null;
    const between = () => add(a, scale((da + 1e-9 * this.distance) / (da - db), sub(b, a)));
    const ends = [da < 0 ? nudged(between(), b) : a, db < 0 ? nudged(between(), a) : b].map((each) => this.project(each));
    return ends[0] && ends[1] ? ends : null;
  }

  /** Direction from the eye through a place in the window. */
  ray(x, y) {
    const ahead = scale(this.focus, this.forward);
    const aside = add(scale(x - this.width / 2, this.right), scale(this.height / 2 - y, this.up));
    return unit(add(ahead, aside));
  }

  /** Point of a sphere under a place in the window, the farther one: the kite flies behind; the nearest if it is missed. */
  onSphere(centre, radius, x, y) {
    const direction = this.ray(x, y);
    const away = sub(this.eye, centre);
    const b = dot(away, direction);
    const square = b * b - dot(away, away) + radius * radius;
    const far = -b + Math.sqrt(Math.max(0, square));
    const point = add(away, scale(Math.max(far, 0), direction));
    return norm(point) > 0 ? scale(radius, unit(point)) : [radius, 0, 0];
  }
}

/** A point moved a little towards another one, so that it is in front of the camera. */
function nudged(point, towards) {
  return add(point, scale(1e-6, sub(towards, point)));
}
