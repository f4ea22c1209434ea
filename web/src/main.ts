// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the page together: head, live socket, picture, readings.
import { Color } from "three";
import { drawCurve, StripChart, type Curve } from "./charts";
import type { Fit, Head, Vec3 } from "./glb";
import { dentAt } from "./dent";
import { Hand } from "./hand";
import { byId, message, setText } from "./dom";
import { drawLegend } from "./legend";
import { Link, type Health, type Hello, type TouchState } from "./link";
import { makeMap, type HeatMap, type MapName } from "./maps";
import { fillReadings, showHealth, showHello } from "./readings";
import { bytesOf } from "./palette";
import { Points } from "./points";
import { regionDirection } from "./regions";
import { startTheme } from "./theme";
import { View } from "./view";
import type { Pick } from "./pick";

function fetchHead(): Promise<Head> {
  const worker = new Worker(new URL("./head_worker.ts", import.meta.url), { type: "module" });
  return new Promise<Head>((resolve, reject) => {
    worker.onmessage = ({ data }: MessageEvent<{ head: Head } | { error: string }>) => {
      worker.terminate();
      if ("head" in data) resolve(data.head);
      else reject(new Error(data.error));
    };
    worker.onerror = (event) => reject(new Error(event.message || "its reader could not be loaded"));
    worker.postMessage(new URL("head.glb", location.href).href);
  });
}

class Page {
  // Asked for before all else: it comes while the graphics start.
  private readonly coming = fetchHead();
  private readonly view = new View(byId<HTMLCanvasElement>("scene"));
  private readonly strip = new StripChart(byId<HTMLCanvasElement>("strip"));
  private readonly link: Link;
  private readonly hand: Hand;
  private readonly points: Points;
  private fitShown = false;
  private head: Head | null = null;
  private hello: Hello | null = null;
  private state: TouchState | null = null;
  private map: HeatMap | null = null;
  private hover: Pick | null = null;
  private readingsDue = true;
  private loadMs = 0;
  private region = -1; // of the buttons, the last one used

  constructor() {
    startTheme(() => this.repaint());
    this.link = new Link({
      hello: (m) => this.onHello(m),
      health: (m) => this.onHealth(m),
      state: (s) => this.onState(s),
      connected: (on) => this.onConnected(on),
    });
    this.hand = new Hand(this.view.canvas, this.view, this.link, {
      head: () => this.head,
      state: () => this.state,
      mayPress: () => !this.points.active && (this.hello?.pointer ?? false),
      hover: (pick) => {
        this.hover = pick;
        this.readingsDue = true;
      },
      key: (key) => this.onKey(key),
    });
    const file: Partial<Head> = {};
    this.points = new Points(this.view, {
      head: () => this.head,
      showFit: (fit) => this.showFit(fit, file),
    });
    this.wireControls();
    void this.load();
    setInterval(() => this.refresh(), 50);
  }

  private async load(): Promise<void> {
    try {
      this.head = await this.coming;
    } catch (error) {
      message(`The head could not be opened: ${(error as Error).message}`);
      return;
    }
    this.view.setHead(this.head);
    message("");
    if (this.head.completed) this.offerCompleted();
    this.paint();
    this.listRegions();
    this.opened();
  }

  /** A map that only heads of a face alone have. */
  private offerCompleted(): void {
    const label = document.createElement("label");
    const radio = Object.assign(document.createElement("input"), { type: "radio", name: "map", value: "completed" });
    label.append(radio, Object.assign(document.createElement("span"), { textContent: "Completed" }));
    radio.addEventListener("change", () => this.paint());
    byId("maps").append(label);
    byId("help-completed").hidden = false;
  }

  /** The head is there and the server has told what the map's colours need: the next frame is the first with the head. */
  private opened(): void {
    if (!this.head || !this.hello) return;
    const first = this.hello.look_at;
    if (first != null) this.view.lookFrom(regionDirection(this.head, first));
    requestAnimationFrame(() => {
      this.loadMs = performance.now();
      document.documentElement.dataset.ready = "yes";
    });
  }

  private onHello(hello: Hello): void {
    const first = this.hello === null;
    if (this.hello && this.hello.fingerprint !== hello.fingerprint) {
      location.reload(); // another head is served now
      return;
    }
    this.hello = hello;
    showHello(hello);
    if (!first) return;
    document.title = `${hello.head} · Palpate`;
    this.paint();
    this.listRegions();
    this.opened();
  }

  private onHealth(health: Health): void {
    showHealth(health, this.hello);
    setText("picture", this.view.frameTime > 0
      ? `${this.view.frameTime.toFixed(0)} ms a frame${this.view.software ? ", in software" : ""}` : "at rest");
  }

  private onConnected(on: boolean): void {
    const badge = byId("link");
    badge.textContent = on ? "live" : "connection lost, trying again";
    badge.className = `badge ${on ? "on" : "off"}`;
    if (!on) {
      this.hand.release();
      this.state = null;
      this.strip.clear();
    }
    this.readingsDue = true;
  }

  private onState(state: TouchState): void {
    const before = this.state;
    this.state = state;
    this.strip.add(state.time, Math.hypot(...state.force), state.inContact ? state.depth : 0);
    const toolSeen = this.hello !== null && state.trip !== 2 &&
      (!this.hello.pointer || this.hand.pressing || state.inContact);
    const radius = this.hello?.tool_radius_mm ?? 8;
    const dent = this.head && state.inContact ? dentAt(this.head, state) : null;
    this.view.showTouch(state, radius, this.thickness(state), dent, toolSeen);
    if (state.inContact || before?.inContact || this.strip.lively) this.readingsDue = true;
  }

  /** mm of tissue under the tool; 30 where no bone lies below. */
  private thickness(state: TouchState): number {
    if (!this.head || state.vertices[0] < 0) return 10;
    let t = 0;
    state.vertices.forEach((v, k) => {
      const d = this.head!.depth[v];
      t += state.weights[k] * (d < 0 ? 30 : d);
    });
    return Math.max(3, t);
  }

  private mapName(): MapName {
    return (document.querySelector<HTMLInputElement>("input[name=map]:checked")?.value ?? "stiffness") as MapName;
  }

  private paint(): void {
    if (!this.head || !this.hello) return;
    const force = Number(byId<HTMLInputElement>("map-force").value);
    const colors = this.hello.colors;
    this.map = makeMap(this.head, this.mapName(), force, colors.regions);
    if (this.fitShown && ["stiffness", "error"].includes(this.map.name))
      this.map.note += "; of the file, before points were moved";
    const missing = new Color(colors.missing).convertLinearToSRGB();
    this.view.paint(this.map, bytesOf(colors.sequential, 256), missing);
    drawLegend(this.map, colors);
    byId("force-row").hidden = this.map.name !== "stiffness";
    document.documentElement.dataset.map = this.map.name;
  }

  /** The skull that was fitted with moved points in the place of the file's, or that again. */
  private showFit(fit: Fit | null, file: Partial<Head>): void {
    const head = this.head!;
    if (!file.depth) Object.assign(file, { depth: head.depth, region: head.region, skull: head.skull });
    Object.assign(head, fit ? { depth: fit.depth, region: fit.region, skull: fit.skull } : file);
    this.view.setSkull(head.skull);
    if (fit && !this.fitShown) {
      this.setOpacity(Math.min(this.view.opacity, 0.45));
      document.querySelector<HTMLInputElement>("input[name=map][value=depth]")!.checked = true;
    }
    this.fitShown = fit !== null;
    this.paint();
  }

  private repaint(): void {
    this.readingsDue = true;
    this.view.touch();
  }

  private refresh(): void {
    if (!this.readingsDue) return;
    this.readingsDue = false;
    const curve = fillReadings(this.head, this.hello, this.state, this.hover);
    const at: [number, number] | null = this.state?.inContact ? [this.state.depth, this.state.mapForce] : null;
    drawCurve(byId<HTMLCanvasElement>("curve"), curve as Curve | null, at);
    this.strip.draw();
  }

  private listRegions(): void {
    if (!this.head || !this.hello) return;
    const hello = this.hello;
    this.region = -1;
    byId("regions-title").textContent = hello.pointer ? "Turn to a region" : "Bring a region under the device";
    byId("regions").replaceChildren(
      ...hello.regions.filter((r) => r.name !== "other").map((r) => {
        const button = document.createElement("button");
        button.type = "button";
        button.textContent = r.name;
        if (r.stiffness !== null) button.title = `median ${r.stiffness.toFixed(2)} N/mm at 2 N`;
        button.onclick = () => {
          const all = [...byId("regions").children];
          this.region = all.indexOf(button);
          all.forEach((b) => b.setAttribute("aria-current", String(b === button)));
          this.view.lookFrom(regionDirection(this.head!, r.code));
          if (!hello.pointer && hello.device.backend !== "simulated") this.link.aim(r.code);
        };
        return button;
      }),
    );
  }

  /** To the next region, or back: what its button does. */
  private stepRegion(by: number): void {
    const all = byId("regions").children;
    if (all.length === 0) return;
    const start = this.region < 0 && by < 0 ? 0 : this.region;
    (all[(start + by + all.length) % all.length] as HTMLButtonElement).click();
  }

  private wireControls(): void {
    for (const radio of document.querySelectorAll("input[name=map]"))
      radio.addEventListener("change", () => this.paint());
    const force = byId<HTMLInputElement>("map-force");
    force.addEventListener("input", () => {
      setText("map-force-value", `${Number(force.value).toFixed(1)} N`);
      this.paint();
    });
    const opacity = byId<HTMLInputElement>("opacity");
    opacity.addEventListener("input", () => this.setOpacity(Number(opacity.value)));
    byId<HTMLInputElement>("dent").addEventListener("change", (e) => {
      this.view.showDent = (e.target as HTMLInputElement).checked;
      this.view.touch();
    });
    byId<HTMLInputElement>("arrow").addEventListener("change", (e) => {
      this.view.showArrow = (e.target as HTMLInputElement).checked;
      this.view.touch();
    });
    byId("pause").addEventListener("click", () => this.togglePause());
    byId("help-button").addEventListener("click", () => byId<HTMLDialogElement>("help").showModal());
    byId<HTMLFormElement>("controls").addEventListener("submit", (e) => e.preventDefault());
    new ResizeObserver(() => this.repaint()).observe(byId("curve"));
    const controls = byId("controls");
    const place = () => (this.view.covered = controls.offsetTop + controls.offsetHeight);
    new ResizeObserver(place).observe(controls);
    place();
  }

  private setOpacity(value: number): void {
    byId<HTMLInputElement>("opacity").value = String(value);
    setText("opacity-value", value >= 1 ? "opaque" : `${Math.round(100 * value)} %`);
    this.view.opacity = value;
  }

  private togglePause(): void {
    const button = byId("pause");
    const on = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(on));
    button.textContent = on ? "Force is off: switch on" : "Force off";
    this.link.pause(on);
  }

  private onKey(key: string): boolean {
    const looks: Record<string, Vec3> = { f: [0, 0, 1], b: [0, 0, -1], l: [1, 0, 0], r: [-1, 0, 0], a: [0, 1, 0.2] };
    if (key in looks) this.view.lookFrom(looks[key]);
    else if (key >= "1" && key <= "9") {
      const radio = document.querySelectorAll<HTMLInputElement>("input[name=map]")[Number(key) - 1];
      if (!radio) return false;
      radio.checked = true;
      this.paint();
    } else if (key === "t") this.setOpacity(this.view.opacity < 1 ? 1 : 0.45);
    else if (key === "p") this.togglePause();
    else if (key === "m") this.points.toggle();
    else if (key === "n") this.stepRegion(1);
    else if (key === "v") this.stepRegion(-1);
    else if (key === "?") byId<HTMLDialogElement>("help").showModal();
    else return false;
    return true;
  }

  /** For tests and scripts; the same calls that mouse and keys make. */
  expose(): object {
    return {
      view: this.view,
      link: this.link,
      state: () => this.state,
      head: () => this.head,
      map: () => this.map,
      dent: () => (this.head && this.state ? dentAt(this.head, this.state) : null),
      points: () => this.points.now(),
      loadMs: () => this.loadMs,
      measureFrames: (count: number) => this.view.measure(count),
    };
  }
}

try {
  Object.assign(window, { palpate: new Page().expose() });
} catch (error) {
  message((error as Error).message);
  throw error;
}
