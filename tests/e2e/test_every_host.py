"""What every host promises, in JupyterLab and Notebook; marimo and Voila have files of their own."""

import pytest

from e2e import hosts


@pytest.mark.parametrize("app", ["lab/tree", "notebooks"])
def test_the_lab_works_and_is_there_again_when_the_page_is_loaded_again(page, server, app):
    with hosts.jupyter(page, server, app) as host:
        host.works()
        host.shows_it_again()
