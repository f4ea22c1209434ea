// SPDX-License-Identifier: GPL-3.0-or-later
// Colours as the server gives them ("#rrggbb"), the same as the report's.

function rgb(hex: string): [number, number, number] {
  const n = parseInt(hex.slice(1), 16);
  return [n >> 16, (n >> 8) & 255, n & 255];
}

/** RGBA bytes of the colours, or of `steps` colours blended between them. */
export function bytesOf(colors: string[], steps = colors.length): Uint8Array<ArrayBuffer> {
  const out = new Uint8Array(4 * steps);
  for (let i = 0; i < steps; ++i) {
    const at = steps > 1 ? (i / (steps - 1)) * (colors.length - 1) : 0;
    const low = Math.min(Math.floor(at), colors.length - 1);
    const high = Math.min(low + 1, colors.length - 1);
    const [a, b] = [rgb(colors[low]), rgb(colors[high])];
    for (let k = 0; k < 3; ++k) out[4 * i + k] = Math.round(a[k] + (at - low) * (b[k] - a[k]));
    out[4 * i + 3] = 255;
  }
  return out;
}
