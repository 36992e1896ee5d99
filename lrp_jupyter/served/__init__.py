"""A robot's own page: ``lrp run --serve`` serves the lab of its run to browsers, without Jupyter.

A page speaks the messages of the lab over a WebSocket, once it has shown the token of the run. Whoever has
the token can do what the lab can, and a program is Python: it can do whatever its user can on this computer.
"""
