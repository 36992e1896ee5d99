"""What a page can do with the runs that are kept beside the program."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from lrp_jupyter.widgets.acts.messages import OpenProgram, act
from lrp_jupyter.widgets.acts.program_acts import Applied
from lrp_jupyter.widgets.wire.codec import Between


@act(30.0)
def keep_run(opened: OpenProgram, name: str = "", expected: str = "") -> Applied:
    """Keep the present run, from its beginning until now, under a name, and what is expected of it."""
    return opened.work(partial(opened.runs.keep, opened.session, name, expected))


@act(is_present=True)
def new_run(opened: OpenProgram) -> Applied:
    """Put the world back to its start, and start the program again: what follows can be kept."""
    return opened.work(partial(opened.runs.begin, opened.session))


@act()
def expect(opened: OpenProgram, name: str, expected: str) -> None:
    """Write what is expected of a kept run: one line."""
    opened.runs.expect(name, expected)


@act(30.0)
def show_run(opened: OpenProgram, name: str) -> Applied:
    """Run a kept run again in the lab, and look at its first difference, or where it fails."""
    return opened.work(partial(opened.runs.show, opened, name))


@act(30.0)
def accept_run(opened: OpenProgram, name: str) -> Applied:
    """Record a kept run again with the present program."""
    return opened.work(partial(opened.runs.accept, opened.session, name))


@act()
def rename_run(opened: OpenProgram, name: str, new_name: str) -> None:
    """Give a kept run another name."""
    opened.runs.rename(name, new_name)


@act()
def forget_run(opened: OpenProgram, name: str) -> None:
    """Delete a kept run; its file goes to the folder ``.removed`` among the runs."""
    opened.runs.forget(name)


@act()
def attach_runs(opened: OpenProgram, folder: str) -> None:
    """Also show and run the recordings in another folder."""
    opened.runs.attach_folder(folder)


# -- the smallest change ---------------------------------------------------------------------------------


@act()
def find_change(opened: OpenProgram) -> None:
    """Search for the smallest change that makes the program pass its challenge and its kept runs."""
    opened.search.begin(opened.session, opened.texts.text, opened.goal, opened.runs.all)


@act()
def stop_search(opened: OpenProgram) -> None:
    """End the search; what it has found so far is its answer."""
    opened.search.stop()


@act()
def take_change(opened: OpenProgram, index: Annotated[int, Between(0, 100)]) -> None:
    """Write a change that was found into the text."""
    opened.texts.write(opened.search.changed(opened.texts.text, index))
