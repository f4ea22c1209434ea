// SPDX-License-Identifier: GPL-3.0-or-later
// Moving landmarks in a headless browser against the real program: by keys and by hand, kept in the
// file beside the head, and a skull fitted with them.
import assert from "node:assert/strict";
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { REAL, launch, missing, serve } from "./browser.mjs";

const why = missing() || (REAL && existsSync(REAL) ? "" : "PALPATE_TEST_REAL does not name a head.glb");
if (why) console.log(`points tests skipped: ${why}`);
const options = { skip: why || false, timeout: 400_000 };
const PATIENCE = 120_000; // ms: the machine may be busy and draws in software
const FIT = 300_000; // ms

let browser, server, page, folder, file;
const complaints = [];

before(async () => {
  if (why) return;
  folder = mkdtempSync(join(tmpdir(), "palpate-points-"));
  file = join(folder, "head.landmarks.txt");
  copyFileSync(REAL, join(folder, "head.glb"));
  server = await serve(["view", join(folder, "head.glb"), "--no-open", "--json", "--port", "0"]);
  browser = await launch();
  page = await browser.newPage({ viewport: { width: 1366, height: 768 }, colorScheme: "light" });
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("console", (m) => m.type() === "error" && complaints.push(m.text()));
  await page.goto(server.url, { timeout: PATIENCE });
  await page.waitForFunction(() => document.documentElement.dataset.ready === "yes", null, { timeout: PATIENCE });
}, { timeout: 240_000 });
after(async () => {
  await browser?.close();
  await server?.stop();
  if (folder) rmSync(folder, { recursive: true });
});

const row = (name) => page.locator("#points-list li", { hasText: new RegExp(`^${name}`) });
const mark = (name) => page.locator(`.mark[aria-label^="${name}"]`);
const moved = async (name) => Number(await row(name).locator("output").getAttribute("data-value"));
const now = (name) => page.evaluate((n) => window.palpate.points().marks.find((m) => m.name === n), name.replaceAll(" ", "_"));
const noteIs = (word) => page.waitForFunction(
  (w) => window.palpate.points().state?.note?.kind === w, word, { timeout: PATIENCE });

/** Of a line of the file, in the head frame. */
function kept(name) {
  const bytes = readFileSync(join(folder, "head.glb"));
  const json = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
  const { unit_mm, frame } = json.extensions.PALPATE_touchable_head;
  const words = readFileSync(file, "utf8").split("\n").map((line) => line.split(" ")).find((w) => w[1] === name);
  const mm = words.slice(2, 5).map((x, k) => unit_mm * Number(x) - frame.origin_mm[k]);
  return { state: words[0], at: frame.rotation.map((r) => r[0] * mm[0] + r[1] * mm[1] + r[2] * mm[2]) };
}

test("a key opens the mode: every landmark of the file is a named button on the skin", options, async () => {
  await page.keyboard.press("m");
  await page.waitForFunction(() => document.querySelectorAll("#points-list li").length === 7, null, { timeout: PATIENCE });
  assert.equal(await page.locator("#points-button").getAttribute("aria-pressed"), "true");
  assert.equal(await page.locator(".mark").count(), 7);
  assert.match(await mark("nose tip").getAttribute("aria-label"), /arrow keys move it/);
  const [x, y] = await page.evaluate(() => window.palpate.view.place(window.palpate.points().marks.find((m) => m.name === "nose_tip").position));
  const box = await mark("nose tip").boundingBox();
  assert.ok(Math.hypot(box.x + box.width / 2 - x, box.y + box.height / 2 - y) < 1.5, "the mark is where its point is");
});

test("arrow keys move a point over the skin; undo and reset bring it back", options, async () => {
  await row("nose tip").locator(".name").click();
  for (let i = 0; i < 3; ++i) await page.keyboard.press("ArrowUp");
  const three = await moved("nose tip");
  assert.ok(three > 1 && three < 3, `${three} mm`);
  await page.keyboard.press("Shift+ArrowUp");
  const more = (await moved("nose tip")) - three;
  assert.ok(more > 0.02 && more < 0.4, `${more} mm`);
  await page.keyboard.press("Backspace");
  assert.equal(await moved("nose tip"), three);
  await row("nose tip").getByRole("button", { name: /^Reset|back to/ }).click();
  assert.equal(await moved("nose tip"), 0);
  await row("nose tip").getByRole("button", { name: /undo/ }).click();
  assert.equal(await moved("nose tip"), three);
});

test("a point follows the mouse and stays on the skin", options, async () => {
  const box = await mark("nose corner left").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 4, y - 5, { steps: 3 });
  await page.mouse.up();
  const mm = await moved("nose corner left");
  assert.ok(mm > 0.5 && mm < 8, `${mm} mm`);
  assert.equal(await page.evaluate(() => window.palpate.state()?.inContact ?? false), false, "moving a point does not press");
  await row("nose corner left").getByRole("button", { name: /^Reset|back to/ }).click();
});

test("points are kept beside the head, and not over another's file unasked", options, async () => {
  writeFileSync(file, "# not ours\n");
  await page.locator("#points-save").click();
  await noteIs("exists");
  assert.ok(await page.locator("#points-exists").isVisible());
  assert.equal(readFileSync(file, "utf8"), "# not ours\n");
  await page.locator("#points-replace").click();
  await noteIs("saved");
  const { position } = await now("nose tip");
  const { state, at } = kept("nose_tip");
  assert.equal(state, "fixed");
  const off = Math.hypot(...at.map((v, k) => v - position[k]));
  assert.ok(off < 0.001, `${off} mm from where it was put`);
  assert.equal(kept("eye_outer_left").state, "found");
  assert.match(await page.locator("#points-command").textContent(), /^palpate build .*--landmark-file .*--edge 4 /);
});

test("the skull is fitted again with them, and shown", options, async () => {
  await page.locator("#points-run").click();
  await page.waitForFunction(() => !document.getElementById("points-progress").hidden, null, { timeout: PATIENCE });
  assert.match(await page.locator("#points-stage").textContent(), /s left/);
  await page.waitForFunction(() => !document.getElementById("points-fit").hidden ||
    document.getElementById("points-note").className === "bad", null, { timeout: FIT });
  assert.ok(await page.locator("#points-fit").isVisible(), await page.locator("#points-note").textContent());
  const [depth, skull, opacity, map] = await page.evaluate(() => {
    const { head, view } = window.palpate;
    return [head().depth.reduce((a, b) => Math.max(a, b)), head().skull.count, view.opacity, document.documentElement.dataset.map];
  });
  assert.ok(depth > 5 && depth < 100, `${depth} mm`);
  assert.ok(skull > 1000 && opacity < 1);
  assert.equal(map, "depth");
  if (process.env.PALPATE_SCREENSHOTS) await page.screenshot({ path: join(process.env.PALPATE_SCREENSHOTS, "points-fit.png") });
  assert.ok(await page.locator("#points-since").isHidden());
  await mark("nose tip").focus();
  await page.keyboard.press("ArrowUp");
  assert.ok(await page.locator("#points-since").isVisible(), "the skull shown is not that of the points shown");
  await page.keyboard.press("Backspace");
  await page.getByText("of the file", { exact: true }).click();
  assert.equal(await page.evaluate(() => window.palpate.head().depth[0]), 10, "the file's own again");
});

test("what was kept is there after a new start", options, async () => {
  const port = new URL(server.url).port;
  await server.stop();
  server = await serve(["view", join(folder, "head.glb"), "--no-open", "--json", "--port", port]);
  complaints.length = 0; // the sockets that broke
  await page.goto(server.url, { timeout: PATIENCE });
  await page.waitForFunction(() => document.documentElement.dataset.ready === "yes", null, { timeout: PATIENCE });
  await page.locator("#points-button").click();
  await page.waitForFunction(() => document.querySelectorAll("#points-list li").length === 7, null, { timeout: PATIENCE });
  assert.ok((await moved("nose tip")) > 1);
  assert.match(await page.locator("#points-note").textContent(), /file beside the head/);
  await page.keyboard.press("m");
  assert.ok(await page.locator("#points-card").isHidden());
  assert.ok(await page.locator("#readings").isVisible());
  assert.deepEqual(complaints, []);
});
