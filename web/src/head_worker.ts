// SPDX-License-Identifier: GPL-3.0-or-later
// Fetches and reads the head beside the page's own thread, which waits for the graphics to start meanwhile.
import { parseHead } from "./glb";

/** The address goes in; the head comes out, its arrays handed over, or why there is none. */
onmessage = async ({ data }: MessageEvent<string>) => {
  try {
    const answer = await fetch(data);
    if (!answer.ok) throw new Error(`the server answered ${answer.status}: ${(await answer.text()).trim()}`);
    const bytes = await answer.arrayBuffer();
    const head = parseHead(bytes);
    const arrays = [head.skin, head.skull].flatMap((s) => (s ? [s.positions, s.normals, s.triangles] : []));
    const buffers = new Set<Transferable>([bytes, ...arrays.map((a) => a.buffer as ArrayBuffer)]);
    postMessage({ head }, { transfer: [...buffers] });
  } catch (error) {
    postMessage({ error: (error as Error).message });
  }
};
