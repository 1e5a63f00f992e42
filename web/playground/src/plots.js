// Curves over time of what moves: energy, joints, torques, force of the floor.
import { $ } from "./panels.js";

const digits = (x) => (Math.abs(x) >= 1000 ? x.toFixed(0) : Math.abs(x) >= 10 ? x.toFixed(1) : x.toFixed(2));
const colours = ["#2f6fde", "#d8702a", "#128a4a", "#b0328f", "#8a6d00", "#1597a5"];

// Of many joints the six that range most have names and colours; the others are grey.
function ofJoints(history, names, key) {
  const range = names.map((_, k) => Math.max(...history.map((h) => h[key][k])) - Math.min(...history.map((h) => h[key][k])));
  const first = range.map((x, k) => [x, k]).sort((a, b) => b[0] - a[0]).slice(0, colours.length).map(([, k]) => k);
  return names.map((name, k) => ({ name: first.includes(k) ? name : "", colour: first.includes(k) ? colours[first.indexOf(k)] : "#8886",
    value: (h) => h[key][k] })).reverse();
}

const kinds = {
  energy: { unit: "J", curves: () => [{ name: "kinetic", colour: colours[1], value: (h) => h.kinetic },
    { name: "potential", colour: colours[0], value: (h) => h.potential },
    { name: "sum", colour: colours[2], value: (h) => h.kinetic + h.potential }] },
  joints: { unit: "rad or m", curves: (history, names) => ofJoints(history, names, "joints") },
  torques: { unit: "N m or N", curves: (history, names) => ofJoints(history, names, "torques") },
  force: { unit: "N", curves: (_, __, weight) => [{ name: "of the floor, upwards", colour: colours[2], value: (h) => h.up },
    { name: "weight", colour: "#888", value: () => weight }] },
};

// Draws what is chosen; without a history it is empty, whatever was there before.
export function drawPlot(history, robot) {
  const canvas = $("plot"), { clientWidth: width, clientHeight: height } = canvas, ratio = Math.min(2, devicePixelRatio);
  if (canvas.width !== width * ratio || canvas.height !== height * ratio) Object.assign(canvas, { width: width * ratio, height: height * ratio });
  const c = canvas.getContext("2d");
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, width, height);
  $("plotted").replaceChildren();
  if (history.length < 2 || !width) return;
  const { unit, curves } = kinds[$("curves").value], names = robot.motors().map((b) => b.joint ?? "");
  const list = curves(history, names, 9.81 * robot.model.mass), values = list.flatMap(({ value }) => history.map(value));
  const low = values.reduce((a, b) => Math.min(a, b), Infinity), high = Math.max(values.reduce((a, b) => Math.max(a, b), -Infinity), low + 1e-9);
  const first = history[0].t, last = history.at(-1).t, left = 52, top = 8, bottom = height - 18;
  const x = (h) => left + ((h.t - first) / (last - first)) * (width - left - 4), y = (v) => bottom - ((v - low) / (high - low)) * (bottom - top);
  const ink = getComputedStyle(document.body).color;
  c.font = "11px system-ui, sans-serif";
  c.fillStyle = ink;
  c.strokeStyle = "#8885";
  for (const v of [low, (low + high) / 2, high]) {
    c.beginPath();
    c.moveTo(left, y(v));
    c.lineTo(width - 4, y(v));
    c.stroke();
    c.textAlign = "right";
    c.fillText(digits(v), left - 5, Math.max(10, y(v) + 4));
  }
  c.textAlign = "left";
  c.fillText(`${first.toFixed(1)} s`, left, height - 4);
  c.textAlign = "right";
  c.fillText(`${last.toFixed(1)} s`, width - 4, height - 4);
  c.lineWidth = 1.5;
  for (const { colour, value } of list) {
    c.strokeStyle = colour;
    c.beginPath();
    for (const h of history) c.lineTo(x(h), y(value(h)));
    c.stroke();
  }
  const now = history.at(-1);
  $("plotted").append(...list.filter((k) => k.name).reverse().map(({ name, colour, value }) => {
    const item = document.createElement("span"), swatch = document.createElement("i");
    swatch.style.background = colour;
    item.append(swatch, `${name} ${digits(value(now))}`);
    return item;
  }), ` ${unit}`);
}
