"""A notebook and a lab in a page, as a person works with them: by pointer and keyboard, by what is shown."""

APP = "window.jupyterapp?.shell?.currentWidget"
WAS_RELOADED = "performance.getEntriesByType('navigation')[0].type === 'reload'"
KERNEL = """async code => {
  const kernel = jupyterapp.shell.currentWidget.sessionContext.session.kernel;
  const future = kernel.requestExecute({ code, store_history: false });
  let text = "";
  future.onIOPub = ({ header, content }) => { if (header.msg_type === "stream") text += content.text; };
  const { content } = await future.done;
  if (content.status === "error") throw new Error(`${content.ename}: ${content.evalue}`);
  return text;
}"""
END_ALL = """\
from lrp_jupyter.widgets import registry
for each in list(registry.running()):
    registry.forget(each)
"""
SESSION = """\
from lrp_jupyter.widgets import registry
session = [*registry.running()][-1].session
"""
IS_TABLET = "matchMedia('(pointer: coarse)').matches"
AT_REST = """async (root, selector) => {
  let last = "";
  for (let frame = 0, same = 0; same < 10; frame++) {
    if (frame > 2000) throw new Error(`${selector} does not come to rest: ${last}`);
    const node = root.querySelector(selector);
    const { x, y, width, height } = node?.getBoundingClientRect() ?? {};
    const hit = width > 0 && root.getRootNode().elementFromPoint(x + width / 2, y + height / 2);
    if (width > 0 && !root.contains(hit)) node.scrollIntoView({ block: "center" });
    const now = JSON.stringify([x, y, width, height, node?.dataset.view]);
    const settled = width > 0 && !node.closest("[data-unsettled]");
    same = settled && now === last ? same + 1 : 0;
    last = now;
    await new Promise(requestAnimationFrame);
  }
  const { x, y, width, height } = root.querySelector(selector).getBoundingClientRect();
  return { x, y, width, height };
}"""


def close_all(page):
    """Close everything in JupyterLab without asking; return whether it is still usable.

    One that was loaded again is not: it may open once more, and late, what it had opened before.
    """
    if page.is_closed():
        return False
    forget(page)
    if "/lab" not in page.url or page.evaluate(WAS_RELOADED):
        return False
    page.evaluate("() => { for (const widget of [...jupyterapp.shell.widgets('main')]) widget.dispose(); }")
    return page.locator("dialog, .jp-Dialog").count() == 0


def forget(page):
    """Forget what JupyterLab and the lab keep in the browser."""
    if page.url.startswith("http"):
        page.evaluate("localStorage.clear()")


def comes_true(page, script, argument):
    """Wait until an asynchronous function in the page returns True."""
    asked = page.evaluate_handle("() => ({})")
    page.wait_for_function(  # which takes a promise for a result: so it looks at what the last one gave
        "([asked, argument]) => {"
        " if (!asked.waiting) {"
        f" asked.waiting = ({script})(argument);"
        " asked.waiting.then(came => Object.assign(asked, { came, waiting: null }));"
        " }"
        " return asked.came; }",
        arg=[asked, argument],
    )


class NotebookPage:
    """A notebook that is open in a browser."""

    def __init__(self, page, server, name):
        self.page, self.server, self.name = page, server, name
        self.path = server.root / name

    def show(self, app="lab/tree"):
        """Open it; JupyterLab that is there already stays."""
        if app == "lab/tree" and self.page.url.startswith(f"{self.server.url}/lab"):
            self.command("docmanager:open", path=self.name)
        else:
            self.page.goto(f"{self.server.url}/{app}/{self.name}{'?reset' if app == 'lab/tree' else ''}")
        return self.ready()

    def ready(self):
        """Wait until the kernel listens."""
        self.page.wait_for_function(
            f"path => {APP}?.context?.path === path"
            f" && {APP}.sessionContext?.session?.kernel?.status === 'idle'",
            arg=self.name,
        )
        return self

    def command(self, name, **arguments):
        self.page.evaluate(
            "async ([name, args]) => { await jupyterapp.commands.execute(name, args); }", [name, arguments]
        )

    def kernel(self, code):
        """Run code in the kernel, unseen, and return what it prints. An error is raised."""
        return self.page.evaluate(KERNEL, code)

    def open(self, program, line="m"):
        """End what runs, and open another program in the second cell."""
        self.kernel(END_ALL)
        old = self.lab().root.element_handle()
        self.write_cell(1, f"%%lrp {line}\n{program}")
        self.begin_cell(1)
        self.page.wait_for_function("old => !old.isConnected", arg=old)
        return self.lab().ready()

    def begin_cell(self, index):
        """Run a cell, and do not wait for its end."""
        self.page.evaluate(
            f"index => {{ const notebook = {APP}.content; notebook.deselectAll();"
            " notebook.activeCellIndex = index; void jupyterapp.commands.execute('notebook:run-cell'); }",
            index,
        )

    def run_cell(self, index):
        """Run a cell to its end."""
        model = f"window.jupyterapp.shell.currentWidget.content.widgets[{index}].model"
        self.page.evaluate(f"() => {{ {model}.executionCount = null; }}")
        self.begin_cell(index)
        self.page.wait_for_function(f"{model}.executionCount !== null")

    def prints(self, index):
        """Wait until a cell has shown something: then it runs, or did."""
        self.page.wait_for_function(f"{APP}.content.widgets[{index}].model.outputs.length > 0")

    def write_cell(self, index, source):
        self.page.evaluate(
            f"([index, source]) => {APP}.content.widgets[index].model.sharedModel.setSource(source)",
            [index, source],
        )

    def output(self, index):
        """Everything that a cell shows as text."""
        return self.page.locator(".jp-CodeCell").nth(index).locator(".jp-OutputArea").inner_text()

    def save(self):
        self.command("docmanager:save")
        self.is_saved()

    def is_saved(self):
        """Wait until it is saved."""
        self.page.wait_for_function(f"!{APP}.context.model.dirty")

    def close(self):
        self.page.evaluate(f"{APP}.dispose()")

    def restart_kernel(self):
        self.page.evaluate(f"{APP}.sessionContext.session.kernel.restart()")
        self.ready()

    def lab(self, index=0):
        lab = LabPage(self.page, index)
        lab.notebook = self
        return lab


class LabPage:
    """One lab in a page; what it knows, it reads there."""

    def __init__(self, page, index=0, root='[data-lrp="lab"]'):
        self.page = page
        self.root = page.locator(root).nth(index)

    def ready(self, status="running"):
        self.sees(f'css=:scope[data-lrp-status="{status}"]')
        return self

    # -- what is there ---------------------------------------------------------------------------

    def find(self, selector):
        return self.root.locator(selector)

    def sees(self, selector):
        """Wait until something is there, and return it."""
        found = self.find(selector).first
        found.wait_for(state="attached")
        return found

    def misses(self, selector):
        """Wait until something is not there."""
        self.find(selector).first.wait_for(state="detached")

    def until(self, condition, selector=":scope", argument=None):
        """Wait until ``condition(element, argument)``, a function of JavaScript, holds; return its result."""
        holds = (
            "(root, [selector, argument]) => {"
            " const element = selector === ':scope' ? root : root.querySelector(selector);"
            f" return element && ({condition})(element, argument); }}"
        )
        if at_once := self.root.evaluate(holds, [selector, argument]):
            return at_once
        result = self.page.wait_for_function(
            f"([root, ...others]) => ({holds})(root, others)",
            arg=[self.root.element_handle(), selector, argument],
        )
        return result.json_value()

    def box(self, selector=":scope"):
        """Wait until something has a size, and return its rectangle in the window, in px.

        JupyterLab takes a cell out of the page for a moment when it scrolls; then it has none.
        """
        return self.until(
            "element => { const { x, y, width, height } = element.getBoundingClientRect();"
            " return width > 0 && { x, y, width, height }; }",
            selector,
        )

    def at_rest(self, selector):
        """Wait until something is in sight and has not moved for ten frames; return its rectangle, in px."""
        return self.root.evaluate(AT_REST, selector)

    def reads(self, selector, text):
        """Wait until something has this text."""
        self.until("(element, text) => element.textContent.includes(text)", selector, text)

    @property
    def tick(self):
        return int(self.root.get_attribute("data-lrp-tick"))

    @property
    def revision(self):
        return int(self.root.get_attribute("data-lrp-revision"))

    @property
    def text(self):
        """The program's text; all of a short one is drawn."""
        return "\n".join(
            self.find(".cm-line").evaluate_all(
                "lines => lines.map(line => { const copy = line.cloneNode(true);"
                " for (const extra of copy.querySelectorAll('.lrp-inline-value')) extra.remove();"
                " return copy.textContent; })"
            )
        )

    def goes_on(self):
        """Wait until five more ticks are over."""
        self.until("(root, tick) => Number(root.dataset.lrpTick) >= tick", argument=self.tick + 5)

    def catches_up(self):
        """Wait until the page shows five ticks more than the kernel has made: and what it was sent before."""
        tick = int(self.notebook.kernel(f"{SESSION}print(session.frame.tick)"))
        self.until("(root, tick) => Number(root.dataset.lrpTick) >= tick", argument=tick + 5)

    def value(self, variable):
        return self.find(f'[data-lrp-variable="{variable}"] .lrp-value').inner_text()

    def has_value(self, variable, text):
        self.until(
            "(element, text) => element.textContent === text",
            f'[data-lrp-variable="{variable}"] .lrp-value',
            text,
        )

    def is_active(self, state):
        return self.sees(f'[data-lrp-state="{state}"][data-active]')

    # -- what is done ----------------------------------------------------------------------------

    def press(self, selector):
        """Press something, as the browser's user does, who first chooses the tab in which it is."""
        found = self.find(selector).first
        tab, is_tablet = found.evaluate(
            f"element => [element.closest('[data-behind]')?.dataset.lrp, {IS_TABLET}]"
        )
        if tab:
            self.open_tab(tab)
        found.tap() if is_tablet else found.click()

    def do(self, action):
        """Press a button."""
        self.press(f'[data-lrp-action="{action}"]')

    def open_tab(self, name):
        """Bring one of the panels that share a place to the front."""
        self.find(f'[data-lrp-tab="{name}"]').click()
        self.sees(f'[data-lrp="{name}"]:not([data-behind])')

    def pause(self):
        self.do("pause")
        self.ready("paused")
        return self

    def pause_when(self, what):
        """Set a breakpoint for once, by arguments of `Session.pause_when`; return its number."""
        return int(self.notebook.kernel(f"{SESSION}print(session.pause_when({what}, once=True).number)"))

    def is_paused_by(self, number):
        """Wait until a breakpoint has paused the program."""
        self.reads(".lrp-paused-by", f"(breakpoint {number}, ")
        return self.ready("paused")

    def rewind_to(self, tick):
        """Undo what came after a tick, however far the program has run."""
        self.notebook.kernel(f"{SESSION}session.rewind(session.frame.tick - {tick})")
        self.shows(tick)

    def shows(self, tick):
        """Wait until a tick is shown."""
        self.until("(root, tick) => Number(root.dataset.lrpTick) === tick", argument=tick)

    def select(self, text):
        """Select a piece of the program, by the editor's own search."""
        content = self.find(".cm-content")
        content.wait_for()  # its tab may come to the front, and what is hidden has no focus
        content.focus()
        self.page.keyboard.press("Control+f")
        field = self.sees('.cm-search input[name="search"]')
        field.fill(text)
        field.press("End")  # it looks when a key comes up
        field.press("Enter")
        field.press("Escape")
        self.misses(".cm-search")

    def type_after(self, text, typed):
        """Put the cursor after a piece of the program and type."""
        self.select(text)
        self.page.keyboard.press("ArrowRight")
        self.page.keyboard.type(typed)

    def replace(self, text, typed):
        """Select a piece of the program and type something else."""
        self.select(text)
        self.page.keyboard.type(typed)

    def state(self, path):
        """The box of a state."""
        return self.sees(f'[data-lrp-state="{path}"] .lrp-box')

    def choose(self, action):
        """Choose an entry of the open menu."""
        self.press(f'[role="menu"] [data-lrp-action="{action}"]')

    def place(self, x, y):
        """Return where a place of the world (metres) is on the screen."""
        return self.places((x, y))[0]

    def places(self, *points):
        """Return where places of the world (metres) are on the screen."""
        self.until(  # what was painted is of the present size
            "canvas => Math.abs(canvas.dataset.view?.split(' ')[3] - canvas.clientHeight) < 1", ".lrp-canvas"
        )
        frame = self.at_rest(".lrp-canvas")  # a legend that appears makes the world smaller
        left, base, scale, _ = map(float, self.find(".lrp-canvas").get_attribute("data-view").split())
        return [(frame["x"] + left + x * scale, frame["y"] + base - y * scale) for x, y in points]

    def drag(self, start, end):
        """Drag from a point of the screen to another."""
        mouse = self.page.mouse
        mouse.move(*start)
        mouse.down()
        mouse.move(start[0] + 6, start[1] + 6)
        mouse.move(*end, steps=6)
        mouse.up()

    def drag_robot(self, start, end, fingers=None):
        """Drag what is at a place of the world (metres) to another."""
        (fingers or self).drag(*self.places(start, end))
