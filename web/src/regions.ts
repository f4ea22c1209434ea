// SPDX-License-Identifier: GPL-3.0-or-later
import type { Head, Vec3 } from "./glb";

/** From where a region is seen: the mean of its normals, of paired regions on the subject's left. */
export function regionDirection(head: Head, code: number): Vec3 {
  const { positions, normals } = head.skin;
  const sum = (leftOnly: boolean): Vec3 => {
    const s: Vec3 = [0, 0, 0];
    for (let i = 0; i < head.region.length; ++i) {
      if (head.region[i] !== code || (leftOnly && positions[3 * i] <= 5)) continue;
      for (let k = 0; k < 3; ++k) s[k] += normals[3 * i + k];
    }
    return s;
  };
  const midline = ["cranium", "forehead", "chin", "nose", "lips", "neck", "other"];
  const left = midline.includes(head.regionNames[code]) ? ([0, 0, 0] as Vec3) : sum(true);
  const s = Math.hypot(...left) > 0 ? left : sum(false);
  const length = Math.hypot(...s);
  return length > 0 ? [s[0] / length, s[1] / length, s[2] / length] : [0, 0, 1];
}
