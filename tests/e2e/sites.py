"""The pages of a static site as a visitor uses them: the plain page, and notebooks in JupyterLite."""

import zlib
from base64 import urlsafe_b64encode

from e2e.pages import APP, LabPage, NotebookPage, comes_true

COUNT = """\
(var n := [0])
(machine m
  (state count (running [n = n + 1])))
(spawn m count)
"""
STORED = """words => new Promise(resolve => {
  const opening = indexedDB.open("lrp-texts");
  opening.onsuccess = () => {
    const reading = opening.result.transaction("files").objectStore("files").getAll();
    reading.onsuccess = () => {
      opening.result.close();
      const texts = reading.result.map(content => new TextDecoder().decode(content));
      resolve(texts.some(text => text.includes(words)));
    };
  };
})"""
GO = """url => {
  document.querySelector('[data-lrp="lab"]').dataset.old = "";
  history.pushState(null, "", url);
  dispatchEvent(new PopStateEvent("popstate"));
}"""


def link(name, text=COUNT):
    """The address of a shared program, as the page makes it."""
    packed = zlib.compress(text.encode(), wbits=-15)
    return f"?program={name}#text={urlsafe_b64encode(packed).decode().rstrip('=')}"


class PlainPage(LabPage):
    """The page of a visitor."""

    def __init__(self, page, site):
        super().__init__(page)
        self.site = site

    def go(self, address):
        """Go to an address; Python stays, if the page is there already."""
        url = f"{self.site.url}/{address}"
        if self.page.url.split("?")[0].split("#")[0] == f"{self.site.url}/":
            self.page.evaluate(GO, url)
        else:
            self.page.goto(url)

    def show(self, address="", status="running"):
        self.go(address)
        self.page.locator("[data-old]").wait_for(state="detached")
        return self.ready(status)

    def again(self, status="running"):
        self.page.reload()
        return self.ready(status)

    def stores(self, words):
        """Wait until the browser has stored a text that contains these words."""
        comes_true(self.page, STORED, words)

    def says(self, words):
        """Wait until the line below the title says this."""
        self.page.locator("#status", has_text=words).wait_for()

    def drives(self):
        """Wait until the robot is painted at another place."""
        self.goes_on()
        picture = self.find(".lrp-canvas").evaluate("canvas => canvas.toDataURL()")
        self.until("(canvas, picture) => canvas.toDataURL() !== picture", ".lrp-canvas", picture)


class SiteNotebook(NotebookPage):
    """A notebook in JupyterLite."""

    def __init__(self, page, site, name):
        self.page, self.site, self.name = page, site, name

    def show(self, kernel=None):
        """Open it, with a kernel that runs already if there is one."""
        self.command("docmanager:open", path=self.name, kernel=kernel)
        return self.ready()

    def run(self):
        """Run the first two code cells, of which the second has a lab; return the lab."""
        first, second = self.page.evaluate(
            f"{APP}.content.widgets.flatMap((cell, at) => cell.model.type === 'code' ? [at] : []).slice(0, 2)"
        )
        self.run_cell(first)
        self.begin_cell(second)
        return PlainPage(self.page, self.site).ready()

    def run_all(self):
        """Run all cells to their ends; return the errors."""
        code = f"{APP}.content.widgets.filter(cell => cell.model.type === 'code')"
        error = "cell => cell.model.sharedModel.outputs.some(output => output.output_type === 'error')"
        self.page.evaluate(
            f"() => {{ for (const cell of {code}) cell.model.executionCount = null;"
            " void jupyterapp.commands.execute('notebook:run-all-cells'); }"
        )
        self.page.wait_for_function(
            f"(cells => cells.every(cell => cell.model.executionCount) || cells.some({error}))({code})"
        )
        return self.page.evaluate(
            f"{code}.flatMap(cell => cell.model.sharedModel.outputs)"
            ".filter(output => output.output_type === 'error')"
            ".map(output => `${output.ename}: ${output.evalue}`)"
        )
