// SPDX-License-Identifier: GPL-3.0-or-later
// Moving landmarks: the mode, its panel, and what the program says to it.
import { byId, setText } from "./dom";
import { parseFit, type Fit, type Head, type Vec3 } from "./glb";
import { Marks, movedBy, words, type Mark } from "./marks";
import { PointsLink, type PointsState } from "./points_link";
import type { View } from "./view";

export interface PointsSide {
  head(): Head | null;
  /** the skull to show; null: the file's */
  showFit(fit: Fit | null): void;
}

export class Points {
  active = false;
  private link: PointsLink | null = null;
  private marks: Marks | null = null;
  private state: PointsState | null = null;
  private noted = 0;
  private fitted = 0;
  private fit: Fit | null = null;
  private readonly rows = new Map<string, { row: HTMLLIElement; mm: HTMLElement; undo: HTMLButtonElement; reset: HTMLButtonElement }>();

  constructor(private readonly view: View, private readonly side: PointsSide) {
    byId("points-button").addEventListener("click", () => this.toggle());
    byId("points-save").addEventListener("click", () => this.link?.save(this.moved(), false));
    byId("points-replace").addEventListener("click", () => this.link?.save(this.moved(), true));
    byId("points-keep").addEventListener("click", () => this.ask(false));
    byId("points-run").addEventListener("click", () => this.link?.run(this.moved()));
    byId("points-stop").addEventListener("click", () => this.link?.stop());
    byId("points-copy").addEventListener("click", () => this.copy());
    for (const radio of document.querySelectorAll<HTMLInputElement>("input[name=skull]"))
      radio.addEventListener("change", () => this.side.showFit(radio.value === "fit" ? this.fit : null));
    view.drawn = () => this.marks?.place();
  }

  toggle(): void {
    if (!this.active && !this.side.head()) return;
    this.active = !this.active;
    const button = byId("points-button");
    button.setAttribute("aria-pressed", String(this.active));
    document.documentElement.dataset.mode = this.active ? "points" : "touch";
    byId("points-card").hidden = !this.active;
    this.link ??= new PointsLink((state) => this.hear(state));
    this.marks?.show(this.active);
  }

  /** For tests and scripts. */
  now(): object {
    const marks = this.marks?.all ?? [];
    return {
      state: this.state,
      marks: marks.map(({ name, position, origin }) => ({ name, position, origin })),
    };
  }

  private moved(): Record<string, Vec3> {
    const marks = this.marks?.all ?? [];
    return Object.fromEntries(marks.filter((m) => movedBy(m) > 0).map((m) => [m.name, m.position]));
  }

  private hear(state: PointsState | null): void {
    this.state = state;
    if (state && !this.marks) this.begin(state);
    this.refresh();
    if (!state) return;
    setText("points-file", state.file);
    setText("points-command", state.command);
    if (state.note && state.note.number !== this.noted) this.note(state.note);
    this.noted = state.note?.number ?? 0;
    this.progress(state.run);
    if (state.fit && state.fit.number !== this.fitted) void this.fetchFit(state.fit);
  }

  private begin(state: PointsState): void {
    const head = this.side.head()!;
    this.marks = new Marks(byId("marks"), this.view, head, new Set(state.names), {
      changed: () => this.refresh(),
    });
    for (const mark of this.marks.all) {
      const saved = state.saved[mark.name];
      const far = saved && Math.hypot(...saved.map((x, k) => x - mark.origin[k])) > 1e-6;
      if (far) this.marks.move(mark, saved);
      this.list(mark);
    }
    const kept = Object.keys(this.moved()).length;
    if (kept > 0) setText("points-note", `${kept === 1 ? "a point" : `${kept} points`} as the file beside the head has ${kept === 1 ? "it" : "them"}`);
    if (this.marks.all.length === 0) setText("points-note", "this head's file has no landmarks");
    this.marks.show(this.active);
  }

  private list(mark: Mark): void {
    const row = document.createElement("li");
    const button = (text: string, what: string, act: () => void) => {
      const b = Object.assign(document.createElement("button"), { type: "button", textContent: text });
      b.setAttribute("aria-label", what);
      b.addEventListener("click", act);
      return b;
    };
    const name = button(words(mark.name), `go to ${words(mark.name)}`, () => this.marks!.goTo(mark));
    name.className = "name";
    const mm = Object.assign(document.createElement("output"), { textContent: "" });
    const undo = button("Undo", `undo the last move of ${words(mark.name)}`, () => this.marks!.undo(mark));
    const reset = button("Reset", `${words(mark.name)} back to where the file has it`, () => this.marks!.reset(mark));
    row.append(name, mm, undo, reset);
    byId("points-list").append(row);
    this.rows.set(mark.name, { row, mm, undo, reset });
  }

  private refresh(): void {
    const on = this.state !== null;
    let count = 0;
    for (const mark of this.marks?.all ?? []) {
      const cells = this.rows.get(mark.name);
      if (!cells) continue;
      const mm = movedBy(mark);
      if (mm > 0) ++count;
      const text = mm > 0 ? `${mm.toFixed(1)} mm` : "";
      if (cells.mm.textContent !== text) cells.mm.textContent = text;
      cells.mm.dataset.value = String(mm);
      cells.undo.hidden = mark.history.length === 0;
      cells.reset.hidden = mm === 0;
      const chosen = String(this.marks?.chosen === mark);
      if (cells.row.getAttribute("aria-current") !== chosen) cells.row.setAttribute("aria-current", chosen);
    }
    setText("points-count", !on ? "connecting …" : count === 0 ? "none moved" : `${count} moved`);
    const running = this.state?.run != null;
    byId<HTMLButtonElement>("points-save").disabled = !on || count === 0;
    byId<HTMLButtonElement>("points-run").disabled = !on || running || this.state!.no_fit !== "";
    byId("points-run").title = this.state?.no_fit ?? "";
    byId("points-run").hidden = running;
    byId("points-stop").hidden = !running;
    byId("points-no-fit").hidden = !this.state?.no_fit;
    setText("points-no-fit", this.state?.no_fit ?? "");
    byId("points-since").hidden = !this.state?.fit || !this.differs(this.state.fit.moved);
  }

  /** Whether points are elsewhere than they were at a fit. */
  private differs(fitted: Record<string, Vec3>): boolean {
    return (this.marks?.all ?? []).some((mark) => {
      const then = fitted[mark.name] ?? mark.origin;
      return Math.hypot(...mark.position.map((x, k) => x - then[k])) > 1e-6;
    });
  }

  private ask(on: boolean): void {
    byId("points-exists").hidden = !on;
    if (on) byId("points-replace").focus();
    else if (document.activeElement === document.body) byId("points-save").focus();
  }

  private note(note: NonNullable<PointsState["note"]>): void {
    const element = byId("points-note");
    element.textContent = note.kind === "exists" ? "" : note.text;
    element.className = ["refused", "failed"].includes(note.kind) ? "bad" : "";
    setText("points-exists-text", `${note.text}. Replace it?`);
    this.ask(note.kind === "exists");
  }

  private progress(run: PointsState["run"]): void {
    byId("points-progress").hidden = !run;
    if (!run) return;
    byId<HTMLProgressElement>("points-bar").value = run.fraction;
    const left = Math.max(1, Math.round(run.left_s));
    setText("points-stage", `${run.stage || "starting"}, about ${left} s left`);
    setText("points-note", "");
  }

  private async fetchFit(made: NonNullable<PointsState["fit"]>): Promise<void> {
    this.fitted = made.number;
    const head = this.side.head()!;
    try {
      const answer = await fetch(made.path.replace(/^\//, ""));
      if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
      const fit = parseFit(await answer.arrayBuffer(), head);
      this.fit = fit;
    } catch (error) {
      this.note({ number: 0, kind: "failed", text: `the fitted skull could not be read: ${(error as Error).message}` });
      return;
    }
    byId("points-fit").hidden = false;
    document.querySelector<HTMLInputElement>("input[name=skull][value=fit]")!.checked = true;
    const { mean, most } = depthChange(this.fit.fileDepth, this.fit.depth);
    setText("points-change", `depth changes by ${mean.toFixed(2)} mm in the mean, ${most.toFixed(1)} mm at most`);
    this.side.showFit(this.fit);
  }

  private copy(): void {
    const text = byId("points-command").textContent ?? "";
    navigator.clipboard?.writeText(text).then(
      () => setText("points-note", "command copied"),
      () => setText("points-note", "copy it by hand: the browser does not let the page"),
    );
  }
}

function depthChange(a: Float32Array, b: Float32Array): { mean: number; most: number } {
  let [sum, most, count] = [0, 0, 0];
  for (let i = 0; i < a.length; ++i) {
    if (a[i] < 0 || b[i] < 0) continue;
    const d = Math.abs(a[i] - b[i]);
    sum += d;
    most = Math.max(most, d);
    ++count;
  }
  return { mean: count > 0 ? sum / count : 0, most };
}
