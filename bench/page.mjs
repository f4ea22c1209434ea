// SPDX-License-Identifier: GPL-3.0-or-later
// How fast the page opens and draws a large head in headless Chromium, which renders in software.
// PALPATE_PROGRAM and PALPATE_TEST_HEAD as for web/tests; `make bench-page` sets both.
import { HEAD, launch, missing, serve } from "../web/tests/browser.mjs";

const RUNS = 5;
const FRAMES = 5; // of an orbit, per run
const PATIENCE = 120_000; // ms

const why = missing();
if (why) {
  console.error(`bench-page: ${why}`);
  process.exit(2);
}

/** In the page: when the first frame with the head on it has been drawn; reading a pixel waits for the graphics. */
function watch() {
  const look = setInterval(() => {
    if (!document.documentElement.dataset.ready || window.palpate.view.renderer.info.render.triangles === 0) return;
    clearInterval(look);
    const gl = window.palpate.view.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    window.firstFrame = performance.now();
  }, 5);
}

async function once(browser, url) {
  const page = await browser.newPage({ viewport: { width: 1366, height: 768 } });
  await page.addInitScript(watch);
  await page.goto(url, { timeout: PATIENCE });
  await page.waitForFunction(() => window.firstFrame > 0, null, { timeout: PATIENCE });
  const run = await page.evaluate((count) => ({
    vertices: window.palpate.head().skin.count,
    open: window.firstFrame / 1000,
    frame: window.palpate.measureFrames(count),
  }), FRAMES);
  await page.close();
  return run;
}

const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];
const row = (name, unit, digits, list) =>
  console.log(`| ${name} | ${median(list).toFixed(digits)} ${unit} | ${list.map((x) => x.toFixed(digits)).join(", ")} |`);

const server = await serve(["view", HEAD, "--no-open", "--json", "--port", "0"]);
try {
  const runs = [];
  for (let i = 0; i < RUNS; ++i) {
    const browser = await launch(); // a new one each time: nothing cached
    runs.push(await once(browser, server.url));
    await browser.close();
    const { open, frame } = runs.at(-1);
    console.error(`run ${i + 1} of ${RUNS}: open after ${open.toFixed(2)} s, ${frame.toFixed(0)} ms a frame`);
  }
  console.log(`${runs[0].vertices} vertices, 1366 x 768, Chromium in software\n`);
  console.log(`| what | median of ${RUNS} | each |\n|---|---|---|`);
  row("from navigation to the first frame with the head", "s", 2, runs.map((r) => r.open));
  row(`a frame while orbiting (mean of ${FRAMES})`, "ms", 1, runs.map((r) => r.frame));
} finally {
  await server.stop();
}
