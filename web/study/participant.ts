// SPDX-License-Identifier: GPL-3.0-or-later
// What a participant sees and answers; keys alone are enough. The page knows only what it shows.
import { byId, Channel, make } from "./channel";
import type { Picture } from "./picture";

interface Question {
  type: "choice" | "number" | "text" | "rating";
  text: string;
  options: { id: string; text: string }[];
  least: number;
  most: number;
  step: number;
  low: string;
  high: string;
  optional: boolean;
}
interface View {
  kind: "waiting" | "text" | "consent" | "question" | "touch" | "choose" | "finished" | "excused";
  number: number;
  title: string;
  text: string;
  place: number;
  places: number;
  interval: number;
  picture: boolean;
  paused: boolean;
  simulated: boolean;
  error: string;
  question?: Question;
  choose?: number;
  barred?: number[];
  ready?: boolean;
  left_s?: number | null;
}

const form = byId<HTMLFormElement>("screen");
const canvas = byId<HTMLCanvasElement>("picture");
let view: View | null = null;
let shown = ""; // what the form was built for
let value = ""; // of the answer being given
let picture: Picture | null = null;
let given: { number: number; value: string } | null = null; // the answer that no screen has followed yet
let lost = false; // the connection, since the last view

const channel = new Channel<View>("/study/participant", {
  view: show,
  frame: (numbers) => picture?.show(numbers),
  connected: (on) => {
    lost ||= !on;
    byId("link").textContent = on ? "" : "connection lost, trying again";
  },
});

function answer(what: string): void {
  if (!view) return;
  given = { number: view.number, value: what };
  channel.send(given);
}

function button(text: string, key = "Enter"): HTMLButtonElement {
  return make("button", { type: "submit", class: "main" }, `${text} `, make("kbd", {}, key));
}
function paragraph(text: string, name = ""): HTMLParagraphElement {
  return make("p", name ? { class: name } : {}, text);
}

function choices(options: { id: string; text: string; off?: boolean }[], many: boolean): HTMLElement {
  const list = make("div", { class: many ? "places" : "" });
  options.forEach((o, i) => {
    const input = make("input", { type: many ? "checkbox" : "radio", name: "answer", value: o.id });
    input.disabled = o.off ?? false;
    input.addEventListener("change", () => {
      const on = [...list.querySelectorAll<HTMLInputElement>("input:checked")];
      value = on.map((x) => x.value).join(",");
    });
    list.append(make("label", { class: "option" }, input, many ? o.text : make("span", {}, make("kbd", {}, `${i + 1}`), ` ${o.text}`)));
  });
  return list;
}

/** Numbers to press, half steps with the arrows. */
function scale(q: Question): HTMLElement[] {
  const row = make("div", { class: "scale", role: "group" });
  const output = make("output", { class: "value" });
  const set = (x: number) => {
    value = String(x);
    output.textContent = value;
    for (const b of row.querySelectorAll("button")) b.setAttribute("aria-pressed", String(b.value === value));
  };
  for (let x = q.least; x <= q.most; ++x) {
    const b = make("button", { type: "button", value: `${x}`, tabindex: "-1" }, `${x}`);
    b.addEventListener("click", () => set(x));
    row.append(b);
  }
  rate = (key: string) => {
    const now = value === "" ? NaN : Number(value);
    if (/^[0-9]$/.test(key)) {
      const x = key === "0" ? 10 : Number(key);
      if (x >= q.least && x <= q.most) set(x);
    } else if (key === "ArrowRight" || key === "ArrowLeft") {
      const next = Number.isNaN(now) ? q.least : now + (key === "ArrowRight" ? q.step : -q.step);
      if (next >= q.least && next <= q.most) set(next);
    }
  };
  const halves = q.step < 1 ? ` Arrows go in steps of ${q.step}.` : "";
  return [row, make("div", { class: "ends" }, make("span", {}, `${q.least}: ${q.low}`), make("span", {}, `${q.most}: ${q.high}`)),
    output, paragraph(`Keys 1 to 9, 0 for ten.${halves}`, "note")];
}
let rate: ((key: string) => void) | null = null;

function questionParts(q: Question): HTMLElement[] {
  const legend = make("legend", {}, q.text);
  if (q.type === "choice") return [make("fieldset", {}, legend, choices(q.options, false)), button("Next")];
  if (q.type === "rating") return [make("fieldset", {}, legend, ...scale(q)), button("Next")];
  const input = q.type === "number"
    ? make("input", { type: "number", min: `${q.least}`, max: `${q.most}`, step: `${q.step}`, "aria-label": q.text })
    : make("textarea", { rows: "3", maxlength: "2000", "aria-label": q.text });
  input.addEventListener("input", () => (value = input.value));
  const note = q.type === "text" ? paragraph("Ctrl+Enter goes on.", "note") : "";
  return [make("fieldset", {}, legend, input), ...(note ? [note] : []), button("Next", q.type === "text" ? "Ctrl+Enter" : "Enter")];
}

function touchParts(v: View): HTMLElement[] {
  const of = v.interval > 0 ? `Press ${v.interval === 1 ? "one" : "two"}` : `Place ${v.place} of ${v.places}`;
  return [make("div", { class: "touching" }, paragraph(of, "count"), paragraph("Feel how stiff it is.", ""),
    make("p", { class: "note", id: "left" }), button("I have felt it", "Space"))];
}

function build(v: View): void {
  value = "";
  rate = null;
  const parts: HTMLElement[] = [];
  if (v.title) parts.push(make("h1", {}, v.title));
  const place = v.kind === "question" && v.place > 0 && v.places > 0;
  if (place) parts.push(paragraph(`Place ${v.place} of ${v.places}`, "note"));
  if (v.text) parts.push(paragraph(v.text));
  if (v.kind === "waiting") parts.push(paragraph("Please wait for the experimenter."));
  if (v.kind === "text") parts.push(button("Go on"));
  if (v.kind === "consent")
    parts.push(choices([{ id: "given", text: "I have signed the sheet and take part" }, { id: "refused", text: "I do not take part" }], false), button("Go on"));
  if (v.kind === "question" && v.question) parts.push(...questionParts(v.question));
  if (v.kind === "touch") parts.push(...touchParts(v));
  if (v.kind === "choose")
    parts.push(choices(Array.from({ length: v.places }, (_, i) => ({ id: `${i + 1}`, text: `${i + 1}`, off: v.barred?.includes(i + 1) })), true),
      paragraph("Press the numbers of the places; again to take one back.", "note"), button("Next"));
  form.replaceChildren(...parts, make("p", { class: "error", id: "error", role: "alert" }));
  if (v.paused) form.replaceChildren(make("h1", {}, "Pause"), paragraph("Take your time. The experimenter goes on when you are ready."));
  form.querySelector<HTMLElement>("textarea, input[type=number]")?.focus();
}

function show(v: View): void {
  view = v;
  // An answer given while the connection was away is given again; the program knows it by its number.
  if (given && (v.number !== given.number || v.error)) given = null;
  if (given && lost) channel.send(given);
  lost = false;
  byId("simulated").hidden = !v.simulated;
  const wanted = `${v.kind} ${v.number} ${v.paused}`;
  if (wanted !== shown) build(v);
  shown = wanted;
  const error = document.getElementById("error");
  if (error) error.textContent = v.error ?? "";
  const left = document.getElementById("left");
  if (left) left.textContent = typeof v.left_s === "number" ? `${v.left_s} s` : "";
  const main = form.querySelector<HTMLButtonElement>("button.main");
  if (main && v.kind === "touch") main.disabled = !v.ready;
  byId("keys").textContent = v.kind === "waiting" || v.kind === "finished" || v.kind === "excused" ? "" : "Esc: pause";
  void showPicture(v.picture && !v.paused);
  document.documentElement.dataset.screen = `${v.kind} ${v.number}`;
}

async function showPicture(on: boolean): Promise<void> {
  canvas.hidden = !on;
  if (!on) return;
  const { Picture } = await import("./picture");
  picture ??= new Picture(canvas);
  await picture.load();
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  answer(value);
});

document.addEventListener("keydown", (event) => {
  if (!view || event.altKey || event.metaKey) return;
  const typing = document.activeElement?.matches("textarea, input[type=number]") ?? false;
  if (event.key === "Escape") return channel.send({ do: "pause" });
  if (event.key === "Enter" && (event.ctrlKey || !document.activeElement?.matches("textarea"))) {
    event.preventDefault();
    if (view.kind === "touch" && !view.ready) return;
    return answer(value);
  }
  if (typing || event.ctrlKey) return;
  if (event.key === " " && view.kind === "touch") {
    event.preventDefault();
    if (view.ready) answer("done");
    return;
  }
  if (rate) {
    if (event.key.startsWith("Arrow")) event.preventDefault();
    return rate(event.key);
  }
  const inputs = [...form.querySelectorAll<HTMLInputElement>("label.option input")];
  const picked = inputs[Number(event.key) - 1];
  if (/^[1-9]$/.test(event.key) && picked && !picked.disabled) picked.click();
});
