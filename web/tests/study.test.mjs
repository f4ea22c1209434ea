// SPDX-License-Identifier: GPL-3.0-or-later
// A study in two browser windows against the real program: by keys alone, blind where it must be.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, before, test } from "node:test";
import { HEAD, PROGRAM, launch, missing } from "./browser.mjs";

const why = missing();
if (why) console.log(`study page tests skipped: ${why}`);
const options = { skip: why || false, timeout: 400_000 };
const PATIENCE = 120_000; // ms: the machine may be busy
const REGIONS = ["cranium", "forehead", "eyebrow", "cheekbone", "cheek", "chin", "jaw"];
/** All that a participant's page may be told. */
const TOLD = new Set(["kind", "number", "title", "text", "place", "places", "interval", "picture", "paused", "simulated",
  "error", "question", "choose", "barred", "ready", "left_s"]);

const folder = mkdtempSync(join(tmpdir(), "palpate-study-"));
const shots = process.env.PALPATE_SCREENSHOTS ?? folder;
let program, urls, browser, experimenter, participant;
const frames = []; // what the participant's socket got
const files = []; // what the participant's page fetched

/** The shipped protocol with short touches. */
function quickProtocol() {
  const source = new URL("../../protocols/head-stiffness-2015.toml", import.meta.url);
  const text = readFileSync(source, "utf8").replace("seconds = [10, 15]", "seconds = [0.2, 0.4]").replaceAll("seconds = [5, 60]", "seconds = [0.2, 0]");
  const path = join(folder, "quick.toml");
  writeFileSync(path, text);
  return path;
}

function start() {
  program = spawn(PROGRAM, ["study", "run", quickProtocol(), HEAD, "-o", join(folder, "study.db"), "--seed", "3",
    "--device", "simulated", "--priority", "0", "--no-open", "--json"], { stdio: ["ignore", "pipe", "inherit"] });
  const found = {};
  return new Promise((resolve, reject) => {
    program.on("exit", (code) => reject(new Error(`palpate ended with ${code}`)));
    createInterface({ input: program.stdout }).on("line", (line) => {
      if (found.participant && found.experimenter) return; // the rest is the report at the end
      Object.assign(found, JSON.parse(line));
      if (found.participant && found.experimenter) resolve(found);
    });
  });
}

before(async () => {
  if (why) return;
  urls = await start();
  browser = await launch();
  experimenter = await browser.newPage({ viewport: { width: 1200, height: 720 } });
  participant = await browser.newPage({ viewport: { width: 1000, height: 720 } });
  participant.on("websocket", (socket) => socket.on("framereceived", (frame) => frames.push(frame.payload)));
  participant.on("response", async (response) => {
    files.push({ url: response.url(), body: await response.text().catch(() => "") });
  });
  await experimenter.goto(urls.experimenter);
  await participant.goto(urls.participant);
}, options);
after(async () => {
  await browser?.close();
  if (!program) return;
  const ended = new Promise((resolve) => program.once("exit", resolve));
  program.removeAllListeners("exit");
  program.kill("SIGINT");
  await Promise.race([ended, new Promise((resolve) => setTimeout(resolve, 5000))]);
});

const screenOf = () => participant.evaluate(() => document.documentElement.dataset.screen ?? "");
const changed = (from) =>
  participant.waitForFunction((old) => document.documentElement.dataset.screen !== old, from, { timeout: PATIENCE });

/** Answers the screen that is there with keys; stops before the first whose title is `until`. */
async function answerUntil(until, shotsOf = {}) {
  for (;;) {
    const screen = await screenOf();
    const kind = screen.split(" ")[0];
    const title = (await participant.locator("h1").first().textContent().catch(() => "")) ?? "";
    if (title === until || kind === "finished" || kind === "excused") return kind;
    const shot = Object.keys(shotsOf).find((k) => k === `${title}/${kind}`);
    if (shot) {
      await participant.waitForTimeout(400);
      await participant.screenshot({ path: join(shots, shotsOf[shot]) });
      delete shotsOf[shot];
    }
    const keys = participant.keyboard;
    if (kind === "touch") {
      await participant.waitForFunction((old) => document.documentElement.dataset.screen !== old ||
        !document.querySelector("button.main")?.disabled, screen, { timeout: PATIENCE });
      await keys.press("Space");
    } else if (kind === "choose") {
      const free = await participant.locator(".places input:not(:disabled)").evaluateAll((all) => all.slice(0, 2).map((x) => x.value));
      for (const place of free) await keys.press(place);
      await keys.press("Enter");
    } else {
      if (await participant.locator(".scale").count()) {
        await keys.press("7");
        await keys.press("ArrowRight");
        await keys.press("Enter");
      } else if (await participant.locator("label.option").count()) {
        await keys.press("1");
        await keys.press("Enter");
      } else if (await participant.locator("input[type=number]").count()) {
        await keys.type("30");
        await keys.press("Enter");
      } else if (await participant.locator("textarea").count()) {
        await keys.type("at the side");
        await keys.press("Control+Enter");
      } else {
        await keys.press("Enter");
      }
    }
    await changed(screen);
  }
}

const begin = async () => {
  await experimenter.waitForFunction(() => !document.getElementById("start").disabled, null, { timeout: PATIENCE });
  await experimenter.keyboard.press("n");
  await participant.waitForFunction(() => document.documentElement.dataset.screen?.startsWith("consent"), null, { timeout: PATIENCE });
};

/** What was told in the touch-only part, without the clock. */
function story(from) {
  const told = [];
  for (const payload of frames.slice(from)) {
    if (typeof payload !== "string") continue;
    const { left_s, ready, ...rest } = JSON.parse(payload);
    const text = JSON.stringify(rest);
    if (rest.title === "By touch alone" && told.at(-1) !== text) told.push(text);
  }
  return told;
}

let firstStory;
test("touch alone tells the participant's page no region, no stiffness, no order", options, async () => {
  await begin();
  await answerUntil("By touch alone", { "About you/question": "study-question.png" });
  assert.equal(await participant.locator("#picture").isHidden(), true);
  await experimenter.waitForTimeout(300);
  await answerUntil("By touch and sight", { "By touch alone/touch": "study-touch.png", "By touch alone/question": "study-rating.png" });
  const words = new RegExp(`\\b(${REGIONS.join("|")})s?\\b`, "i");
  let texts = 0;
  for (const payload of frames) {
    assert.equal(typeof payload, "string", "a picture's frame came while the screen was dark");
    assert.doesNotMatch(payload, words);
    for (const key of Object.keys(JSON.parse(payload))) assert.ok(TOLD.has(key), `the page was told ${key}`);
    ++texts;
  }
  assert.ok(texts > 40);
  for (const { url, body } of files) {
    assert.doesNotMatch(url, /head\.glb|skin\.bin/);
    assert.doesNotMatch(body, words, url);
  }
  firstStory = story(0);
  assert.ok(firstStory.length >= 7 * 2 + 2);
});

test("touch and sight shows the head and asks where", options, async () => {
  const before = frames.length;
  await answerUntil("The whole head", { "By touch and sight/touch": "study-sight.png" });
  assert.ok(files.some(({ url }) => url.endsWith("/study/skin.bin")));
  assert.ok(frames.slice(before).some((f) => typeof f !== "string"), "no picture moved");
  assert.equal(await answerUntil("nothing"), "finished");
});

test("the experimenter sees the region, pauses, and withdraws by keys", options, async () => {
  await experimenter.keyboard.press("l");
  const from = frames.length;
  await begin();
  await answerUntil("Getting to know the device");
  await participant.keyboard.press("Enter");
  await participant.waitForFunction(() => document.documentElement.dataset.screen?.startsWith("touch"), null, { timeout: PATIENCE });
  await participant.keyboard.press("Escape");
  await experimenter.waitForFunction(() => document.getElementById("now").textContent.includes("PAUSED"), null, { timeout: PATIENCE });
  const now = await experimenter.locator("#now").textContent();
  assert.ok(REGIONS.some((r) => now.includes(r)), now);
  await experimenter.screenshot({ path: join(shots, "study-experimenter.png") });
  const paused = await screenOf();
  await participant.keyboard.press("Enter");
  await participant.waitForTimeout(300);
  assert.equal(await screenOf(), paused, "a pause takes no answers");
  await experimenter.keyboard.press("p");
  await answerUntil("By touch and sight");
  const second = story(from);
  assert.deepEqual(second.slice(0, firstStory.length).length, firstStory.length);
  assert.deepEqual(second, firstStory, "another order told another story");
  const withdraw = experimenter.getByRole("row", { name: /P002/ }).getByRole("button", { name: "Withdraw" });
  await withdraw.focus();
  await experimenter.keyboard.press("l");
  await experimenter.waitForFunction(() => document.documentElement.dataset.current === "", null, { timeout: PATIENCE });
  assert.ok(await withdraw.evaluate((button) => button === document.activeElement), "new rows took the focus away");
  await experimenter.keyboard.press("Enter");
  await experimenter.waitForFunction(() => document.getElementById("sure").open, null, { timeout: PATIENCE });
  await experimenter.getByRole("button", { name: "Delete" }).press("Enter");
  await experimenter.waitForFunction(() => document.getElementById("people").textContent.includes("withdrawn"), null, { timeout: PATIENCE });
});

test("another page without the key is no experimenter", options, async () => {
  const other = await browser.newPage();
  await other.goto(urls.experimenter.split("#")[0]);
  await other.waitForTimeout(1500);
  assert.match(await other.locator("#link").textContent(), /lost/);
  assert.equal(await other.locator("#people tr").count(), 0);
  await other.close();
});
