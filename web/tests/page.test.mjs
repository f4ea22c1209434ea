// SPDX-License-Identifier: GPL-3.0-or-later
// The page in a headless browser against the real program: loads, shows, presses, reconnects.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { FACE, HEAD, PROGRAM, launch, missing, serve } from "./browser.mjs";

const why = missing();
if (why) console.log(`page tests skipped: ${why}`);
const options = { skip: why || false, timeout: 240_000 };
const PATIENCE = 120_000; // ms: the machine may be busy and draws in software

let browser;
let server;
let page;
const complaints = [];
const view = (...more) => ["view", HEAD, "--no-open", "--json", ...more];

/** In the page, before its scripts: what it starts in which order. */
function watchOrder() {
  window.order = [];
  const Worker = window.Worker;
  window.Worker = class extends Worker {
    postMessage(what, ...more) {
      if (String(what).endsWith("/head.glb")) window.order.push("head");
      super.postMessage(what, ...more);
    }
  };
  const start = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    if (kind.startsWith("webgl")) window.order.push("graphics");
    return start.call(this, kind, ...more);
  };
}

async function open(url, size = { width: 1366, height: 768 }, scheme = "light") {
  const fresh = await browser.newPage({ viewport: size, colorScheme: scheme });
  fresh.on("pageerror", (error) => complaints.push(error.message));
  fresh.on("console", (m) => m.type() === "error" && complaints.push(m.text()));
  await fresh.addInitScript(watchOrder);
  await fresh.goto(url, { timeout: PATIENCE });
  await ready(fresh);
  return fresh;
}
const ready = (p) =>
  p.waitForFunction(() => document.documentElement.dataset.ready === "yes", null, { timeout: PATIENCE });
const number = (id) => page.locator(`#${id}`).getAttribute("data-value").then(Number);

before(async () => {
  if (why) return;
  server = await serve(view("--port", "0"));
  browser = await launch();
  page = await open(server.url);
}, { timeout: 240_000 });
after(async () => {
  await browser?.close();
  await server?.stop();
});

test("opens the head without a complaint", options, async () => {
  assert.deepEqual(complaints, []);
  assert.ok(await page.locator("#message").isHidden());
  assert.equal(await page.locator("#link").textContent(), "live");
  const [load, frame, vertices] = await page.evaluate(() => [
    window.palpate.loadMs(), window.palpate.measureFrames(5), window.palpate.head().skin.count]);
  console.log(`${vertices} vertices: open after ${load.toFixed(0)} ms, ${frame.toFixed(1)} ms a frame in software`);
});

test("draws only what is seen: the skull with translucent skin, the dent with a touch", options, async () => {
  const drawn = () => page.evaluate(() => {
    const { view, head } = window.palpate;
    view.measure(1);
    const skin = head().skin.triangles.length / 3;
    return { triangles: view.renderer.info.render.triangles, skin, skull: head().skull.triangles.length / 3,
      dent: "DENT" in view.skin.color.defines };
  });
  const opaque = await drawn();
  assert.deepEqual(opaque, { ...opaque, triangles: opaque.skin, dent: false });
  await page.keyboard.press("t");
  const seen = await drawn();
  assert.equal(seen.triangles, 2 * seen.skin + seen.skull); // depth first, then colours
  await page.keyboard.press("t");
});

test("asks for the head before the graphics start, once each", options, async () => {
  assert.deepEqual(await page.evaluate(() => window.order), ["head", "graphics"]);
});

test("shows each map with its legend", options, async () => {
  const seen = new Set();
  for (const [key, name, unit] of [["2", "depth", "[mm]"], ["3", "error", "[%]"], ["4", "region", ""], ["1", "stiffness", "[N/mm]"]]) {
    await page.keyboard.press(key);
    await page.waitForFunction((n) => document.documentElement.dataset.map === n, name);
    assert.equal(await page.locator("#legend-unit").textContent(), unit);
    seen.add(await page.locator("#legend-title").textContent());
  }
  assert.equal(seen.size, 4);
  await page.locator("#map-force").fill("4");
  assert.equal(await page.locator("#legend-title").textContent(), "Stiffness at 4.0 N");
  assert.equal(await page.locator("#legend-regions").isHidden(), true);
});

test("where a press moves completed skin is a map of heads of a face alone only", { ...options, skip: why || (!FACE && "PALPATE_TEST_FACE is not set") }, async () => {
  assert.equal(await page.locator("input[name=map]").count(), 4);
  await page.keyboard.press("5");
  assert.equal(await page.evaluate(() => document.documentElement.dataset.map), "stiffness");
  const other = await serve(["view", FACE, "--no-open", "--json", "--port", "0"]);
  try {
    const face = await open(other.url);
    await face.locator("#scene").focus();
    await face.keyboard.press("5");
    await face.waitForFunction(() => document.documentElement.dataset.map === "completed");
    assert.deepEqual(await face.locator("#legend-regions li").allTextContents(), ["scanned", "completed"]);
    assert.match(await face.locator("#legend-note").textContent(), /completed from another head/);
    assert.ok(await face.evaluate(() => {
      const { head, map } = window.palpate;
      return map().values.every((x, v) => x === (head().skin.positions[3 * v + 2] < -20 ? 1 : 0));
    }));
    if (process.env.PALPATE_SCREENSHOTS) {
      await face.keyboard.press("l");
      await face.screenshot({ path: join(process.env.PALPATE_SCREENSHOTS, "page-completed.png") });
    }
    await face.close();
  } finally {
    await other.stop();
  }
});

test("the stiffness that is shown is force over travel", options, async () => {
  const worst = await page.evaluate(() => {
    const head = window.palpate.head();
    const map = window.palpate.map();
    const i = head.forces.indexOf(4);
    let most = 0;
    for (let v = 0; v < head.skin.count; ++v)
      if (head.travel[i][v] > 0) most = Math.max(most, Math.abs(map.values[v] - 4 / head.travel[i][v]));
    return most;
  });
  assert.ok(worst < 1e-5, `differs by ${worst} N/mm`);
});

/** In the page: all that shows a press, of one moment; a busy machine may lift it in the next. */
function shownNow() {
  const force = Number(document.getElementById("force").dataset.value);
  const { head, state, dent, view } = window.palpate;
  if (!state()?.inContact) return { force: NaN };
  const { dents } = head();
  const { vertices, weights } = state();
  return {
    force,
    region: document.getElementById("region").textContent,
    shader: "DENT" in view.skin.color.defines,
    drawn: view.skin.uniforms.dentCount.value,
    share: dent()?.share,
    wanted: dents.radii.map((_, i) => vertices.reduce((sum, v, k) => sum + weights[k] * dents.share[i][v], 0)),
  };
}

test("a press gives the library's force", options, async () => {
  const places = await page.evaluate(() => {
    const head = window.palpate.head();
    const p = head.skin.positions;
    const some = [];
    for (let v = 0; v < head.skin.count && some.length < 5; v += Math.floor(head.skin.count / 7))
      if (head.status[v] <= 1) some.push([p[3 * v], p[3 * v + 1], p[3 * v + 2]]);
    return some;
  });
  assert.ok(places.length >= 3);
  let shown;
  for (const place of places) {
    for (const depth of [1, 3.5]) {
      const at = place.map((x) => x.toPrecision(17)).join(",");
      const feel = JSON.parse(execFileSync(PROGRAM, ["feel", HEAD, "--json", `--at=${at}`, `--depth=${depth}`]));
      await page.evaluate(([p, d]) => {
        clearInterval(window.pressing);
        window.palpate.link.press(p, d, true);
        window.pressing = setInterval(() => window.palpate.link.press(p, d, false), 100);
      }, [place, depth]);
      const deadline = Date.now() + PATIENCE;
      shown = { force: NaN };
      while (Date.now() < deadline && !(Math.abs(shown.force - feel.force_n) < 1e-6)) {
        await page.waitForTimeout(50);
        shown = await page.evaluate(shownNow);
      }
      assert.ok(Math.abs(shown.force - feel.force_n) < 1e-6, `${at}, ${depth} mm: page ${shown.force} N, library ${feel.force_n} N`);
      assert.equal(shown.region, feel.region);
      assert.ok(shown.shader, "the shader draws no dent");
    }
  }
  assert.equal(shown.drawn, shown.wanted.length);
  shown.wanted.forEach((share, i) => assert.ok(Math.abs(shown.share[i] - share) < 1e-6, `ring ${i}: ${shown.share[i]}, stored ${share}`));
  await page.evaluate(() => {
    clearInterval(window.pressing);
    window.palpate.link.lift();
  });
  await page.waitForFunction(() => document.getElementById("force").dataset.value === "0", null, { timeout: PATIENCE });
});

test("keys go from region to region", options, async () => {
  const now = () => page.evaluate(() => document.querySelector("#regions [aria-current=true]")?.textContent ?? "");
  const names = await page.locator("#regions button").allTextContents();
  await page.locator("#scene").focus();
  for (const [key, name] of [["n", names[0]], ["n", names[1]], ["v", names[0]], ["v", names.at(-1)]]) {
    await page.keyboard.press(key);
    assert.equal(await now(), name);
  }
  await page.keyboard.press("f");
});

test("the mouse presses, deeper when dragged down; keys press too", options, async () => {
  const box = await page.locator("#scene").boundingBox();
  const x = box.x + box.width / 2;
  const y = box.y + box.height / 2;
  const force = (least) => page.waitForFunction((f) => Number(document.getElementById("force").dataset.value) > f, least, { timeout: PATIENCE });
  await page.mouse.move(x, y);
  await page.mouse.down();
  await force(0.05);
  const first = await number("force");
  await page.mouse.move(x, y + 40, { steps: 4 });
  await force(first + 0.1);
  await page.mouse.up();
  await page.waitForFunction(() => Number(document.getElementById("force").dataset.value) === 0, null, { timeout: PATIENCE });
  await page.locator("#scene").focus();
  await page.keyboard.press("Space");
  await force(0.05);
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => Number(document.getElementById("force").dataset.value) === 0, null, { timeout: PATIENCE });
});

test("fits a laptop, a small window and a phone, light and dark", options, async () => {
  const folder = process.env.PALPATE_SCREENSHOTS ?? mkdtempSync(join(tmpdir(), "palpate-page-"));
  for (const [width, height, scheme] of [[1366, 768, "light"], [1366, 768, "dark"], [1024, 640, "light"], [390, 844, "dark"]]) {
    const other = await open(server.url, { width, height }, scheme);
    const [wide, theme] = await other.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.dataset.theme]);
    assert.ok(wide <= width, `${wide} px wide on ${width}`);
    assert.equal(theme, scheme);
    await other.screenshot({ path: join(folder, `page-${width}-${scheme}.png`) });
    await other.close();
  }
  console.log(`screenshots in ${folder}`);
});

test("says why where the browser cannot draw", options, async () => {
  const other = await browser.newPage();
  await other.addInitScript(() => {
    const start = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith("webgl") ? null : start.call(this, kind, ...more);
    };
  });
  await other.goto(server.url, { timeout: PATIENCE });
  await other.waitForFunction(() => document.getElementById("message").textContent.includes("WebGL"), null, { timeout: PATIENCE });
  await other.close();
});

test("connects again when the program comes back", options, async () => {
  const port = new URL(server.url).port;
  await server.stop();
  await page.waitForFunction(() => document.getElementById("link").className.includes("off"), null, { timeout: PATIENCE });
  server = await serve(view("--port", port));
  await page.waitForFunction(() => document.getElementById("link").textContent === "live", null, { timeout: PATIENCE });
  assert.ok(await page.locator("#message").isHidden());
});
