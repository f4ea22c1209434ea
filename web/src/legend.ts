// SPDX-License-Identifier: GPL-3.0-or-later
// What the colours mean.
import { niceStep } from "./charts";
import { byId, setText } from "./dom";
import type { Hello } from "./link";
import { onScale, type HeatMap } from "./maps";
import { bytesOf } from "./palette";

function ticks(map: HeatMap): number[] {
  const inside: number[] = [];
  const step = niceStep(map.high - map.low, 5);
  for (let v = Math.ceil(map.low / step) * step; v <= map.high; v += step) inside.push(Number(v.toPrecision(6)));
  // The ends are labelled too; what would run into them is left out.
  const kept = inside.filter((v) => onScale(map, v) > 0.23 && onScale(map, v) < 0.78);
  return [map.low, ...kept, map.high];
}

const short = (v: number, span: number) =>
  String(Number(v.toFixed(span < 3 ? 2 : span < 30 ? 1 : 0)));

export function drawLegend(map: HeatMap, colors: Hello["colors"]): void {
  setText("legend-title", map.title);
  setText("legend-unit", map.unit ? `[${map.unit}]` : "");
  setText("legend-note", map.note);
  byId("legend-bar").hidden = byId("legend-ticks").hidden = map.categories !== null;
  byId("legend-regions").hidden = map.categories === null;
  if (map.categories) {
    const present = new Set(map.values);
    byId("legend-regions").replaceChildren(
      ...map.categories.flatMap(({ name, color }, code) => {
        if (!present.has(code)) return [];
        const item = document.createElement("li");
        const patch = document.createElement("i");
        patch.style.background = color;
        item.append(patch, name);
        return [item];
      }),
    );
    return;
  }
  const bar = byId<HTMLCanvasElement>("legend-bar");
  const context = bar.getContext("2d")!;
  context.putImageData(new ImageData(new Uint8ClampedArray(bytesOf(colors.sequential, 256).buffer), 256, 1), 0, 0);
  byId("legend-ticks").replaceChildren(
    ...ticks(map).map((v, i, all) => {
      const tick = document.createElement("span");
      tick.style.left = `${100 * onScale(map, v)}%`;
      const edge = map.name !== "error" || v > 0 ? (i === 0 && map.low > 0 ? "≤" : i === all.length - 1 ? "≥" : "") : "";
      tick.textContent = edge + short(v, map.high - map.low);
      return tick;
    }),
  );
}
