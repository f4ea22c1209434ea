// SPDX-License-Identifier: GPL-3.0-or-later
// The experimenter's page: who is at which screen, what is being touched, and the few buttons.
import { byId, Channel, make } from "./channel";

interface Current {
  pseudonym: string;
  key: string;
  kind: string;
  title: string;
  asks: string;
  region: string;
  factor: number;
  place: number;
  places: number;
  touched_s: number;
  least_s: number;
  most_s: number;
  paused: boolean;
  answers: number;
  dropped: number;
  device?: string;
  watchdog?: string;
  force_n?: number;
}
interface View {
  title: string;
  protocol: string;
  head: string;
  file: string;
  planned: number;
  device: string;
  simulated: boolean;
  people: { pseudonym: string; state: string; simulated: boolean }[];
  pages: number;
  notice: string;
  current: Current | null;
}

const key = new URLSearchParams(location.hash.slice(1)).get("key") ?? "";
let view: View | null = null;
let people = "";

const channel = new Channel<View>(`/study/experimenter?key=${encodeURIComponent(key)}`, {
  view: show,
  connected: (on) => {
    byId("link").textContent = on ? "live" : "connection lost: open the address that palpate printed";
  },
});

function rows(pairs: [string, string][]): HTMLElement {
  const list = make("dl");
  for (const [term, text] of pairs) list.append(make("dt", {}, term), make("dd", {}, text));
  return list;
}

function showNow(c: Current | null): void {
  if (!c) {
    byId("now").replaceChildren(make("p", {}, "Nobody is at it. A new participant begins with the consent."));
    return;
  }
  const pairs: [string, string][] = [
    ["Participant", `${c.pseudonym}, ${c.answers} answers${c.paused ? ", PAUSED" : ""}`],
    ["Screen", `${c.key} (${c.kind})`],
    ["Asks", c.asks],
  ];
  if (c.kind === "touch") {
    const stiffer = c.factor === 1 ? "" : `, ${c.factor.toFixed(3)} times as stiff`;
    pairs.push(["Touches", `${c.region}${stiffer}`]);
    pairs.push(["Time", `${c.touched_s} s of ${c.least_s}${c.most_s > 0 ? ` to ${c.most_s}` : " or more"} s`]);
    pairs.push(["Device", `${c.device ?? "–"}, watchdog ${c.watchdog ?? "–"}, ${c.force_n ?? 0} N`]);
  }
  if (c.dropped > 0) pairs.push(["Samples lost", `${c.dropped}`]);
  byId("now").replaceChildren(rows(pairs));
}

function showPeople(v: View): void {
  const state = JSON.stringify([v.people, v.current?.pseudonym]);
  if (state === people) return;
  people = state;
  const focused = (document.activeElement as HTMLElement | null)?.dataset.button;
  byId("people").replaceChildren(...v.people.map((p) => {
    const buttons = make("td");
    if ((p.state === "enrolled" || p.state === "running") && v.current === null) {
      const go = make("button", { type: "button", "data-button": `take-up ${p.pseudonym}` }, "Take up");
      go.addEventListener("click", () => channel.send({ do: "take-up", who: p.pseudonym }));
      buttons.append(go, " ");
    }
    if (p.state !== "withdrawn") {
      const drop = make("button", { type: "button", class: "danger", "data-button": `withdraw ${p.pseudonym}` }, "Withdraw");
      drop.addEventListener("click", () => askWithdraw(p.pseudonym));
      buttons.append(drop);
    }
    return make("tr", {}, make("td", {}, p.pseudonym), make("td", {}, p.state + (p.simulated ? " (simulated)" : "")), buttons);
  }));
  // New rows must not take the keys from somebody who stands on a button of the old ones.
  if (focused) document.querySelector<HTMLElement>(`[data-button="${focused}"]`)?.focus();
}

function askWithdraw(who: string): void {
  const dialog = byId<HTMLDialogElement>("sure");
  byId("sure-title").textContent = `Withdraw ${who}?`;
  dialog.returnValue = "no";
  dialog.onclose = () => {
    if (dialog.returnValue === "yes") channel.send({ do: "withdraw", who });
  };
  dialog.showModal();
}

function show(v: View): void {
  view = v;
  document.title = `${v.title} · experimenter`;
  byId("title").textContent = v.title;
  byId("simulated").hidden = !v.simulated;
  byId("facts").textContent = `${v.file} · ${v.protocol} · ${v.head} · ${v.device} · ${v.people.length} of ${v.planned} participants · ${v.pages === 1 ? "the participant's page is open" : `${v.pages} participant's pages are open`}`;
  byId("notice").textContent = v.notice;
  showNow(v.current);
  showPeople(v);
  const at = v.current;
  byId<HTMLButtonElement>("start").disabled = at !== null;
  byId<HTMLButtonElement>("go-on").disabled = at?.kind !== "touch" || at.paused;
  byId<HTMLButtonElement>("pause").disabled = at === null;
  byId("pause").replaceChildren(...(at?.paused ? [make("u", {}, "P"), "ick up again"] : [make("u", {}, "P"), "ause"]));
  byId<HTMLButtonElement>("leave").disabled = at === null;
  document.documentElement.dataset.current = at ? `${at.pseudonym} ${at.key}` : "";
}

const KEYS: Record<string, string> = { n: "start", g: "go-on", p: "pause", l: "leave" };
for (const id of Object.values(KEYS)) byId(id).addEventListener("click", () => channel.send({ do: id }));
document.addEventListener("keydown", (event) => {
  if (!view || event.ctrlKey || event.altKey || event.metaKey || byId<HTMLDialogElement>("sure").open) return;
  const button = byId<HTMLButtonElement>(KEYS[event.key.toLowerCase()] ?? "");
  if (button && !button.disabled) button.click();
});
