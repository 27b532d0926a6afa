// Lines over time beside the picture, whose cursor is the time of the picture.

import uPlot from "uplot";

const HEIGHT = 230; // pixels, without the legend
const COLORS = ["#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#b07aa1", "#76b7b2", "#9c755f", "#edc948"];

/** A plot of several series of one unit over time. */
export class Plot {
  /**
   * @param {HTMLElement} element Where the plot goes.
   * @param {(time: number) => void} choose Called with the time at which a user clicks or drags.
   */
  constructor(element, choose) {
    this.element = element;
    this.choose = choose;
    new ResizeObserver(() => this.plot?.setSize(this.#size())).observe(element);
  }

  /** Draws series, each with name, unit and values at the times. */
  set(times, series, style) {
    this.plot?.destroy();
    this.times = times;
    const axis = { stroke: style.ink, grid: { stroke: style.line, width: 1 }, ticks: { stroke: style.line, width: 1 }, font: "11px system-ui" };
    const options = {
      ...this.#size(),
      legend: { show: true, live: true },
      cursor: { drag: { x: false, y: false, setScale: false }, points: { size: 6 } },
      scales: { x: { time: false } },
      axes: [{ ...axis, size: 28, values: (_, ticks) => ticks.map((tick) => `${tick} s`) }, { ...axis, size: 54 }],
      series: [
        { label: "t", value: (_, value) => (value == null ? "" : `${value.toFixed(3)} s`) },
        ...series.map((one, i) => ({
          label: one.name, stroke: COLORS[i % COLORS.length], width: 1.6, points: { show: false },
          value: (_, value) => (value == null ? "" : `${value.toPrecision(4)} ${one.unit}`),
        })),
      ],
      hooks: { ready: [(plot) => this.#follow(plot), () => this.setTime(this.time)], draw: [(plot) => this.#drawCursor(plot, style)] },
    };
    this.plot = new uPlot(options, [times, ...series.map((one) => one.values)], this.element);
  }

  /** Marks a time. */
  setTime(time) {
    this.time = time;
    if (!this.plot || time === undefined) return;
    const after = this.times.findIndex((one) => one >= time);
    this.plot.setLegend({ idx: after < 0 ? this.times.length - 1 : after });
    this.plot.redraw(false, false);
  }

  #size() {
    return { width: Math.max(160, this.element.clientWidth), height: HEIGHT };
  }

  #follow(plot) {
    const choose = (event) => {
      const left = event.clientX - plot.over.getBoundingClientRect().left;
      const [first, last] = [this.times[0], this.times[this.times.length - 1]];
      this.choose(Math.min(last, Math.max(first, plot.posToVal(left, "x"))));
    };
    plot.over.addEventListener("pointerdown", (event) => {
      plot.over.setPointerCapture(event.pointerId);
      choose(event);
      plot.over.addEventListener("pointermove", choose);
    });
    plot.over.addEventListener("pointerup", () => plot.over.removeEventListener("pointermove", choose));
  }

  #drawCursor(plot, style) {
    if (this.time === undefined) return;
    const { ctx, bbox } = plot;
    const x = Math.round(plot.valToPos(this.time, "x", true)) + 0.5;
    ctx.save();
    ctx.strokeStyle = style.accent;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }
}
