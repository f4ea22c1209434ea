// SPDX-License-Identifier: GPL-3.0-or-later
// The live socket (docs/formats.md): state in, commands out, and back again after a break.
import type { Vec3 } from "./glb";

export interface Hello {
  type: "hello";
  protocol: number;
  version: string;
  head: string;
  pointer: boolean;
  device: { backend: string; name: string; serial: string; peak_n: number; stiffness_n_mm: number };
  tool_radius_mm: number;
  map_radius_mm: number;
  scale: number;
  reshaped: boolean;
  region_names: string[];
  trip_names: string[];
  regions: { code: number; name: string; stiffness: number | null }[];
  colors: { sequential: string[]; missing: string; regions: string[] };
  fingerprint: string;
  recording: string;
  /** code of the region to look at first, null for the face */
  look_at: number | null;
  warnings: string[];
}

export interface Health {
  type: "health";
  rate_hz: number;
  ticks: number;
  skipped: number;
  late_median_us: number;
  late_p999_us: number;
  late_longest_us: number;
  late_above_1ms: number;
  tick_median_us: number;
  tick_p999_us: number;
  guarded: number;
  trips: Record<string, number>;
  warnings: string[];
  device: string;
  trouble: string;
  pages: number;
  recorder?: { written: number; dropped: number; error: string };
}

export interface TouchState {
  time: number;
  ticks: number;
  tool: Vec3;
  force: Vec3;
  normal: Vec3;
  point: Vec3;
  depth: number;
  mapForce: number;
  stiffness: number;
  elastic: number;
  weights: Vec3;
  vertices: Vec3;
  region: number;
  inContact: boolean;
  estimated: boolean;
  clamped: boolean;
  device: number;
  trip: number;
  rotation: number[];
  atHead: Vec3;
  curveDeepest: number;
  curve: Float64Array;
}

const MAGIC = 0x54534c50; // "PLST"
const VERSION = 1;
const NUMBERS = 90;

export function parseState(bytes: ArrayBuffer): TouchState | null {
  if (bytes.byteLength !== 16 + 8 * NUMBERS) return null;
  const head = new DataView(bytes);
  if (head.getUint32(0, true) !== MAGIC || head.getUint32(4, true) !== VERSION) return null;
  const n = new Float64Array(bytes, 16);
  const three = (at: number): Vec3 => [n[at], n[at + 1], n[at + 2]];
  const flags = n[26];
  return {
    time: n[0],
    ticks: n[1],
    tool: three(2),
    force: three(5),
    normal: three(8),
    point: three(11),
    depth: n[14],
    mapForce: n[15],
    stiffness: n[16],
    elastic: n[17],
    weights: three(19),
    vertices: three(22),
    region: n[25],
    inContact: (flags & 1) !== 0,
    estimated: (flags & 2) !== 0,
    clamped: (flags & 4) !== 0,
    device: n[27],
    trip: n[28],
    rotation: Array.from(n.subarray(35, 44)),
    atHead: three(44),
    curveDeepest: n[48],
    curve: n.slice(49, NUMBERS),
  };
}

export interface LinkListener {
  hello(message: Hello): void;
  health(message: Health): void;
  state(state: TouchState): void;
  connected(on: boolean): void;
}

export class Link {
  private socket: WebSocket | null = null;
  private wait = 250; // ms before the next attempt

  constructor(private readonly listener: LinkListener) {
    this.open();
  }

  private open(): void {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(`${scheme}//${location.host}/live`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = () => {
      this.listener.connected(false);
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(2000, 2 * this.wait);
    };
  }

  private receive(data: unknown): void {
    if (data instanceof ArrayBuffer) {
      const state = parseState(data);
      if (state) this.listener.state(state);
      return;
    }
    const message = JSON.parse(String(data)) as Hello | Health;
    if (message.type === "hello") {
      this.wait = 250;
      this.listener.connected(true);
      this.listener.hello(message);
    } else {
      this.listener.health(message);
    }
  }

  private send(bytes: ArrayBuffer): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(bytes);
  }
  private sendPair(kind: number, value: number): void {
    this.send(new Uint32Array([kind, value]).buffer);
  }

  press(point: Vec3, depth: number, begin: boolean): void {
    const bytes = new ArrayBuffer(40);
    const view = new DataView(bytes);
    view.setUint32(0, 1, true);
    view.setUint32(4, begin ? 1 : 0, true);
    point.forEach((x, k) => view.setFloat64(8 + 8 * k, x, true));
    view.setFloat64(32, depth, true);
    this.send(bytes);
  }
  lift(): void {
    this.sendPair(2, 0);
  }
  aim(region: number): void {
    this.sendPair(3, region);
  }
  pause(on: boolean): void {
    this.sendPair(4, on ? 1 : 0);
  }
}
