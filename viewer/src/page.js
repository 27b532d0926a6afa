// A whole page: the picture, what is shown, sliders or a plot, and the clock.

import { addStyle, make, icon, toggle } from "./elements.js";
import { pointOf, poses } from "./kinematics.js";
import { Motion } from "./motion.js";
import { Player } from "./player.js";
import { Plot } from "./plot.js";
import { Sliders } from "./sliders.js";
import { CAMERAS, Stage } from "./stage.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5];
const LONGEST_PATH = 4000; // points of a path that are drawn
const WAVE = 60; // length of the motion through all ranges (s)

/**
 * Makes a page in an element and returns it.
 *
 * @param {HTMLElement} root Element that the page fills.
 * @param {object} data `scene`, `motion` or null, `subtitle`, names `paths`, and whether to `play` at once.
 */
export function page(root, data) {
  return new Page(root, data);
}

class Page {
  constructor(root, { scene, motion, subtitle = "", paths = [], play = false }) {
    addStyle();
    this.root = root;
    this.scene = scene;
    this.motion = motion && new Motion(scene, motion);
    this.isDark = matchMedia("(prefers-color-scheme: dark)").matches;
    root.classList.add("kg");
    const picture = make("div", { class: "kg-stage", role: "img", "aria-label": `Picture of ${scene.name}`, tabindex: 0 });
    this.tip = make("div", { class: "kg-tip", role: "tooltip", hidden: true });
    const aside = make("aside", { class: "kg-panel" });
    const main = make("main", { class: "kg-main" }, picture, this.#cameras(), this.#clock(), this.tip);
    root.replaceChildren(main, aside);
    try {
      this.stage = new Stage(picture, scene);
    } catch (error) {
      picture.append(make("p", { class: "kg-failure" }, `This browser draws no 3D pictures: ${error.message}`));
      return;
    }
    aside.append(this.#header(subtitle), this.#switches(), this.motion ? this.#plot() : this.#sliders(), this.#paths(paths), this.#notes());
    this.#setTheme(this.isDark);
    const isFar = this.motion ? this.stage.include(this.#samples(40)) : false;
    this.player.go(this.player.start);
    this.following.set(isFar);
    this.#drawPaths();
    this.#listen(picture);
    if (play && !matchMedia("(prefers-reduced-motion: reduce)").matches) this.player.play(true);
  }

  #header(subtitle) {
    const theme = make("button", { type: "button", class: "kg-icon", title: "Light or dark (T)", "aria-label": "Light or dark", onclick: () => this.#setTheme(!this.isDark) }, icon("theme"));
    return make("header", {}, make("div", {}, make("h1", {}, this.scene.name), make("p", {}, subtitle)), theme);
  }

  #cameras() {
    const names = Object.keys(CAMERAS);
    const buttons = names.map((name, i) => make("button", { type: "button", title: `Look from ${name} (${i + 1})`, onclick: () => this.stage.look(name) }, name));
    return make("div", { class: "kg-cameras", role: "group", "aria-label": "Camera" }, ...buttons);
  }

  #clock() {
    const { start, end } = this.motion ?? { start: 0, end: WAVE };
    this.player = new Player(start, end, { onTime: (time) => this.#show(time), onPlaying: (isPlaying) => this.#showPlaying(isPlaying) });
    this.playButton = make("button", { type: "button", class: "kg-play", title: "Play or pause (space)", "aria-label": "Play", onclick: () => this.player.play(!this.player.isPlaying) }, icon("play"));
    this.scrub = make("input", { type: "range", min: start, max: end, step: (end - start) / 2000, "aria-label": "Time, s" });
    this.scrub.addEventListener("input", () => this.#pauseAt(Number(this.scrub.value)));
    this.clock = make("output", { class: "kg-time" });
    const speed = make("select", { "aria-label": "Speed", title: "Speed", onchange: () => (this.player.speed = Number(speed.value)) }, ...SPEEDS.map((one) => make("option", { value: one, selected: one === 1 }, `${one}×`)));
    const hint = this.motion ? "" : "Play moves every joint through its range";
    return make("div", { class: "kg-clock", title: hint }, this.playButton, this.scrub, this.clock, speed);
  }

  #switches() {
    const stage = this.stage;
    const { springs, bodies } = this.scene;
    const stands = !stage.hasGeometry;
    const kinds = [
      ["geometry", "Geometry", true, stage.hasGeometry],
      ["inertia", "Inertia ellipsoids", stands, true],
      ["joints", "Joints and links", stands, true],
      ["frames", "Frames", false, true, "f"],
      ["names", "Names", false, true, "n"],
      ["weights", "Weights", false, this.scene.gravity.some(Boolean) && bodies.some((body) => body.mass > 0)],
      ["springs", "Springs", true, springs.length > 0],
      ["forces", "Forces", true, this.motion?.forces.length > 0],
      ["grid", "Ground", true, true],
    ].filter(([, , , isThere]) => isThere);
    this.keys = {};
    const chips = kinds.map(([what, text, isOn, , key]) => {
      const chip = toggle(text, isOn, (value) => stage.show(what, value), key ? { title: `${text} (${key.toUpperCase()})` } : {});
      if (key) this.keys[key] = chip;
      return chip;
    });
    this.following = toggle("Follow", false, (value) => stage.follow(value), { title: "The camera follows the mass centre" });
    chips.push(this.following);
    return make("section", { "aria-label": "Shown" }, make("h2", {}, "Show"), make("div", { class: "kg-chips" }, ...chips));
  }

  #sliders() {
    this.sliders = new Sliders(this.scene, () => this.stage.setState(...this.sliders.state()));
    return this.sliders.element;
  }

  #plot() {
    const groups = [...new Set(this.motion.series.map((one) => one.group))];
    const place = make("div", { class: "kg-plot" });
    this.plot = new Plot(place, (time) => this.#pauseAt(time));
    this.group = make("select", { "aria-label": "Quantities in the plot", onchange: () => this.#drawPlot() }, ...groups.map((one) => make("option", { value: one }, one)));
    return make("section", { "aria-label": "Plot" }, make("div", { class: "kg-heading" }, make("h2", {}, "Over time"), this.group), place);
  }

  #drawPlot() {
    const style = getComputedStyle(this.root);
    const [ink, line, accent] = ["--ink", "--line", "--accent"].map((name) => style.getPropertyValue(name).trim());
    const series = this.motion.series.filter((one) => one.group === this.group.value);
    this.plot.set(this.motion.times, series, { ink, line, accent });
    this.plot.setTime(this.player.time);
  }

  #paths(names) {
    const origins = this.scene.bodies.slice(1).map((body, i) => ({ name: body.name, body: i + 1, position: body.center }));
    const all = [...this.scene.points, ...origins, ...this.scene.frames.filter((frame) => frame.body)];
    this.traced = new Map();
    const places = new Map(all.map((place) => [place.name, place]).reverse());
    if (!this.motion) return make("span", { hidden: true });
    const chips = [...places.keys()].reverse().map((name) => {
      const isOn = names.includes(name);
      if (isOn) this.traced.set(name, places.get(name));
      return toggle(name, isOn, (value) => {
        if (value) this.traced.set(name, places.get(name));
        else this.traced.delete(name);
        this.#drawPaths();
      });
    });
    return make("details", { open: chips.length <= 12 }, make("summary", {}, "Paths of points"), make("div", { class: "kg-chips" }, ...chips));
  }

  #notes() {
    const keys = "Space plays, left and right step, 1 to 4 set the camera, F frames, N names, T colours. Drag turns, wheel zooms, right button shifts.";
    return make("details", {}, make("summary", {}, "About this picture"), ...[...this.scene.notes, keys].map((note) => make("p", {}, note)));
  }

  #setTheme(isDark) {
    this.isDark = isDark;
    this.root.dataset.theme = isDark ? "dark" : "light";
    this.stage.setTheme(this.root.dataset.theme);
    if (this.plot) this.#drawPlot();
  }

  #samples(count) {
    const { start, end } = this.motion;
    return Array.from({ length: count }, (_, i) => this.motion.state(start + ((end - start) * i) / (count - 1)));
  }

  #drawPaths() {
    if (!this.motion) return;
    const step = Math.max(1, Math.ceil(this.motion.times.length / LONGEST_PATH));
    const places = [...this.traced.values()];
    const paths = places.map(() => []);
    const all = poses(this.scene, this.scene.start);
    for (let row = 0; places.length && row < this.motion.times.length; row += step) {
      poses(this.scene, ...this.motion.state(this.motion.times[row]), all);
      places.forEach((place, i) => paths[i].push(pointOf(all, place.body, place.position)));
    }
    this.stage.setPaths(paths);
  }

  #pauseAt(time) {
    this.player.play(false);
    this.player.go(time);
  }

  #show(time) {
    if (!this.stage) return;
    this.scrub.value = time;
    this.clock.textContent = `${time.toFixed(2)} s`;
    if (!this.motion) {
      this.sliders.wave(time);
      return;
    }
    this.stage.setState(...this.motion.state(time));
    if (this.motion.forces.length) {
      this.stage.setForces(this.motion.forces.map((one) => ({ ...one, force: this.motion.force(one, time) })), this.#largestForce());
    }
    this.plot.setTime(time);
  }

  #largestForce() {
    this.largest ??= Math.max(...this.motion.forces.map(({ values }) => {
      let most = 0;
      for (let i = 0; i < values.length; i += 3) most = Math.max(most, Math.hypot(values[i], values[i + 1], values[i + 2]));
      return most;
    }));
    return this.largest;
  }

  #showPlaying(isPlaying) {
    this.playButton.replaceChildren(icon(isPlaying ? "pause" : "play"));
    this.playButton.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  }

  #listen(picture) {
    picture.addEventListener("pointermove", (event) => this.#hover(event));
    picture.addEventListener("pointerleave", () => (this.tip.hidden = true));
    this.root.ownerDocument.addEventListener("keydown", (event) => this.#press(event));
  }

  #hover(event) {
    const body = event.buttons ? null : this.stage.under(event.clientX, event.clientY);
    this.tip.hidden = !body;
    if (!body) return;
    const frame = this.root.getBoundingClientRect();
    const joint = body.joint_name ? `joint ${body.joint_name}` : "";
    const mass = body.mass > 0 ? `${Number(body.mass.toPrecision(4))} kg` : "";
    this.tip.replaceChildren(make("b", {}, body.name), ...[joint, mass].filter(Boolean).map((text) => make("span", {}, text)));
    this.tip.style.left = `${event.clientX - frame.left + 14}px`;
    this.tip.style.top = `${event.clientY - frame.top + 14}px`;
  }

  #press(event) {
    const isTyping = ["INPUT", "SELECT", "TEXTAREA", "BUTTON"].includes(event.target.tagName);
    if (event.ctrlKey || event.metaKey || event.altKey || (isTyping && event.target.type !== "range")) return;
    const step = (this.player.end - this.player.start) / 200;
    const key = event.key.toLowerCase();
    const camera = Object.keys(CAMERAS)[Number(key) - 1];
    if (key === " ") this.player.play(!this.player.isPlaying);
    else if (camera) this.stage.look(camera);
    else if (key === "t") this.#setTheme(!this.isDark);
    else if (this.keys[key]) this.keys[key].click();
    else if (isTyping) return;
    else if (key === "arrowright") this.#pauseAt(this.player.time + step);
    else if (key === "arrowleft") this.#pauseAt(this.player.time - step);
    else if (key === "home") this.#pauseAt(this.player.start);
    else if (key === "end") this.#pauseAt(this.player.end);
    else return;
    event.preventDefault();
  }
}
