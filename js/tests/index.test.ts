import { expect, it } from "vitest";

it("the module can be loaded where there is no page", async () => {
  expect(typeof document).toBe("undefined");
  expect((await import("../src/index")).default).toHaveProperty("render");
});
