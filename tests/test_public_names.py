"""What the package offers, and what importing it costs."""

import subprocess
import sys

import lrp_jupyter

PUBLIC = """
Bridge BridgeError Controls Editor Frame Interpreter Issue Issues LRPError LRPSyntaxError Lab Machine
NoDataYet Program Session SessionClosedError SimBridge SimView StateGraph UnknownElementError Variables
VirtualClock World check diff grade parse state_graph sweep to_source
"""


def test_the_public_names_are_these():
    assert lrp_jupyter.__all__ == PUBLIC.split()
    assert all(
        getattr(lrp_jupyter, name).__module__.startswith("lrp_jupyter.") for name in lrp_jupyter.__all__
    )
    assert set(lrp_jupyter.__all__) <= set(dir(lrp_jupyter))


def test_an_unknown_name_is_an_attribute_error():
    assert not hasattr(lrp_jupyter, "Manager")


def imports(statement):
    code = f"import sys; {statement}; print(*sorted(sys.modules))"
    return set(
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout.split()
    )


def test_importing_the_package_imports_no_module_of_jupyter():
    loaded = imports("import lrp_jupyter")
    assert not {
        name
        for name in loaded
        if name.split(".")[0] in ("IPython", "ipywidgets", "anywidget", "pymunk", "lark")
    }


def test_the_bare_interpreter_imports_neither_clock_nor_thread_nor_physics():
    loaded = imports("from lrp_jupyter import Interpreter, parse")
    assert not loaded & {"IPython", "ipywidgets", "anywidget", "traitlets", "networkx", "pymunk"}
