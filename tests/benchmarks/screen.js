// What can be seen of a lab, in px of the page; it knows elements by the names that they have for tests.
window.screenBench = (() => {
  const CLIPS = /auto|scroll|hidden|clip/;
  const intersect = (a, b) => ({
    left: Math.max(a.left, b.left),
    top: Math.max(a.top, b.top),
    right: Math.min(a.right, b.right),
    bottom: Math.min(a.bottom, b.bottom),
  });
  const area = ({ left, top, right, bottom }) => Math.max(0, right - left) * Math.max(0, bottom - top);
  const isThere = element =>
    element.isConnected && element.checkVisibility({ visibilityProperty: true, opacityProperty: true });

  /** The part of an element that nothing around it cuts off; of no size if it is not shown. */
  function seen(element) {
    let box = element.getBoundingClientRect();
    box = intersect(box, { left: 0, top: 0, right: innerWidth, bottom: innerHeight });
    if (!isThere(element)) return { ...box, right: box.left };
    for (let around = element.parentElement; around !== document.body; around = around.parentElement) {
      const { overflowX, overflowY } = getComputedStyle(around);
      if (CLIPS.test(overflowX + overflowY) || around.localName === "svg")
        box = intersect(box, around.getBoundingClientRect());
    }
    return box;
  }

  /** The share of an element's height that can be seen, if its width can; 0 if something lies over its middle. */
  function shareSeen(element) {
    const whole = element.getBoundingClientRect();
    const { left, top, right, bottom } = seen(element);
    if (!whole.height || right - left < whole.width - 1 || bottom <= top) return 0;
    const above = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
    const isCovered = above && !element.contains(above) && !above.contains(element);
    return isCovered ? 0 : Math.min(1, (bottom - top + 0.5) / whole.height);
  }

  /** How many lines of the program can be seen; one that is wrapped is several. */
  function lines(root) {
    const all = [...root.querySelectorAll(".cm-content .cm-line")];
    const height = parseFloat(getComputedStyle(all[0]).lineHeight);
    return all.reduce((sum, line) => sum + Math.max(0, seen(line).bottom - seen(line).top), 0) / height;
  }

  const shares = (root, selector) => [...root.querySelectorAll(selector)].map(shareSeen);

  /** The floor of a world in the window, the part of it that can be seen, the px of a metre. */
  function world(root, [width, height]) {
    const canvas = root.querySelector(".lrp-canvas");
    const { left, top } = canvas.getBoundingClientRect();
    const [x, base, scale] = canvas.dataset.view.split(" ").map(Number);
    const floor = {
      left: left + x,
      top: top + base - height * scale,
      right: left + x + width * scale,
      bottom: top + base,
    };
    const part = intersect(floor, seen(canvas));
    return {
      share: area(canvas.getBoundingClientRect()) / area(root.getBoundingClientRect()),
      whole: area(part) >= 0.995 * area(floor),
      scale,
      floor: part,
    };
  }

  /** Which pixels of a picture lie in a square of one colour; squares are tried at every quarter of their side. */
  function empty(pixels, width, height, side) {
    const step = side / 4;
    const found = new Uint8Array(width * height);
    const isPlain = (x, y) => {
      const first = 4 * (y * width + x);
      for (let row = y; row < y + side; row++) {
        for (let at = 4 * (row * width + x); at < 4 * (row * width + x + side); at += 4) {
          for (let channel = 0; channel < 3; channel++)
            if (Math.abs(pixels[at + channel] - pixels[first + channel]) > 3) return false;
        }
      }
      return true;
    };
    for (let y = 0; y + side <= height; y += step) {
      for (let x = 0; x + side <= width; x += step) {
        if (!isPlain(x, y)) continue;
        for (let row = y; row < y + side; row++) found.fill(1, row * width + x, row * width + x + side);
      }
    }
    return found;
  }

  /** The share of the lab that is empty, by what it lies in; the floor of the world is not. */
  async function white(root, picture, floor, side) {
    const image = new Image();
    image.src = `data:image/png;base64,${picture}`;
    await image.decode();
    const { width, height } = image;
    const c = new OffscreenCanvas(width, height).getContext("2d");
    c.drawImage(image, 0, 0);
    const found = empty(c.getImageData(0, 0, width, height).data, width, height, side);
    const whole = root.getBoundingClientRect();
    const boxes = [...root.querySelectorAll("[data-lrp]")]
      .filter(isThere)
      .map(each => [each.dataset.lrp, each.getBoundingClientRect()]);
    const counts = {};
    let all = 0;
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        const [px, py] = [whole.left + x, whole.top + y];
        const isIn = ({ left, top, right, bottom }) => px >= left && px < right && py >= top && py < bottom;
        if (!found[y * width + x] || isIn(floor)) continue;
        const name = boxes.findLast(([, box]) => isIn(box))?.[0] ?? "elsewhere";
        counts[name] = (counts[name] ?? 0) + 1;
        all++;
      }
    }
    const share = count => count / (width * height);
    return [share(all), Object.entries(counts).map(([name, count]) => [name, share(count)])];
  }

  return { lines, shares, world, white };
})();
