// SPDX-License-Identifier: GPL-3.0-or-later
// The stored dent of a touched place: the three corners' blended, as the force is.
import type { Head } from "./glb";
import type { TouchState } from "./link";

export interface Dent {
  /** mm from the press axis, ascending from 0 */
  radii: number[];
  /** travel of the skin there over the tool's */
  share: number[];
}

/** Corners without a curve of their own have no dent and leave it to the others; null where none has. */
export function dentAt(head: Head, touch: Pick<TouchState, "vertices" | "weights">): Dent | null {
  if (!head.dents || touch.vertices[0] < 0) return null;
  const { radii, share } = head.dents;
  const known = touch.vertices.map((v, k) => (share.some((ring) => ring[v] !== 0) ? touch.weights[k] : 0));
  const total = known[0] + known[1] + known[2];
  if (!(total > 0)) return null;
  return {
    radii,
    share: share.map((ring) => touch.vertices.reduce((sum, v, k) => sum + (known[k] / total) * ring[v], 0)),
  };
}
