// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers beside the picture.
import type { Curve } from "./charts";
import { byId, setText } from "./dom";
import type { Head } from "./glb";
import type { Health, Hello, TouchState } from "./link";
import type { Pick } from "./pick";

const blend = (column: Float32Array, vertices: number[], weights: number[]): number => {
  let sum = 0;
  for (let k = 0; k < 3; ++k) {
    if (column[vertices[k]] < 0) return NaN;
    sum += weights[k] * column[vertices[k]];
  }
  return sum;
};

/** Force of one vertex at a depth, from the samples; the last slope goes on. */
export function forceAt(head: Head, vertex: number, depth: number): number {
  const { forces, travel } = head;
  let f0 = 0;
  let u0 = 0;
  for (let i = 0; i < forces.length; ++i) {
    const u = travel[i][vertex];
    if (depth < u || i === forces.length - 1) return f0 + ((depth - u0) / (u - u0)) * (forces[i] - f0);
    f0 = forces[i];
    u0 = u;
  }
  return NaN;
}

/** The curve at a picked point; null where a corner has none. */
function pickedCurve(head: Head, p: Pick): Curve | null {
  const last = head.travel[head.travel.length - 1];
  const deepest = 1.2 * blend(last, p.vertices, p.weights);
  if (Number.isNaN(deepest)) return null;
  const depth: number[] = [];
  const force: number[] = [];
  for (let i = 0; i <= 40; ++i) {
    const d = (deepest * i) / 40;
    depth.push(d);
    force.push(p.vertices.reduce((sum, v, k) => sum + p.weights[k] * forceAt(head, v, d), 0));
  }
  const error = blend(head.error, p.vertices, p.weights);
  return { depth, force, error: Number.isNaN(error) ? 0 : error };
}

function touchedCurve(head: Head, s: TouchState): Curve {
  const n = s.curve.length;
  const error = blend(head.error, s.vertices, s.weights);
  return {
    depth: Array.from(s.curve, (_, i) => (s.curveDeepest * i) / (n - 1)),
    force: Array.from(s.curve),
    error: s.estimated || Number.isNaN(error) ? 0 : error,
  };
}

function showNumber(id: string, value: number): void {
  const element = byId(id);
  element.textContent = value.toFixed(2);
  element.dataset.value = String(value); // all digits, for tests and for reading off
}

/** Shows the touched point, else the one under the pointer; gives its curve. */
export function fillReadings(head: Head | null, hello: Hello | null, state: TouchState | null,
                             hover: Pick | null): Curve | null {
  const touching = state?.inContact ?? false;
  showNumber("force", touching ? state!.mapForce * (hello?.scale ?? 1) : 0);
  showNumber("depth", touching ? state!.depth : 0);
  setText("curve-title", touching ? "Curve of the touched point" : "Curve under the pointer");
  if (!head || !hello || (!touching && !hover)) {
    for (const id of ["region", "slope", "tissue", "status"]) setText(id, "–");
    return null;
  }
  const vertices = touching ? state!.vertices : hover!.vertices;
  const weights = touching ? state!.weights : hover!.weights;
  const nearest = vertices[weights.indexOf(Math.max(...weights))];
  const region = touching ? state!.region : head.region[nearest];
  setText("region", hello.region_names[region] ?? "–");
  setText("slope", touching ? `${state!.stiffness.toFixed(2)} N/mm` : "–");
  const depth = blend(head.depth, vertices, weights);
  setText("tissue", Number.isNaN(depth) ? "no bone below" : `${depth.toFixed(1)} mm`);
  const status = head.statusNames[head.status[nearest]];
  const error = blend(head.error, vertices, weights);
  const estimated = touching ? state!.estimated : status !== "solved" && status !== "blended";
  setText("status", estimated ? `from neighbours (${status.replace("_", " ")})`
    : Number.isNaN(error) || error === 0 ? status : `${status}, ±${(100 * error).toFixed(1)} %`);
  return touching ? touchedCurve(head, state!) : pickedCurve(head, hover!);
}

export function showHello(hello: Hello): void {
  setText("head-name", hello.head);
  const d = hello.device;
  setText("device", hello.pointer ? d.name
    : `${d.name}${d.serial ? ` (${d.serial})` : ""}, ${d.peak_n.toFixed(1)} N`);
  byId("help-pointer").hidden = !hello.pointer;
  byId("recording-row").hidden = hello.recording === "";
}

export function showHealth(health: Health, hello: Hello | null): void {
  setText("rate", `${(health.rate_hz / 1000).toFixed(health.rate_hz % 1000 ? 1 : 0)} kHz, ${health.ticks.toLocaleString("en")} ticks`);
  setText("late", `${health.late_p999_us.toFixed(0)} µs; ${(100 * health.late_above_1ms).toFixed(2)} % over 1 ms`);
  setText("tick", `${health.tick_p999_us.toFixed(1)} µs`);
  const trips = Object.entries(health.trips).filter(([name, n]) => n > 0 && name !== "paused" && name !== "clutch");
  setText("watchdog", health.device !== "ok" && !(hello?.pointer && health.device === "waiting")
    ? `device ${health.device}${health.trouble ? `: ${health.trouble}` : ""}`
    : trips.map(([name, n]) => `${n} × ${name}`).join(", ") || "never acted");
  if (health.recorder) {
    const r = health.recorder;
    setText("recording", r.error || `${r.written.toLocaleString("en")} ticks${r.dropped ? `, ${r.dropped} lost` : ""}`);
  }
  const warnings = [...(hello?.warnings ?? []), ...health.warnings];
  const list = byId("warnings");
  if (list.dataset.text === warnings.join("\n")) return;
  list.dataset.text = warnings.join("\n");
  list.replaceChildren(...warnings.map((w) => Object.assign(document.createElement("li"), { textContent: w })));
}
