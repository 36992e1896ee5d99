"""The application with all commands, in the order in which the help lists them."""

from lrp_jupyter.cli.subcommands import (  # noqa: I001
    driving as driving,
    replaying as replaying,
    source_texts as source_texts,
    marking as marking,
    assisting as assisting,
    offers as offers,
    publishing as publishing,
)
from lrp_jupyter.cli.subcommands.application import app as app
