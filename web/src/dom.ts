// SPDX-License-Identifier: GPL-3.0-or-later
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
}
export function setText(id: string, text: string): void {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
}
/** In the middle of the picture; empty hides it. */
export function message(text: string): void {
  const element = byId("message");
  element.textContent = text;
  element.hidden = text === "";
}
