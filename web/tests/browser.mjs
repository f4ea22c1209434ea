// SPDX-License-Identifier: GPL-3.0-or-later
// Headless Chromium and a `palpate view` of its own for each test file.
import { spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";

const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
export const PROGRAM = process.env.PALPATE_PROGRAM;
export const HEAD = process.env.PALPATE_TEST_HEAD;
/** the same, with skin that was completed */
export const FACE = process.env.PALPATE_TEST_FACE;

/** a face that can be fitted */
export const REAL = process.env.PALPATE_TEST_REAL;

/** Why the tests cannot run here; empty where they can. */
export function missing() {
  if (!existsSync(CHROMIUM)) return `chromium is not installed (${CHROMIUM}): apt-get install chromium`;
  if (!PROGRAM || !existsSync(PROGRAM)) return "PALPATE_PROGRAM does not name the palpate program";
  if (!existsSync(join(dirname(PROGRAM), "web", "index.html"))) return "the page is not built (npm)";
  if (!existsSync(new URL("../node_modules/playwright-core", import.meta.url))) return "playwright-core is not installed (npm ci)";
  if (!HEAD || !existsSync(HEAD)) return "PALPATE_TEST_HEAD does not name a head.glb";
  return "";
}

export async function launch(options = {}) {
  const { chromium } = await import("playwright-core");
  return chromium.launch({
    executablePath: CHROMIUM,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
    ...options,
  });
}

/** Starts the program; resolves with its address once it serves. */
export function serve(words) {
  const child = spawn(PROGRAM, words, { stdio: ["ignore", "pipe", "inherit"] });
  const lines = createInterface({ input: child.stdout });
  const ended = new Promise((resolve) => child.on("exit", resolve));
  return new Promise((resolve, reject) => {
    ended.then((code) => reject(new Error(`palpate ended with ${code}`)));
    lines.on("line", (line) => {
      const found = line.startsWith("{") ? JSON.parse(line).url : undefined;
      if (found)
        resolve({
          url: found,
          stop: async () => {
            child.kill("SIGINT");
            await ended;
          },
        });
    });
  });
}
