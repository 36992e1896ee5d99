import { defineConfig } from "vitest/config";

/** Programs are typed letter by letter: on a slow machine that takes longer than Vitest's 5 seconds. */
const LIMIT = 120_000; // ms

export default defineConfig({
  test: {
    testTimeout: LIMIT,
    hookTimeout: LIMIT,
    projects: [
      { extends: true, test: { name: "Jupyter" } },
      {
        // the whole page as in other notebooks: in a shadow root, bytes in arrays
        extends: true,
        test: { name: "elsewhere", include: ["tests/lab.test.ts"], env: { LRP_HOST: "elsewhere" } },
      },
    ],
  },
});
