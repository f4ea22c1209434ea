// SPDX-License-Identifier: GPL-3.0-or-later
// Landmarks as labelled points on the skin, which a hand or keys move over it.
import type { Head, Landmark, Surface, Vec3 } from "./glb";
import { pick } from "./pick";
import type { View } from "./view";

const NEAR = 12; // mm around a point whose skin says which way it faces
const NUDGE = 0.5; // mm a key
const FINE = 0.1; // mm with Shift
const REACH = 8; // mm above and below a nudged point in which its skin is looked for
const COVER = 6; // mm of head before a point that hide it; some lie below the skin
const REST_MS = 150;
const MOST_UNDO = 200;

export interface Mark extends Landmark {
  /** where the file has it */
  origin: Vec3;
  normal: Vec3;
  history: Vec3[];
  /** something else of the head lies before it, as seen when the picture last rested */
  covered: boolean;
  button: HTMLButtonElement;
  ghost: HTMLElement;
}

export interface MarksSide {
  /** a point was moved, or chosen */
  changed(mark: Mark): void;
}

export const words = (name: string): string => name.replaceAll("_", " ");
const apart = (a: Vec3, b: Vec3): number => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
/** mm from where the file has it */
export const movedBy = (mark: Mark): number => apart(mark.position, mark.origin);

/** Of the point on which its name is written, so that a face's names seldom cover each other. */
function side({ name, position }: Landmark): string {
  if (name.includes("inner") || name === "stomion") return "below";
  return position[0] < -3 ? "right" : "left";
}

/** Mean normal of the skin around a place. */
function facing(skin: Surface, at: Vec3): Vec3 {
  const { positions: p, normals: n } = skin;
  const sum: Vec3 = [0, 0, 0];
  for (let i = 0; i < p.length; i += 3) {
    const [x, y, z] = [p[i] - at[0], p[i + 1] - at[1], p[i + 2] - at[2]];
    if (x * x + y * y + z * z > NEAR * NEAR) continue;
    for (let k = 0; k < 3; ++k) sum[k] += n[i + k];
  }
  const length = Math.hypot(...sum);
  return length > 0 ? [sum[0] / length, sum[1] / length, sum[2] / length] : [0, 0, 1];
}

export class Marks {
  readonly all: Mark[] = [];
  chosen: Mark | null = null;
  private shown = false;
  private rest = 0;

  constructor(private readonly layer: HTMLElement, private readonly view: View, private readonly head: Head,
              names: Set<string>, private readonly side: MarksSide) {
    for (const landmark of head.landmarks) if (names.has(landmark.name)) this.add(landmark);
  }

  private add(landmark: Landmark): void {
    const button = document.createElement("button");
    button.type = "button";
    button.className = `mark ${side(landmark)}`;
    const label = Object.assign(document.createElement("span"), { textContent: words(landmark.name) });
    button.append(document.createElement("i"), label);
    const ghost = Object.assign(document.createElement("div"), { className: "ghost", hidden: true });
    const mark: Mark = { ...landmark, origin: landmark.position, normal: facing(this.head.skin, landmark.position),
                         history: [], covered: false, button, ghost };
    button.addEventListener("focus", () => this.choose(mark));
    button.addEventListener("pointerdown", (e) => this.drag(mark, e));
    button.addEventListener("keydown", (e) => this.key(mark, e));
    this.layer.append(ghost, button);
    this.all.push(mark);
    this.name(mark);
  }

  show(on: boolean): void {
    this.shown = on;
    this.layer.hidden = !on;
    if (on) this.place();
  }

  /** After each frame: where the points are in the picture. */
  place(): void {
    if (!this.shown) return;
    const box = this.layer.getBoundingClientRect();
    const eye = this.view.eye();
    for (const mark of this.all) {
      const [x, y] = this.view.place(mark.position);
      const toEye = [eye[0] - mark.position[0], eye[1] - mark.position[1], eye[2] - mark.position[2]];
      const faces = !mark.covered && toEye.reduce((sum, d, k) => sum + d * mark.normal[k], 0) > 0;
      mark.button.classList.toggle("behind", !faces);
      mark.button.style.transform = `translate(${x - box.left}px, ${y - box.top}px)`;
      mark.ghost.hidden = !faces || movedBy(mark) < 0.05;
      if (mark.ghost.hidden) continue;
      const [gx, gy] = this.view.place(mark.origin);
      mark.ghost.style.transform = `translate(${gx - box.left}px, ${gy - box.top}px)`;
    }
    clearTimeout(this.rest);
    this.rest = window.setTimeout(() => this.uncover(), REST_MS);
  }

  /** Which points the head itself covers; too slow for every frame of a large one. */
  private uncover(): void {
    const eye = this.view.eye();
    let changed = false;
    for (const mark of this.all) {
      const to = mark.position.map((x, k) => x - eye[k]) as Vec3;
      const far = Math.hypot(...to);
      const hit = pick(this.head.skin, eye, to.map((x) => x / far) as Vec3);
      const covered = mark !== this.chosen && hit !== null && hit.distance < far - COVER;
      changed ||= covered !== mark.covered;
      mark.covered = covered;
    }
    if (changed) this.place();
  }

  choose(mark: Mark): void {
    if (this.chosen === mark) return;
    this.chosen?.button.classList.remove("chosen");
    this.chosen = mark;
    mark.button.classList.add("chosen");
    this.side.changed(mark);
  }

  /** Turns the head so that the point is seen, and gives it the keys. */
  goTo(mark: Mark): void {
    const eye = this.view.eye();
    const to = [eye[0] - mark.position[0], eye[1] - mark.position[1], eye[2] - mark.position[2]];
    const straight = to.reduce((sum, d, k) => sum + d * mark.normal[k], 0) / Math.hypot(...to);
    if (straight < 0.35) this.view.lookFrom(mark.normal);
    mark.button.focus({ preventScroll: true });
  }

  undo(mark: Mark): void {
    const before = mark.history.pop();
    if (before) this.put(mark, before);
  }
  reset(mark: Mark): void {
    if (movedBy(mark) > 0) this.move(mark, mark.origin);
  }
  /** Puts a point somewhere; undo brings it back. */
  move(mark: Mark, to: Vec3): void {
    mark.history.push(mark.position);
    if (mark.history.length > MOST_UNDO) mark.history.shift();
    this.put(mark, to);
  }

  private put(mark: Mark, to: Vec3): void {
    mark.position = to;
    mark.normal = facing(this.head.skin, to);
    this.name(mark);
    this.place();
    this.side.changed(mark);
  }

  private name(mark: Mark): void {
    const mm = movedBy(mark);
    mark.button.classList.toggle("moved", mm > 0);
    mark.button.setAttribute("aria-label",
      `${words(mark.name)}${mm > 0 ? `, moved ${mm.toFixed(1)} mm` : ""}; arrow keys move it`);
  }

  private drag(mark: Mark, e: PointerEvent): void {
    if (e.button !== 0) return;
    e.preventDefault();
    mark.button.focus({ preventScroll: true });
    mark.button.setPointerCapture(e.pointerId);
    const [x, y] = this.view.place(mark.position);
    const [dx, dy] = [x - e.clientX, y - e.clientY]; // the point does not jump to the finger
    const before = mark.position;
    const move = (m: PointerEvent) => {
      const { origin, direction } = this.view.ray(m.clientX + dx, m.clientY + dy);
      const at = pick(this.head.skin, origin, direction);
      if (at) this.put(mark, at.point);
    };
    const end = () => {
      mark.button.removeEventListener("pointermove", move);
      if (mark.position !== before) mark.history.push(before);
      this.side.changed(mark);
    };
    mark.button.addEventListener("pointermove", move);
    for (const over of ["pointerup", "pointercancel"] as const)
      mark.button.addEventListener(over, end, { once: true });
  }

  private key(mark: Mark, e: KeyboardEvent): void {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const steps: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
    };
    if (e.key in steps) this.nudge(mark, steps[e.key], e.shiftKey ? FINE : NUDGE);
    else if (e.key === "Backspace") this.undo(mark);
    else if (e.key === "Delete") this.reset(mark);
    else return;
    e.preventDefault();
    e.stopPropagation();
  }

  /** Over the skin, as seen: the place is stepped in the picture's plane, the skin found below it. */
  private nudge(mark: Mark, [right, up]: [number, number], mm: number): void {
    const axes = this.view.axes();
    const from = [0, 1, 2].map((k) =>
      mark.position[k] + mm * (right * axes.right[k] + up * axes.up[k]) + REACH * axes.back[k]) as Vec3;
    const at = pick(this.head.skin, from, axes.back.map((x) => -x) as Vec3);
    if (at && at.distance < 2 * REACH) this.move(mark, at.point);
  }
}
