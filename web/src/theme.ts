// SPDX-License-Identifier: GPL-3.0-or-later
// Light, dark, or as the system has it; remembered in this browser.
import { byId } from "./dom";

type Theme = "system" | "light" | "dark";
const ORDER: Theme[] = ["system", "light", "dark"];
const KEY = "palpate-theme";

export function startTheme(changed: () => void): void {
  const system = matchMedia("(prefers-color-scheme: dark)");
  let theme = (localStorage.getItem(KEY) ?? "system") as Theme;
  const apply = () => {
    const dark = theme === "dark" || (theme === "system" && system.matches);
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    byId("theme").textContent = `Theme: ${theme}`;
    changed();
  };
  system.addEventListener("change", apply);
  byId("theme").addEventListener("click", () => {
    theme = ORDER[(ORDER.indexOf(theme) + 1) % ORDER.length];
    localStorage.setItem(KEY, theme);
    apply();
  });
  queueMicrotask(apply);
}
