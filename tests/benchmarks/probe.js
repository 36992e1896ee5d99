// What a page does to measure itself: times from an event of the browser to the picture that shows its effect.
window.probe = {
  keys: [],
  picture: null,
  // When the present state of the page is painted: a change made by a callback of a frame is in that frame.
  paint() {
    return this.picture ?? new Promise(done => requestAnimationFrame(() => done(this.picture)));
  },
  watchFrames() {
    const next = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = callback => next(time => {
      this.picture ??= new Promise(done => {
        const channel = new MessageChannel();
        channel.port1.onmessage = () => {
          this.picture = null;
          done(performance.now());
        };
        channel.port2.postMessage(0);
      });
      callback(time);
    });
  },
  wall: time => performance.timeOrigin + time,
  // From every key until something is painted; only the last element that was named is watched.
  watchKeys(element) {
    this.watching?.abort();
    this.watching = new AbortController();
    element.addEventListener("keydown", async event => {
      this.keys.push(await this.paint() - event.timeStamp);
    }, { capture: true, signal: this.watching.signal });
  },
  // From the next event of a kind until a condition holds in the lab, and is painted.
  arm(kind, root, condition) {
    this.outcome = new Promise(done => addEventListener(kind, event => {
      const holds = async () => {
        if (!condition(root)) return;
        watcher.disconnect();
        done([this.wall(event.timeStamp), this.wall(await this.paint())]);
      };
      const watcher = new MutationObserver(holds);
      watcher.observe(root, { subtree: true, childList: true, attributes: true, characterData: true });
      holds();
    }, { capture: true, once: true }));
  },
  // When which state was first painted as active.
  watchStates(root, machine) {
    this.states = [];
    new MutationObserver(changes => {
      for (const { target } of changes) {
        const path = target.getAttribute("data-lrp-state") ?? "";
        if (!path.startsWith(machine) || !target.hasAttribute("data-active")) continue;
        this.paint().then(now => this.states.push([path, this.wall(now)]));
      }
    }).observe(root, { subtree: true, attributeFilter: ["data-active"] });
  },
};
probe.watchFrames();
