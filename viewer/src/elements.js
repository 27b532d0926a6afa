// Elements of a page. Names of a model become text, never markup.

import css from "uplot/dist/uPlot.min.css";
import style from "./style.css";

/** Adds the style of pages to the document, once. */
export function addStyle() {
  if (!document.getElementById("kg-style")) document.head.append(make("style", { id: "kg-style" }, css, style));
}

/** Returns an element with attributes, listeners (`onclick`) and children, which are elements or texts. */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value !== false && value != null) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children);
  return element;
}

const ICONS = {
  play: "M7 4.5v15l12-7.5z",
  pause: "M6 5h4v14H6zM14 5h4v14h-4z",
  start: "M6 5h2.5v14H6zM19 5v14L9.5 12z",
  theme: "M12 3a9 9 0 1 0 0 18a9 9 0 0 0 0-18zM12 5a7 7 0 0 1 0 14z",
  panel: "M4 6h16v2H4zM4 11h16v2H4zM4 16h16v2H4z",
};

/** Returns an icon by its name. */
export function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

/** Returns a button that is on or off and calls `change` with which of the two. */
export function toggle(text, isOn, change, attributes = {}) {
  const button = make("button", { type: "button", class: "kg-chip", "aria-pressed": String(isOn), ...attributes }, text);
  button.set = (value) => {
    button.setAttribute("aria-pressed", String(value));
    change(value);
  };
  button.addEventListener("click", () => button.set(button.getAttribute("aria-pressed") !== "true"));
  return button;
}

/** Returns a number as short text with its unit. */
export function withUnit(value, unit) {
  const text = Math.abs(value) >= 1e4 || (value !== 0 && Math.abs(value) < 1e-3) ? value.toExponential(2) : value.toFixed(3);
  return unit === "1" ? text : `${text} ${unit}`;
}
