// SPDX-License-Identifier: GPL-3.0-or-later
// The page's end of a study's socket: what to show comes in, words go out, and back after a break.

export interface Listener<View> {
  view(view: View): void;
  frame?(numbers: Float32Array): void;
  connected(on: boolean): void;
}

export class Channel<View> {
  private socket: WebSocket | null = null;
  private wait = 250; // ms before the next attempt

  constructor(
    private readonly path: string,
    private readonly listener: Listener<View>,
  ) {
    this.open();
  }

  private open(): void {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(`${scheme}//${location.host}${this.path}`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onmessage = (event) => {
      this.wait = 250;
      if (event.data instanceof ArrayBuffer) {
        this.listener.frame?.(new Float32Array(event.data));
      } else {
        this.listener.connected(true);
        this.listener.view(JSON.parse(String(event.data)) as View);
      }
    };
    socket.onclose = () => {
      this.listener.connected(false);
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(2000, 2 * this.wait);
    };
  }

  send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

/** An element with attributes and children; no text is ever read as markup. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}
