// Strip charts of the last seconds.

import { REFERENCE } from "./simulation.js";
import { short } from "./text.js";
import { nice } from "./view.js";

const STRIPS = [
  { channel: "kite_force", title: "force on the kite", unit: "N" },
  { channel: "ground_force", title: "force on the ground station", unit: "N" },
  { channel: "max_tension", title: "largest tension", unit: "N" },
  { channel: "slack", title: "part of the segments that is slack", unit: "%", factor: 100, most: 100 },
  { channel: "error", title: "error of the force on the kite", unit: "N", logarithmic: true },
];
const LEFT = 52,
  TOP = 18,
  BOTTOM = 14; // px

export class Charts {
  /** place : element that gets a canvas for each strip. */
  constructor(place) {
    this.strips = STRIPS.map((strip) => {
      const canvas = document.createElement("canvas");
      canvas.className = "strip";
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", `strip chart: ${strip.title}`);
      place.append(canvas);
      return { ...strip, canvas };
    });
  }

  draw(simulation) {
    for (const strip of this.strips) this.drawStrip(strip, simulation);
  }

  drawStrip(strip, { record, flown, declared }) {
    const { canvas } = strip;
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width) return;
    const dots = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * dots) || canvas.height !== Math.round(height * dots)) {
      canvas.width = Math.round(width * dots);
      canvas.height = Math.round(height * dots);
    }
    const context = canvas.getContext("2d");
    context.setTransform(dots, 0, 0, dots, 0, 0);
    context.clearRect(0, 0, width, height);
    const style = getComputedStyle(canvas);
    const ink = style.getPropertyValue("--ink"),
      faint = style.getPropertyValue("--faint"),
      line = style.getPropertyValue("--line");
    context.font = "12px system-ui, sans-serif";
    const [begin, end] = record.span();
    const shown = flown.filter((each) => strip.channel !== "error" || each.name !== REFERENCE);
    const series = shown.map((each) => record.series[each.name]?.[strip.channel] ?? []);
    const scale = strip.logarithmic ? logarithmicScale(series) : linearScale(series, strip);
    const x = (time) => LEFT + ((width - LEFT - 4) * (time - begin)) / (end - begin);
    const y = (value) => height - BOTTOM - (height - TOP - BOTTOM) * scale.part(value);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const tick of scale.ticks) {
      context.strokeStyle = line;
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(LEFT, y(tick));
      context.lineTo(width - 4, y(tick));
      context.stroke();
      context.fillStyle = faint;
      context.fillText(strip.unit === "%" ? `${Math.round(100 * tick)} %` : short(tick, strip.unit), LEFT - 5, y(tick));
    }
    context.textAlign = "left";
    context.fillStyle = ink;
    context.fillText(strip.title, LEFT, 8);
    context.textAlign = "center";
    context.fillStyle = faint;
    for (let time = Math.ceil(begin / 5) * 5; time <= end; time += 5) {
      if (x(time) > LEFT + 12) context.fillText(`${time} s`, Math.min(x(time), width - 16), height - 5);
    }
    shown.forEach((each, k) => {
      const colour = each.name === REFERENCE ? declared.colours.reference : each.variant.colour;
      this.drawLine(context, record.times, series[k], x, y, colour, each.name === REFERENCE ? 3 : 1.5, scale.least);
    });
  }

  drawLine(context, times, values, x, y, colour, width, least) {
    context.beginPath();
    let pen = false;
    for (let k = 0; k < times.length; k++) {
      if (!Number.isFinite(values[k])) {
        pen = false;
        continue;
      }
      const [px, py] = [x(times[k]), y(Math.max(values[k], least))];
      if (px < LEFT) continue;
      if (pen) context.lineTo(px, py);
      else context.moveTo(px, py);
      pen = true;
    }
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }
}

function linearScale(series, { most }) {
  let top = 0;
  for (const values of series) for (const each of values) if (each > top) top = each;
  top = most ? most / 100 : top || 1;
  const step = most ? top / 2 : nice(top / 3);
  const count = Math.ceil(top / step - 1e-9);
  const ticks = Array.from({ length: count + 1 }, (_, k) => k * step).filter((_, k) => count < 4 || k % 2 === 0);
  return { ticks, part: (value) => value / (count * step), least: -Infinity };
}

function logarithmicScale(series) {
  let top = 1e-6;
  for (const values of series) for (const each of values) if (each > top) top = each;
  const high = Math.ceil(Math.log10(top)),
    low = high - 5;
  const ticks = [high, high - 2, high - 4].map((power) => 10 ** power);
  return { ticks, part: (value) => (Math.log10(value) - low) / (high - low), least: 10 ** low };
}
