// SPDX-License-Identifier: GPL-3.0-or-later
// Mouse, fingers and keys: turning the head and pressing it.
import type { Head, Vec3 } from "./glb";
import type { Link, TouchState } from "./link";
import { pick, type Pick } from "./pick";
import type { View } from "./view";

export interface HandSide {
  head(): Head | null;
  state(): TouchState | null;
  mayPress(): boolean;
  hover(pick: Pick | null): void;
  /** true where the key meant something */
  key(key: string): boolean;
}

const START_DEPTH = 1; // mm: a click alone is felt
const MM_PER_PIXEL = 0.04;
const MM_PER_KEY = 0.25;
const DEEPEST = 25; // mm where the curve does not say
const RAD_PER_PIXEL = 0.008;
const KEY_TURN = 0.09; // rad
const REPEAT_MS = 100; // the server lifts a touch that is silent for long

export class Hand {
  pressing = false;
  private point: Vec3 = [0, 0, 0];
  private depth = 0;
  private readonly fingers = new Map<number, [number, number]>();
  private presser = -1;
  private turning = false;
  private lastHover = 0;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly view: View,
              private readonly link: Link, private readonly side: HandSide) {
    canvas.addEventListener("pointerdown", (e) => this.down(e));
    canvas.addEventListener("pointermove", (e) => this.move(e));
    for (const end of ["pointerup", "pointercancel"] as const) canvas.addEventListener(end, (e) => this.up(e));
    canvas.addEventListener("pointerleave", () => this.side.hover(null));
    canvas.addEventListener("contextmenu", (e) => e.preventDefault());
    canvas.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    window.addEventListener("keydown", (e) => this.keyDown(e));
    window.addEventListener("blur", () => this.release());
    setInterval(() => {
      if (this.pressing) this.link.press(this.point, this.depth, false);
    }, REPEAT_MS);
  }

  private pickAt(x: number, y: number): Pick | null {
    const head = this.side.head();
    if (!head) return null;
    const { origin, direction } = this.view.ray(x, y);
    return pick(head.skin, origin, direction);
  }

  private begin(at: Pick): void {
    this.pressing = true;
    this.point = at.point;
    this.depth = START_DEPTH;
    this.canvas.classList.add("pressing");
    this.link.press(this.point, this.depth, true);
  }

  release(): void {
    if (this.pressing) this.link.lift();
    this.pressing = false;
    this.presser = -1;
    this.canvas.classList.remove("pressing");
  }

  private deeper(mm: number): void {
    const state = this.side.state();
    const most = state?.inContact && state.curveDeepest > 0 ? state.curveDeepest : DEEPEST;
    this.depth = Math.min(Math.max(-2, this.depth + mm), most);
    this.link.press(this.point, this.depth, false);
  }

  private down(e: PointerEvent): void {
    this.canvas.focus({ preventScroll: true });
    this.canvas.classList.remove("keys"); // the cross is for those who aim with keys
    this.canvas.setPointerCapture(e.pointerId);
    this.fingers.set(e.pointerId, [e.clientX, e.clientY]);
    if (this.fingers.size > 1) {
      this.release();
      this.turning = true;
      return;
    }
    const at = e.button === 0 && this.side.mayPress() ? this.pickAt(e.clientX, e.clientY) : null;
    this.turning = at === null;
    if (!at) return;
    this.release();
    this.presser = e.pointerId;
    this.begin(at);
  }

  private move(e: PointerEvent): void {
    const from = this.fingers.get(e.pointerId);
    if (!from) {
      this.hoverAt(e);
      return;
    }
    const dx = e.clientX - from[0];
    const dy = e.clientY - from[1];
    const spread = this.spread();
    this.fingers.set(e.pointerId, [e.clientX, e.clientY]);
    if (this.presser === e.pointerId && this.pressing) this.drag(e, dy);
    else if (this.turning) {
      const share = 1 / this.fingers.size;
      this.view.turn(-dx * RAD_PER_PIXEL * share, dy * RAD_PER_PIXEL * share);
      if (spread > 0) this.view.zoom(spread / Math.max(1, this.spread()));
    }
  }

  /** Pixels between two fingers, 0 for one. */
  private spread(): number {
    if (this.fingers.size !== 2) return 0;
    const [[ax, ay], [bx, by]] = [...this.fingers.values()];
    return Math.hypot(ax - bx, ay - by);
  }

  private drag(e: PointerEvent, dy: number): void {
    if (!e.shiftKey) return this.deeper(dy * MM_PER_PIXEL);
    const at = this.pickAt(e.clientX, e.clientY);
    if (!at) return;
    this.point = at.point;
    this.link.press(this.point, this.depth, false);
  }

  private up(e: PointerEvent): void {
    this.fingers.delete(e.pointerId);
    if (e.pointerId === this.presser) this.release();
    if (this.fingers.size === 0) this.turning = false;
  }

  private hoverAt(e: PointerEvent): void {
    if (this.pressing || e.timeStamp - this.lastHover < 60) return;
    this.lastHover = e.timeStamp;
    const at = this.pickAt(e.clientX, e.clientY);
    this.canvas.classList.toggle("over", at !== null && this.side.mayPress());
    this.side.hover(at);
  }

  private wheel(e: WheelEvent): void {
    e.preventDefault();
    if (this.pressing) this.deeper(Math.sign(e.deltaY) * MM_PER_KEY);
    else this.view.zoom(Math.exp(0.0012 * e.deltaY));
  }

  private pressAtCross(): void {
    if (this.pressing) return this.release();
    if (!this.side.mayPress()) return;
    const at = this.pickAt(...this.view.middle());
    if (at) this.begin(at);
  }

  private keyDown(e: KeyboardEvent): void {
    const inControl = e.target instanceof HTMLElement && e.target.closest("input, button, dialog") !== null;
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    this.canvas.classList.add("keys");
    if (inControl && (e.key.length > 1 || e.key === " ")) return; // arrows and space are the control's own
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-KEY_TURN, 0], ArrowRight: [KEY_TURN, 0], ArrowUp: [0, KEY_TURN], ArrowDown: [0, -KEY_TURN],
    };
    if (this.pressing && e.key === "ArrowDown") this.deeper(MM_PER_KEY);
    else if (this.pressing && e.key === "ArrowUp") this.deeper(-MM_PER_KEY);
    else if (e.key in turns) this.view.turn(...turns[e.key]);
    else if (e.key === " ") {
      if (!e.repeat) this.pressAtCross();
    } else if (e.key === "Escape") this.release();
    else if (e.key === "+" || e.key === "=") this.view.zoom(0.9);
    else if (e.key === "-") this.view.zoom(1.1);
    else if (e.key === "0") this.view.fit();
    else if (!this.side.key(e.key.toLowerCase())) return;
    e.preventDefault();
  }
}
