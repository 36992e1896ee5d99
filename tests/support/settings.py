"""Programs whose spawns give values to variables."""

import re

from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Program


def with_settings(program: Program, machine: str, **values: str) -> Program:
    """Return the program; those who spawn a machine give these values to its variables."""
    settings = "".join(f" (var {name} := [{value}])" for name, value in values.items())
    return parse(re.sub(rf"\(spawn {machine} \w+", rf"\g<0>{settings}", program.text))
