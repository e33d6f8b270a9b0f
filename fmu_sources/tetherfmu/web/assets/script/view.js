// The scene in space, drawn on a canvas: ground, wind, station, tethers, kite and its trail.

import { Camera } from "./camera.js";
import { REFERENCE } from "./simulation.js";
import { short } from "./text.js";
import { add, clamp, cross, norm, scale, sub, unit } from "./vectors.js";
import { windFactor } from "./wing.js";

const SPAN = 0.07; // of the drawn kite, part of the radius of the view
const TRAIL = 600; // points
const HEIGHTS = 6; // arrows of the wind

export class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.camera = new Camera();
    this.trail = [];
  }

  /** Look at what a simulation will fly; turned : whether the camera may turn, too. */
  show(simulation, turned) {
    const path = simulation.driver.motion && !simulation.driver.free ? pathOf(simulation) : null;
    const { values, flight } = simulation.settings;
    const reach = Math.max(values.initial_length, flight.longest_length ?? 0);
    const high = flight.height ?? 0;
    const points = path ?? [
      [0.6 * reach, 0, high],
      [0.3 * reach, 0.5 * reach, high],
      [0.3 * reach, -0.5 * reach, high + 0.6 * reach],
    ];
    const all =
      simulation.settings.kind === "free_end"
        ? [
            [0, 0, high],
            [0, 0, high - 1.2 * reach],
          ]
        : [...points, [0, 0, 0]];
    const low = [0, 1, 2].map((i) => Math.min(...all.map((p) => p[i])));
    const top = [0, 1, 2].map((i) => Math.max(...all.map((p) => p[i])));
    const centre = scale(0.5, add(low, top));
    const radius = Math.max(0.2 * reach, ...all.map((p) => norm(sub(p, centre))));
    this.offset = simulation.settings.kind === "towing" ? sub(centre, [0.5 * (low[0] + top[0]), 0, 0]) : null;
    this.camera.fit(centre, this.offset ? 0.75 * reach : radius);
    if (turned) {
      const away = Math.hypot(centre[0], centre[1]) > 0.1 * radius ? Math.atan2(centre[1], centre[0]) : 0;
      Object.assign(this.camera, { azimuth: away + Math.PI + 1.0, elevation: 0.2, zoom: 1 });
      this.camera.settle();
    }
    this.trail = [];
  }

  /** Fit the canvas to its place in the page. */
  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const dots = window.devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(width * dots) || this.canvas.height !== Math.round(height * dots)) {
      this.canvas.width = Math.round(width * dots);
      this.canvas.height = Math.round(height * dots);
    }
    this.context.setTransform(dots, 0, 0, dots, 0, 0);
    if (this.camera.width !== width || this.camera.height !== height) this.camera.resize(width, height);
    const style = getComputedStyle(this.canvas);
    this.ink = style.getPropertyValue("--ink");
    this.faint = style.getPropertyValue("--faint");
    this.ground = style.getPropertyValue("--ground");
  }

  draw(simulation) {
    const { context, camera } = this;
    this.resize();
    context.clearRect(0, 0, camera.width, camera.height);
    const flown = simulation.flown.filter((each) => each.tether);
    if (!flown.length) return;
    const shapes = flown.map((each) => pointsOf(each.tether.shape()));
    const last = shapes.at(-1);
    const [station, kite] = [last[0], last.at(-1)];
    if (this.offset) camera.fit(add(this.offset, [station[0], 0, 0]), camera.radius);
    this.keepTrail(kite);
    const level = simulation.settings.values.ground_height;
    this.drawGround(level);
    this.drawWind(simulation, station);
    this.drawShadow(last, level);
    this.path(this.trail, this.faint, 1.5);
    flown.forEach((each, k) => this.drawTether(each, shapes[k], simulation));
    this.drawStation(station, simulation);
    this.drawKite(simulation, last, kite);
  }

  keepTrail(kite) {
    const before = this.trail.at(-1);
    if (!before || norm(sub(before, kite)) > 0.004 * this.camera.radius) this.trail.push([...kite]);
    if (this.trail.length > TRAIL) this.trail.shift();
  }

  /** Draw a line through points in space. */
  path(points, colour, width, dash = []) {
    const { context, camera } = this;
    context.beginPath();
    for (let k = 1; k < points.length; k++) {
      const ends = camera.line(points[k - 1], points[k]);
      if (!ends) continue;
      context.moveTo(ends[0][0], ends[0][1]);
      context.lineTo(ends[1][0], ends[1][1]);
    }
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.setLineDash(dash);
    context.stroke();
    context.setLineDash([]);
  }

  drawGround(level) {
    const { camera } = this;
    const [x, y] = camera.centre;
    const reach = (1.7 * camera.radius) / Math.min(1, camera.zoom);
    this.spacing = nice(camera.radius / 3 / Math.max(1, camera.zoom));
    const first = (c) => Math.ceil((c - reach) / this.spacing);
    for (let i = first(x); i * this.spacing < x + reach; i++) {
      const at = i * this.spacing,
        half = Math.sqrt(Math.max(0, reach ** 2 - (at - x) ** 2));
      this.path(
        [
          [at, y - half, level],
          [at, y + half, level],
        ],
        this.ground,
        i === 0 ? 1.6 : 0.7,
      );
    }
    for (let i = first(y); i * this.spacing < y + reach; i++) {
      const at = i * this.spacing,
        half = Math.sqrt(Math.max(0, reach ** 2 - (at - y) ** 2));
      this.path(
        [
          [x - half, at, level],
          [x + half, at, level],
        ],
        this.ground,
        i === 0 ? 1.6 : 0.7,
      );
    }
  }

  drawWind(simulation, station) {
    const { values } = simulation.settings;
    const wind = simulation.given?.wind_velocity ?? simulation.settings.wind.velocity;
    const speed = norm(wind);
    if (speed === 0) return;
    const { radius } = this.camera;
    const from = sub(station, scale(0.55 * radius, unit([wind[0], wind[1], 0])));
    for (let k = 1; k <= HEIGHTS; k++) {
      const z = values.ground_height + (k / HEIGHTS) * 0.9 * radius;
      const factor = windFactor(z, values);
      const start = [from[0], from[1], z];
      this.arrow(
        start,
        add(start, scale((0.022 * radius * factor * Math.sqrt(speed)) / speed, scale(speed / Math.sqrt(speed), wind))),
        this.faint,
        1.2,
      );
    }
  }

  arrow(from, to, colour, width) {
    const ends = this.camera.line(from, to);
    if (!ends) return;
    const [[x0, y0], [x1, y1]] = ends;
    const length = Math.hypot(x1 - x0, y1 - y0);
    this.path([from, to], colour, width);
    if (length < 6) return;
    const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
    const { context } = this;
    context.beginPath();
    context.moveTo(x1, y1);
    context.lineTo(x1 - 6 * ux + 3 * uy, y1 - 6 * uy - 3 * ux);
    context.lineTo(x1 - 6 * ux - 3 * uy, y1 - 6 * uy + 3 * ux);
    context.fillStyle = colour;
    context.fill();
  }

  drawShadow(points, level) {
    this.context.globalAlpha = 0.5;
    this.path(
      points.map(([x, y]) => [x, y, level]),
      this.ground,
      2,
    );
    const kite = points.at(-1);
    this.path([kite, [kite[0], kite[1], level]], this.ground, 0.8, [2, 4]);
    this.context.globalAlpha = 1;
  }

  drawTether({ name, variant, tether, refusal }, points, simulation) {
    const isReference = name === REFERENCE;
    const colour = isReference ? simulation.declared.colours.reference : variant.colour;
    this.context.globalAlpha = refusal === null ? 1 : 0.35;
    if (!variant.nodes) this.path(points, colour, 2, tether.scalar("slack_segments") > 0 ? [5, 4] : []);
    else {
      const rest = tether.scalar("tether_length") / (points.length - 1);
      const taut = [],
        slack = [];
      for (let k = 1; k < points.length; k++) {
        (norm(sub(points[k], points[k - 1])) < rest ? slack : taut).push([points[k - 1], points[k]]);
      }
      for (const each of taut) this.path(each, colour, isReference ? 4 : 2);
      for (const each of slack) this.path(each, colour, isReference ? 3 : 1.4, [4, 3]);
    }
    this.context.globalAlpha = 1;
  }

  drawStation(station, simulation) {
    const at = this.camera.project(station);
    if (!at) return;
    const { context } = this;
    if (simulation.settings.kind === "free_end") {
      this.path([station, [station[0], station[1], simulation.settings.values.ground_height]], this.faint, 3);
    }
    context.fillStyle = this.ink;
    context.beginPath();
    context.moveTo(at[0] - 7, at[1] + 6);
    context.lineTo(at[0] + 7, at[1] + 6);
    context.lineTo(at[0] + 3, at[1] - 3);
    context.lineTo(at[0] - 3, at[1] - 3);
    context.fill();
  }

  /** An arc across the direction of flight, its bow away from the station; a load is a ball. */
  drawKite(simulation, points, kite) {
    const { context, camera } = this;
    if (simulation.settings.kind === "free_end") {
      const at = camera.project(kite);
      if (!at) return;
      context.beginPath();
      context.arc(at[0], at[1], 6, 0, 2 * Math.PI);
      context.fillStyle = this.ink;
      context.fill();
      return;
    }
    const outward = unit(sub(kite, points[0]));
    const moving = simulation.driver.heading ?? simulation.given?.kite_velocity ?? [0, 0, 1];
    const along = sub(moving, scale(moving[0] * outward[0] + moving[1] * outward[1] + moving[2] * outward[2], outward));
    const ahead = norm(along) > 1e-3 ? unit(along) : unit(cross(outward, [0, 1, 0]));
    const side = cross(outward, ahead);
    const size = (SPAN * camera.radius) / Math.sqrt(Math.max(1, camera.zoom));
    const edge = (part, chord) => {
      const angle = part * 1.15;
      const place = add(scale(size * Math.sin(angle), side), scale(size * (0.9 + 0.75 * (Math.cos(angle) - 1)), outward));
      return add(kite, add(place, scale(size * chord * (0.3 + 0.7 * Math.cos(angle)), ahead)));
    };
    const parts = Array.from({ length: 13 }, (_, k) => (k - 6) / 6);
    const outline = [...parts.map((p) => edge(p, 0.28)), ...parts.toReversed().map((p) => edge(p, -0.28))].map((p) =>
      camera.project(p),
    );
    if (outline.some((each) => !each)) return;
    for (const part of [-1, -0.5, 0.5, 1]) this.path([kite, edge(part, 0)], this.ink, 0.6);
    context.beginPath();
    outline.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.closePath();
    context.fillStyle = this.ink;
    context.globalAlpha = 0.85;
    context.fill();
    context.globalAlpha = 1;
  }

  /** Width of the grid and speed of the wind, in words. */
  legend(simulation) {
    const wind = norm(simulation.given?.wind_velocity ?? simulation.settings.wind.velocity);
    return `grid ${short(this.spacing ?? 0, "m")}, wind ${wind.toFixed(1)} m/s`;
  }
}

/** A round number near another one. */
export function nice(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return power * (x / power < 1.5 ? 1 : x / power < 3.5 ? 2 : x / power < 7.5 ? 5 : 10);
}

function pointsOf(numbers) {
  return Array.from({ length: numbers.length / 3 }, (_, k) => [numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]]);
}

/** Places of the kite along a prescribed flight. */
function pathOf({ driver, settings }) {
  const duration = clamp(settings.duration ?? 30, 10, 130);
  return Array.from({ length: 65 }, (_, k) => driver.motion((k / 64) * duration)).flatMap(({ kite, ground }) => [
    kite,
    ground,
  ]);
}
