// SPDX-License-Identifier: GPL-3.0-or-later
// The two charts: force over depth at the touched point, and force and depth over time.

interface Ink {
  text: string;
  faint: string;
  line: string;
  force: string;
  depth: string;
}

function ink(): Ink {
  const style = getComputedStyle(document.documentElement);
  const of = (name: string) => style.getPropertyValue(name).trim();
  return { text: of("--muted"), faint: of("--grid"), line: of("--text"), force: of("--force"), depth: of("--depth") };
}

/** A sharp canvas of its own size in CSS pixels. */
function prepare(canvas: HTMLCanvasElement): [CanvasRenderingContext2D, number, number] {
  const ratio = Math.min(2, window.devicePixelRatio);
  const w = canvas.clientWidth;
  const h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
  }
  const c = canvas.getContext("2d")!;
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, w, h);
  c.font = "11px system-ui, sans-serif";
  return [c, w, h];
}

/** 1, 2 or 5 times a power of ten, for about `count` steps. */
export function niceStep(span: number, count: number): number {
  const raw = span / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const lead = raw / power;
  return (lead > 5 ? 10 : lead > 2 ? 5 : lead > 1 ? 2 : 1) * power;
}

const label = (x: number) => String(Number(x.toPrecision(6)));

export interface Curve {
  depth: number[];
  force: number[];
  /** relative error of the travel, 0 where unknown */
  error: number;
}

export function drawCurve(canvas: HTMLCanvasElement, curve: Curve | null, at: [number, number] | null): void {
  const [c, w, h] = prepare(canvas);
  const colors = ink();
  const left = 34, right = 8, top = 10, bottom = 30;
  const xMax = curve && curve.depth.length ? Math.max(1, curve.depth[curve.depth.length - 1]) : 5;
  const yMax = curve && curve.force.length ? Math.max(1, curve.force[curve.force.length - 1]) : 5;
  const x = (d: number) => left + (d / xMax) * (w - left - right);
  const y = (f: number) => h - bottom - (f / yMax) * (h - top - bottom);
  c.strokeStyle = colors.faint;
  c.fillStyle = colors.text;
  c.lineWidth = 1;
  c.textAlign = "right";
  c.textBaseline = "middle";
  const fs = niceStep(yMax, 4);
  for (let f = 0; f <= yMax + 1e-9; f += fs) {
    line(c, left, y(f), w - right, y(f));
    c.fillText(label(f), left - 5, y(f));
  }
  c.textAlign = "center";
  c.textBaseline = "top";
  const ds = niceStep(xMax, 5);
  for (let d = 0; d <= xMax + 1e-9; d += ds) c.fillText(label(d), x(d), h - bottom + 4);
  c.textAlign = "right";
  c.fillText("depth [mm]", w - right, h - 13);
  c.textAlign = "left";
  c.fillText("force [N]", left + 4, top - 8);
  if (!curve) return;
  c.save();
  c.beginPath();
  c.rect(left, top - 4, w - left - right + 4, h - top - bottom + 4);
  c.clip();
  if (curve.error > 0) {
    c.fillStyle = colors.force;
    c.globalAlpha = 0.15;
    c.beginPath();
    curve.depth.forEach((d, i) => c.lineTo(x(d * (1 - curve.error)), y(curve.force[i])));
    for (let i = curve.depth.length - 1; i >= 0; --i)
      c.lineTo(x(curve.depth[i] * (1 + curve.error)), y(curve.force[i]));
    c.fill();
    c.globalAlpha = 1;
  }
  c.strokeStyle = colors.force;
  c.lineWidth = 2;
  c.beginPath();
  curve.depth.forEach((d, i) => c.lineTo(x(d), y(curve.force[i])));
  c.stroke();
  c.restore();
  if (!at) return;
  c.strokeStyle = colors.text;
  c.lineWidth = 1;
  c.setLineDash([3, 3]);
  line(c, x(at[0]), y(at[1]), x(at[0]), h - bottom);
  line(c, left, y(at[1]), x(at[0]), y(at[1]));
  c.setLineDash([]);
  c.fillStyle = colors.force;
  c.strokeStyle = colors.line;
  c.lineWidth = 1.5;
  c.beginPath();
  c.arc(x(at[0]), y(at[1]), 5, 0, 2 * Math.PI);
  c.fill();
  c.stroke();
}

function line(c: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number): void {
  c.beginPath();
  c.moveTo(x0, Math.round(y0) + 0.5);
  c.lineTo(x1, Math.round(y1) + 0.5);
  c.stroke();
}

/** Force and depth over the last seconds, one strip each on a common time axis. */
export class StripChart {
  private readonly time: number[] = [];
  private readonly force: number[] = [];
  private readonly depth: number[] = [];
  constructor(private readonly canvas: HTMLCanvasElement, readonly seconds = 10) {}

  add(time: number, force: number, depth: number): void {
    if (this.time.length && time < this.time[this.time.length - 1]) this.clear();
    this.time.push(time);
    this.force.push(force);
    this.depth.push(depth);
    let old = 0;
    while (this.time[old] < time - this.seconds) ++old;
    for (const column of [this.time, this.force, this.depth]) column.splice(0, old);
  }
  clear(): void {
    this.time.length = this.force.length = this.depth.length = 0;
  }
  /** Something else than rest to be seen. */
  get lively(): boolean {
    return this.force.some((f) => f > 0);
  }

  draw(): void {
    const [c, w, h] = prepare(this.canvas);
    const colors = ink();
    const half = (h - 16) / 2;
    this.strip(c, colors, this.force, colors.force, "force [N]", 0, w, half);
    this.strip(c, colors, this.depth, colors.depth, "depth [mm]", half, w, half);
    c.fillStyle = colors.text;
    c.textBaseline = "bottom";
    c.textAlign = "left";
    c.fillText(`−${this.seconds} s`, 34, h);
    c.textAlign = "right";
    c.fillText("now", w - 8, h);
  }

  private strip(c: CanvasRenderingContext2D, colors: Ink, values: number[], color: string, name: string,
                top: number, w: number, height: number): void {
    const left = 34, right = 8, pad = 15;
    const highest = Math.max(1, ...values);
    const step = niceStep(highest, 2);
    const most = step * Math.ceil(highest / step - 1e-9); // the axis ends at a label
    const now = this.time[this.time.length - 1] ?? 0;
    const y = (v: number) => top + height - 4 - (Math.max(0, v) / most) * (height - pad - 4);
    c.strokeStyle = colors.faint;
    c.lineWidth = 1;
    c.fillStyle = colors.text;
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (let v = 0; v <= most + 1e-9; v += step) {
      line(c, left, y(v), w - right, y(v));
      c.fillText(label(v), left - 5, y(v));
    }
    c.textAlign = "left";
    c.textBaseline = "top";
    c.fillText(name, left + 4, top + 1);
    c.strokeStyle = color;
    c.lineWidth = 1.75;
    c.beginPath();
    values.forEach((v, i) => c.lineTo(w - right - ((now - this.time[i]) / this.seconds) * (w - left - right), y(v)));
    c.stroke();
  }
}
