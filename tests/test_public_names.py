"""What the package offers, and what importing it costs."""

import subprocess
import sys

import pytest

import lrp_jupyter

PUBLIC = """
Bridge BridgeError Controls Editor Frame Interpreter Issue Issues LRPError LRPSyntaxError Lab Machine
NoDataYet Program Session SessionClosedError SimBridge SimView StateGraph UnknownElementError Variables
VirtualClock World check decide diff grade parse repair state_graph sweep to_source
"""


def test_the_public_names_are_these():
    assert lrp_jupyter.__all__ == PUBLIC.split()
    assert all(
        getattr(lrp_jupyter, name).__module__.startswith("lrp_jupyter.") for name in lrp_jupyter.__all__
    )
    assert set(lrp_jupyter.__all__) <= set(dir(lrp_jupyter))


def test_an_unknown_name_is_an_attribute_error():
    assert not hasattr(lrp_jupyter, "Manager")


@pytest.mark.slow
def test_no_import_brings_more_than_is_needed():
    statements = (
        "import lrp_jupyter",
        "from lrp_jupyter import Interpreter, parse",
        "from lrp_jupyter import Session; Session().run(1)",
    )
    code = "import sys\nfor each in sys.argv[1:]:\n    exec(each)\n    print(*sys.modules)"
    command = [sys.executable, "-c", code, *statements]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    package, interpreter, session = map(set, map(str.split, done.stdout.splitlines()))
    jupyter = {"IPython", "ipywidgets", "anywidget"}
    assert not package & {*jupyter, "pymunk", "lark"}
    assert not interpreter & {*jupyter, "traitlets", "networkx", "pymunk"}
    assert "pymunk" not in session, "without a simulated robot"
