// SPDX-License-Identifier: GPL-3.0-or-later
import { defineConfig } from "vite";

// `npm run dev` serves the sources and hands everything live to a running `palpate view --port 8733`.
const palpate = "http://127.0.0.1:8733";

export default defineConfig({
  base: "./",
  build: {
    target: "es2022",
    chunkSizeWarningLimit: 1000,
    assetsInlineLimit: 0,
    // The study's pages are entries of their own: a participant's page loads nothing of the map's.
    rollupOptions: { input: ["index.html", "study/participant.html", "study/experimenter.html"] },
  },
  server: {
    proxy: {
      "/head.glb": palpate,
      "/live": {
        target: palpate,
        ws: true,
        changeOrigin: true,
        configure: (proxy) =>
          proxy.on("proxyReqWs", (request) => request.setHeader("origin", palpate)),
      },
    },
  },
});
