// SPDX-License-Identifier: GPL-3.0-or-later
// What lies under the pointer: the first triangle along a ray. A plain walk over all triangles takes
// some milliseconds at 400,000, so that no tree has to be built while the head opens.
import type { Surface, Vec3 } from "./glb";

export interface Pick {
  point: Vec3;
  /** corners and their weights */
  vertices: Vec3;
  weights: Vec3;
  distance: number;
}

export function pick(surface: Surface, origin: Vec3, direction: Vec3): Pick | null {
  const p = surface.positions;
  const t = surface.triangles;
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  let best = Infinity;
  let bestAt = -1;
  let bestU = 0;
  let bestV = 0;
  for (let i = 0; i < t.length; i += 3) {
    const a = 3 * t[i];
    const b = 3 * t[i + 1];
    const c = 3 * t[i + 2];
    const e1x = p[b] - p[a], e1y = p[b + 1] - p[a + 1], e1z = p[b + 2] - p[a + 2];
    const e2x = p[c] - p[a], e2y = p[c + 1] - p[a + 1], e2z = p[c + 2] - p[a + 2];
    const hx = dy * e2z - dz * e2y, hy = dz * e2x - dx * e2z, hz = dx * e2y - dy * e2x;
    const det = e1x * hx + e1y * hy + e1z * hz;
    if (det < 1e-12) continue; // seen from behind, or on edge
    const sx = ox - p[a], sy = oy - p[a + 1], sz = oz - p[a + 2];
    const u = sx * hx + sy * hy + sz * hz;
    if (u < 0 || u > det) continue;
    const qx = sy * e1z - sz * e1y, qy = sz * e1x - sx * e1z, qz = sx * e1y - sy * e1x;
    const v = dx * qx + dy * qy + dz * qz;
    if (v < 0 || u + v > det) continue;
    const distance = (e2x * qx + e2y * qy + e2z * qz) / det;
    if (distance <= 0 || distance >= best) continue;
    best = distance;
    bestAt = i;
    bestU = u / det;
    bestV = v / det;
  }
  if (bestAt < 0) return null;
  return {
    point: [ox + best * dx, oy + best * dy, oz + best * dz],
    vertices: [t[bestAt], t[bestAt + 1], t[bestAt + 2]],
    weights: [1 - bestU - bestV, bestU, bestV],
    distance: best,
  };
}
