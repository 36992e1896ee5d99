"""The notebooks of a static site: Python, the simulator and the lab in a browser without a network."""

import shutil

import pytest

from e2e.pages import APP, comes_true
from e2e.sites import PlainPage, SiteNotebook, link
from lrp_jupyter.cli.lab_command import shipped_notebooks
from lrp_jupyter.site.build import build_site

PANELS = ("editor", "graph", "world", "variables", "issues", "timeline")


@pytest.fixture(scope="module")
def notebook(visitor, site):
    """Open a notebook of the site, whose kernel is that of the last one: it takes long to start."""
    visitor.goto(f"{site.url}/jupyter/lab/index.html")
    visitor.wait_for_function("window.jupyterapp?.shell?.currentWidget")
    kernels = [None]

    def notebook(name):
        opened = SiteNotebook(visitor, site, f"{name}.ipynb").show(kernels[-1])
        kernels.append({"id": visitor.evaluate(f"{APP}.sessionContext.session.kernel.id")})
        assert len({each["id"] for each in kernels[1:]}) == 1
        return opened

    return notebook


STORES = """async ([path, part]) => {
  try {
    const options = { type: "file", format: "text", content: true };
    return (await jupyterapp.serviceManager.contents.get(path, options)).content.includes(part);
  } catch {
    return false; // there is no such file yet
  }
}"""
KERNEL = """async code => {
  const kernel = jupyterapp.shell.currentWidget.sessionContext.session.kernel;
  const future = kernel.requestExecute({ code, store_history: false });
  let text = "";
  future.onIOPub = ({ header, content }) => {
    if (header.msg_type === "stream") text += content.text;
    if (header.msg_type === "error") text += `${content.ename}: ${content.evalue}`;
  };
  await future.done;
  return text;
}"""
BUMPER = """
(machine careful
  (event bump [robot.bumper.data == 1])
  (state driving
    (running [robot.move(linear=0.2)]))
  (state stopped
    (onentry [robot.stop()]))
  (on bump driving -> stopped))
(spawn careful driving)
"""


def test_the_first_notebook_drives_a_robot_and_grades_a_program_in_the_browser(notebook, simulator):
    opened = notebook("00-hello-live-robot")
    lab = opened.run()
    for part in PANELS:
        lab.sees(f'[data-lrp="{part}"]')
    assert lab.find('[data-lrp-action="pause"]').is_visible()
    lab.drives()
    grading = f"from lrp_jupyter import grade\nprint(grade({BUMPER!r}, 'bump and stay').passed)"
    assert opened.page.evaluate(KERNEL, grading) == "True\n"


@pytest.mark.parametrize("name", ["00-hello-live-robot", "03-time-is-a-condition", "07-line-follower-live"])
def test_a_notebook_runs_from_its_first_cell_to_its_last(name, notebook, simulator):
    assert notebook(name).run_all() == []


def test_a_program_of_the_plain_page_goes_on_in_a_notebook_which_keeps_what_is_typed(visitor, site):
    plain = PlainPage(visitor, site).show(link("shared"))
    notebook = SiteNotebook(visitor, site, "shared.ipynb")

    def opens(heading):
        plain.page.locator("#notebook").click()
        plain.page.locator(".jp-Notebook .cm-content", has_text=heading).wait_for()

    opens("%%lrp shared")
    lab = notebook.ready().run()
    assert "(machine m" in lab.text
    lab.goes_on()

    lab.select("[n = n + 1]")
    lab.page.keyboard.insert_text("[while True: pass]")
    lab.ready("paused")
    lab.reads(":scope", "did not return within")
    lab.select("while True: pass")
    lab.page.keyboard.insert_text("n = n + 2")
    lab.do("run")
    lab.ready().goes_on()
    lab.do("stop")
    lab.ready("paused")

    lab.type_after("[n = n + 2]))", "\n  (state rest)")
    lab.state("m/rest")
    comes_true(lab.page, STORES, [".lrp/shared.lrp", "(state rest)"])
    notebook.save()

    plain.show("?program=stopwatch")
    opens("%%lrp stopwatch --bridge none")  # in a notebook of its own
    visitor.goto(f"{site.url}/jupyter/notebooks/index.html?path=shared.ipynb")
    lab = notebook.ready().run()
    lab.state("m/rest")  # it was saved in the cell
    assert lab.find('[role="alertdialog"]').is_hidden()


def test_a_site_is_replaced_by_the_next_one_even_without_the_package_index(site, tmp_path, monkeypatch):
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(site.folder / "python"))
    folder = tmp_path / "site"
    folder.mkdir()
    for name in (".lrp-site", "old.txt"):
        shutil.copy(site.folder / ".lrp-site", folder / name)
    build_site(folder, shipped_notebooks(), offline=True, pyodide=site.folder / "python")
    assert not (folder / "old.txt").exists()
    wheels = {each.name for each in (site.folder / "python").iterdir()}
    assert {each.name for each in (folder / "python").iterdir()} == wheels
