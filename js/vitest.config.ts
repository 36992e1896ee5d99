import { defineConfig } from "vitest/config";

/** Programs are typed letter by letter: on a slow machine that takes longer than Vitest's 5 seconds. */
const LIMIT = 120_000; // ms

export default defineConfig({ test: { testTimeout: LIMIT, hookTimeout: LIMIT } });
