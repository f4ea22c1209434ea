// SPDX-License-Identifier: GPL-3.0-or-later
// The socket of the landmarks (docs/formats.md): moved points out; file, run and result in.
import type { Vec3 } from "./glb";

export interface PointsState {
  type: "points";
  /** points that may be moved */
  names: string[];
  /** where they are kept */
  file: string;
  /** points of that file, head frame, mm */
  saved: Record<string, Vec3>;
  /** why a fit cannot be asked for; empty where it can */
  no_fit: string;
  /** what computes the whole map with the points of the file */
  command: string;
  note: { number: number; kind: "saved" | "exists" | "refused" | "failed" | "stopped" | "fitted"; text: string } | null;
  run: { stage: string; left_s: number; fraction: number } | null;
  fit: { number: number; path: string; moved: Record<string, Vec3> } | null;
}

export class PointsLink {
  private socket: WebSocket | null = null;
  private wait = 250; // ms before the next attempt

  constructor(private readonly heard: (state: PointsState | null) => void) {
    this.open();
  }

  private open(): void {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(`${scheme}//${location.host}/points`);
    this.socket.onmessage = ({ data }) => {
      this.wait = 250;
      this.heard(JSON.parse(String(data)) as PointsState);
    };
    this.socket.onclose = () => {
      this.heard(null);
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(4000, 2 * this.wait);
    };
  }

  private send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
  save(points: Record<string, Vec3>, replace: boolean): void {
    this.send({ do: "save", points, replace });
  }
  run(points: Record<string, Vec3>): void {
    this.send({ do: "run", points });
  }
  stop(): void {
    this.send({ do: "stop" });
  }
}
