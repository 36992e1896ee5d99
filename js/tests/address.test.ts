import { expect, test } from "vitest";
import { addressOf, readAddress } from "../src/site/address";

const PAGE = new URL("https://example.org/lrp/?program=other#text=old");

test.each([
  "(machine m (state a)) (spawn m a)\n",
  "",
  "; Grüße, 世界 🤖\r\n(var n := [1])",
  "x".repeat(50_000),
])("a text comes back from its link", async (text) => {
  const link = await addressOf({ program: "my robot", world: "line", text }, PAGE);
  expect(await readAddress(link)).toEqual({ program: "my robot", world: "line", text });
});

test("a link holds nothing that was not asked for", async () => {
  const link = await addressOf({ challenge: "maze" }, PAGE);
  expect(link.href).toBe("https://example.org/lrp/?challenge=maze");
});

test("the text is in the fragment, which browsers send to no server", async () => {
  const { hash, search } = await addressOf({ text: "(machine secret (state a))" }, PAGE);
  expect(search).toBe("");
  expect(hash).toMatch(/^#text=[\w-]+$/);
});

test("a program takes little room in its link", async () => {
  const text = "(machine m (state a) (state b) (on [robot.bumper.data] a -> b))\n".repeat(40);
  expect((await addressOf({ text }, PAGE)).href.length).toBeLessThan(300);
});

test.each(["#text=%%%", "#text=AAAA", "#text=_w"])("a damaged link is told, not opened", async (hash) => {
  await expect(readAddress(new URL(`https://example.org/${hash}`))).rejects.toThrow(/link is damaged/);
});
