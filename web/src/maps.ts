// SPDX-License-Identifier: GPL-3.0-or-later
// The heat maps: one number per vertex, with its scale, unit and words.
import type { Head } from "./glb";

export type MapName = "stiffness" | "depth" | "error" | "region" | "completed";

/** A code of a map that has no scale: its name and its colour. */
export interface Category {
  name: string;
  color: string;
}

export interface HeatMap {
  name: MapName;
  /** NaN where there is none */
  values: Float32Array;
  low: number;
  high: number;
  logarithmic: boolean;
  title: string;
  unit: string;
  /** by code, where the values are codes; null: the values have a scale */
  categories: Category[] | null;
  /** one line on what it means */
  note: string;
}

/** As the report draws them. */
const SCANNED = "#78b0de";
const COMPLETED = "#ed9433";

/** Travel at a force between the samples: straight from knot to knot, as the curve is. */
export function travelAt(head: Head, vertex: number, force: number): number {
  const { forces, travel } = head;
  if (!(travel[0][vertex] >= 0)) return NaN;
  let i = 0;
  while (i < forces.length - 1 && forces[i] < force) ++i;
  const f0 = i === 0 ? 0 : forces[i - 1];
  const u0 = i === 0 ? 0 : travel[i - 1][vertex];
  return u0 + ((force - f0) / (forces[i] - f0)) * (travel[i][vertex] - u0);
}

/** The values below and above which 1 % lie: single outliers do not flatten the colours. */
function range(values: Float32Array): [number, number] {
  const some: number[] = [];
  const step = Math.max(1, Math.floor(values.length / 20000));
  for (let i = 0; i < values.length; i += step) if (!Number.isNaN(values[i])) some.push(values[i]);
  if (some.length === 0) return [0, 1];
  some.sort((a, b) => a - b);
  const low = some[Math.floor(0.01 * (some.length - 1))];
  const high = some[Math.ceil(0.99 * (some.length - 1))];
  return high > low ? [low, high] : [low, low + 1];
}

/** @param regionColors by region code */
export function makeMap(head: Head, name: MapName, force: number, regionColors: string[]): HeatMap {
  const n = head.skin.count;
  const values = new Float32Array(n);
  const from = (column: Float32Array, factor: number) => {
    for (let i = 0; i < n; ++i) values[i] = column[i] < 0 ? NaN : factor * column[i];
  };
  switch (name) {
    case "stiffness": {
      for (let i = 0; i < n; ++i) values[i] = force / travelAt(head, i, force);
      const [low, high] = range(values);
      return {
        name, values, low, high, logarithmic: true, categories: null,
        title: `Stiffness at ${force.toFixed(1)} N`, unit: "N/mm",
        note: "force over travel; grey: no curve was computed here",
      };
    }
    case "depth": {
      from(head.depth, 1);
      const [, high] = range(values);
      return {
        name, values, low: 0, high, logarithmic: false, categories: null,
        title: "Tissue depth", unit: "mm", note: "from the skin to the bone; grey: no bone below",
      };
    }
    case "error": {
      from(head.error, 100);
      const [, high] = range(values);
      return {
        name, values, low: 0, high: Math.max(high, 1), logarithmic: false, categories: null,
        title: "Estimated error", unit: "%", note: "of the travel, where points were blended",
      };
    }
    case "region":
      from(head.region, 1);
      return {
        name, values, low: 0, high: 1, logarithmic: false,
        categories: head.regionNames.map((region, code) => ({ name: region, color: regionColors[code] })),
        title: "Region", unit: "", note: "the seven compared regions in colour",
      };
    case "completed":
      if (head.completed) from(head.completed, 1);
      return {
        name, values, low: 0, high: 1, logarithmic: false,
        categories: [{ name: "scanned", color: SCANNED }, { name: "completed", color: COMPLETED }],
        title: "Skin that a press moves", unit: "",
        note: "the scan is a face alone; orange: a press moves skin that was completed from another head",
      };
  }
}

/** Position of a value on the colour scale, 0 to 1. */
export function onScale(map: HeatMap, value: number): number {
  const t = map.logarithmic
    ? Math.log(value / map.low) / Math.log(map.high / map.low)
    : (value - map.low) / (map.high - map.low);
  return Math.min(1, Math.max(0, t));
}
