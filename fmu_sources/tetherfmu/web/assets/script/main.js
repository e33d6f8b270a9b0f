// The page: what is set, what flies, what is shown, sixty times a second.

import { Charts } from "./charts.js";
import { Controls } from "./controls.js";
import { listen } from "./gestures.js";
import { libraryOf, Refused } from "./library.js";
import { flightOf } from "./log.js";
import { changesOf, settingsFrom, settingsOf } from "./settings.js";
import { addressWith, keep, kept, pairsIn, pairsOf, savedIn } from "./sharing.js";
import { Simulation } from "./simulation.js";
import { clamp, norm, sub } from "./vectors.js";
import { View } from "./view.js";
import { writeNumbers, writeSettings } from "./written.js";

const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10];
const STEPS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1]; // s
const BUDGET = 12; // ms of a frame for the tethers
const OWN = "own_log"; // scene of a log of the user's
const LONGEST_FREE = 0.02; // communication step [s] that may be chosen for a kite under the loads of a wing
const STEERED = 0.12; // by a key
const LONGEST_FRAME = 0.1; // s of a frame that are made up for
const MEASURE_EVERY = 250,
  WORDS_EVERY = 200,
  CHARTS_EVERY = 80; // ms

const by = (id) => document.getElementById(id);

class Page {
  constructor(declared, library) {
    Object.assign(this, {
      declared,
      library,
      runs: true,
      behind: 0,
      last: performance.now(),
      fps: 60,
      spoken: 0,
      charted: 0,
      measured: 0,
    });
    this.view = new View(by("view"));
    this.charts = new Charts(by("strips"));
    this.controls = new Controls(by("controls"), declared, (restart) => this.changed(restart));
    for (const [name, { title }] of Object.entries(declared.scenes)) by("scene").append(new Option(title, name));
    for (const each of SPEEDS) by("speed").append(new Option(`${each} ×`, each));
    for (const each of STEPS) by("step").append(new Option(`${each * 1000} ms`, each));
    this.connect();
    this.open(pairsIn(location.hash));
    requestAnimationFrame((now) => this.frame(now));
  }

  /** Fly what the pairs of a link say. */
  open(pairs) {
    this.settings = settingsFrom(this.declared, pairs);
    this.fly(true);
    this.view.camera.look(new Map(pairs).get("view"));
    const saved = savedIn(pairs);
    if (saved) this.take(saved);
    this.controls.show(this.settings);
  }

  /** Begin anew with the settings; turned : whether the camera may turn. */
  fly(turned = false) {
    const { kind, values, flight } = this.settings;
    if (kind === "free_end") values.kite_mass = flight.kite_mass;
    for (const option of by("step").options) option.disabled = kind === "free" && Number(option.value) > LONGEST_FREE;
    this.simulation = new Simulation(this.library, this.settings);
    this.behind = 0;
    this.view.show(this.simulation, turned);
    this.written();
  }

  take(saved) {
    try {
      this.simulation.take(saved);
    } catch (problem) {
      this.tell(problem.message);
    }
  }

  /** Fly a log of the user's on a tether that is as long as the kite is far away at first. */
  async flyLog(file) {
    const log = await file.text();
    try {
      const { motion, duration } = flightOf(log);
      const { kite, ground } = motion(0);
      const initial_length = Number(norm(sub(kite, ground)).toPrecision(6));
      const scene = {
        title: file.name,
        about: `The flight of ${file.name}, which stays on this machine.`,
        file: file.name,
        kind: "log",
        log,
      };
      this.declared.scenes[OWN] = { ...scene, duration, flight: {}, parameters: { initial_length }, wind: {} };
    } catch (problem) {
      if (!(problem instanceof Refused)) throw problem;
      by("about").textContent = `${file.name}: ${problem.message}`;
      return;
    }
    by("scene").querySelector(`[value=${OWN}]`)?.remove();
    by("scene").append(new Option(file.name, OWN, true, true));
    by("scene").dispatchEvent(new Event("change"));
  }

  /** A setting was changed; restart : whether it counts from a start on only. */
  changed(restart) {
    if (restart) {
      const kinds = [this.settings.values.winch_control, this.settings.flight.autopilot];
      this.fly();
      if (String(kinds) !== this.kinds) this.controls.show(this.settings);
      this.kinds = String(kinds);
    } else this.written();
  }

  run(runs) {
    this.runs = runs;
    by("play").textContent = runs ? "pause" : "fly";
  }

  connect() {
    by("scene").addEventListener("change", () => {
      const shown = { shown: this.settings.shown, reference: this.settings.reference };
      this.settings = Object.assign(settingsOf(this.declared, by("scene").value), shown);
      this.fly(true);
      this.controls.show(this.settings);
      this.run(true);
    });
    by("speed").addEventListener("change", () => (this.settings.speed = Number(by("speed").value)));
    by("step").addEventListener("change", () => {
      this.settings.step = Number(by("step").value);
      this.fly();
    });
    const actions = {
      play: () => {
        if (!this.runs && this.isOver) this.fly();
        this.run(!this.runs);
      },
      restart: () => {
        this.fly();
        this.run(true);
      },
      save: () => this.save(),
      restore: () => this.restore(),
      link: () => this.copy(this.linkTo(changesOf(this.declared, this.settings)), "link copied"),
      exact: () => this.copy(this.linkTo(this.pairs()), "link copied"),
      download: () => this.download(),
    };
    for (const [id, action] of Object.entries(actions)) by(id).addEventListener("click", action);
    for (const button of document.querySelectorAll("[data-copy]")) {
      button.addEventListener("click", () => this.copy(by(button.dataset.copy).textContent, "copied"));
    }
    document.addEventListener("keydown", (event) => {
      if (
        /INPUT|SELECT|BUTTON|TEXTAREA|SUMMARY/.test(event.target.tagName) ||
        event.ctrlKey ||
        event.metaKey ||
        event.altKey
      )
        return;
      const left = () => this.steer(-STEERED),
        right = () => this.steer(STEERED);
      const action = { " ": actions.play, r: actions.restart, s: actions.save, l: actions.restore, a: left, d: right }[
        event.key
      ];
      if (action) {
        event.preventDefault();
        action();
      }
    });
    by("log").addEventListener("change", () => this.flyLog(by("log").files[0]));
    for (const [id, side] of [
      ["left", -1],
      ["right", 1],
    ]) {
      by(id).addEventListener("pointerdown", () => (this.settings.hand.steering = 0.6 * side));
      for (const name of ["pointerup", "pointerleave", "pointercancel"])
        by(id).addEventListener(name, () => (this.settings.hand.steering = 0));
    }
    window.addEventListener("hashchange", () => this.open(pairsIn(location.hash)));
    listen(by("view"), {
      turn: (azimuth, elevation) => this.view.camera.turn(azimuth, elevation),
      closer: (factor) => this.view.camera.closer(factor),
      lead: (x, y) => this.lead(x, y),
      steer: (change) => this.steer(change),
    });
  }

  /** Lead the kite to where the pointer is; false if it does not follow the pointer. */
  lead(x, y) {
    const { driver, settings } = this.simulation;
    if (settings.kind !== "pointer") return false;
    const [px, py, pz] = this.view.camera.onSphere([0, 0, 0], settings.flight.distance, x, y);
    driver.lead(Math.atan2(pz, Math.hypot(px, py)), Math.atan2(py, px));
    return true;
  }

  steer(change) {
    if (this.settings.kind !== "free" || this.settings.flight.autopilot !== 1) return false;
    this.settings.hand.steering = clamp(this.settings.hand.steering + change, -1, 1);
    return true;
  }

  /** Settings and state as pairs of a link. */
  pairs() {
    return [...changesOf(this.declared, this.settings), ...pairsOf(this.simulation.saved())];
  }

  /** Address of this page with pairs. */
  linkTo(pairs) {
    return addressWith([...pairs, ["view", this.view.camera.place()]]);
  }

  save() {
    this.kept = this.pairs();
    keep(this.kept);
    this.tell(`saved at ${this.simulation.time.toFixed(2)} s`);
  }

  restore() {
    const pairs = this.kept ?? kept();
    if (!pairs) return this.tell("nothing was saved");
    this.open(pairs);
    return this.tell(`restored at ${this.simulation.time.toFixed(2)} s`);
  }

  async copy(text, done) {
    this.copied = text;
    try {
      await navigator.clipboard.writeText(text);
      this.tell(done);
    } catch {
      window.prompt("Copy this:", text);
    }
  }

  download() {
    const blob = new Blob([by("toml").textContent], { type: "text/plain" });
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: "scene.toml" });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  tell(text) {
    by("done").textContent = text;
  }

  /** One frame: fly on, draw. */
  frame(now) {
    requestAnimationFrame((next) => this.frame(next));
    const passed = Math.min((now - this.last) / 1000, LONGEST_FRAME);
    this.fps += 0.05 * (1000 / Math.max(1, now - this.last) - this.fps);
    this.last = now;
    this.late = false;
    if (this.runs) this.goOn(passed, now);
    this.view.draw(this.simulation);
    if (now - this.charted > CHARTS_EVERY) {
      this.charts.draw(this.simulation);
      this.charted = now;
    }
    if (now - this.spoken > WORDS_EVERY) {
      this.speak();
      this.spoken = now;
    }
  }

  goOn(passed, now) {
    const { simulation, settings } = this;
    this.behind += passed * settings.speed;
    const began = performance.now();
    let measured = null;
    if (now - this.measured > MEASURE_EVERY) {
      this.measured = now;
      this.turn = ((this.turn ?? 0) + 1) % simulation.flown.length;
      measured = simulation.flown[this.turn];
    }
    while (this.behind >= simulation.step && simulation.goesOn) {
      simulation.advance(measured);
      measured = null;
      this.behind -= simulation.step;
      if (performance.now() - began > BUDGET) {
        this.late = this.behind >= simulation.step;
        this.behind = Math.min(this.behind, simulation.step);
      }
    }
    if (!simulation.goesOn || this.isOver) this.run(false);
  }

  /** Whether the scene has come to its end; most go on. */
  get isOver() {
    const { kind, duration } = this.settings;
    return ["launch", "landing", "log"].includes(kind) && this.simulation.time >= duration;
  }

  /** Write what does not change while it flies. */
  written() {
    writeSettings(this.simulation, (change) => {
      change(this.settings);
      this.fly();
    });
  }

  /** Write what changes while it flies. */
  speak() {
    const late = this.late ? ", slower than asked for" : "";
    writeNumbers(this.simulation, `${this.simulation.time.toFixed(1)} s${late}`, this.fps, this.view);
  }
}

async function main() {
  document.documentElement.classList.toggle("embedded", window.self !== window.top); // in a frame of the manual
  const declared = JSON.parse(by("declarations").textContent);
  const answer = await fetch("tetherfmu.wasm");
  if (!answer.ok) throw new Error(`the kernels, tetherfmu.wasm, are not there (status ${answer.status})`);
  const library = await libraryOf(await answer.arrayBuffer(), declared);
  by("blocked").hidden = true;
  by("app").hidden = false;
  window.tetherfmu = new Page(declared, library);
}

main().catch((problem) => {
  by("app").hidden = true;
  by("blocked").hidden = false;
  by("blocked").textContent = `The tethers cannot be flown here: ${problem.message}`;
  throw problem;
});
