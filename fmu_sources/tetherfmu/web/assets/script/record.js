// What the charts show: the last seconds of some numbers of each tether.

export const CHANNELS = ["kite_force", "ground_force", "max_tension", "slack", "error"];
const WINDOW = 20; // s
const EVERY = 0.02; // s, at least

/** Samples of all tethers, the oldest first. */
export class Record {
  constructor(names) {
    this.times = [];
    this.series = Object.fromEntries(names.map((name) => [name, Object.fromEntries(CHANNELS.map((each) => [each, []]))]));
  }

  /** Whether a sample is due at a time [s]. */
  isDue(time) {
    return this.times.length === 0 || time > this.times.at(-1) + EVERY - 1e-9;
  }

  /** Keep a sample; of : dict of tether to dict of channel to number. */
  keep(time, of) {
    this.times.push(time);
    for (const [name, channels] of Object.entries(this.series)) {
      for (const each of CHANNELS) channels[each].push(of[name]?.[each] ?? NaN);
    }
    if (this.times[0] < time - 1.25 * WINDOW) this.forget(time - WINDOW);
  }

  forget(before) {
    const count = this.times.findIndex((time) => time >= before);
    this.times.splice(0, count);
    for (const channels of Object.values(this.series)) for (const each of CHANNELS) channels[each].splice(0, count);
  }

  /** From when to when the charts go [s]. */
  span() {
    const end = Math.max(this.times.at(-1) ?? 0, WINDOW);
    return [end - WINDOW, end];
  }

  /** Root of the mean square of a channel of a tether over the last seconds; NaN without samples. */
  rms(name, channel, seconds) {
    const values = this.series[name]?.[channel] ?? [];
    const first = this.times.findIndex((time) => time >= this.times.at(-1) - seconds);
    let sum = 0,
      count = 0;
    for (let k = Math.max(first, 0); k < values.length; k++) {
      if (Number.isFinite(values[k])) {
        sum += values[k] ** 2;
        count += 1;
      }
    }
    return count ? Math.sqrt(sum / count) : NaN;
  }
}
