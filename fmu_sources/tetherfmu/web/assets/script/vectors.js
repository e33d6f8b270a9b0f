// Vectors of three numbers as arrays.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (f, a) => [f * a[0], f * a[1], f * a[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.hypot(a[0], a[1], a[2]);

/** A vector over its length; [0, 0, 0] if it has none. */
export function unit(a) {
  const length = norm(a);
  return length === 0 ? [0, 0, 0] : scale(1 / length, a);
}

/** Point at a distance [m] and two angles [rad] from the origin; azimuth from the x axis, anti-clockwise from above. */
export function polar(distance, elevation, azimuth) {
  const across = distance * Math.cos(elevation);
  return [across * Math.cos(azimuth), across * Math.sin(azimuth), distance * Math.sin(elevation)];
}

export const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
