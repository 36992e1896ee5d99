"""How many functions a reader meets on the way of a tick, a keystroke, a question: ``python FILE``.

Counted are distinct functions of the package, in a session with the simulated robot and a page;
comprehensions and lambdas are not.
"""

import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from support.bench import Bench
from support.trace import functions

from lrp_jupyter import VirtualClock, programs


def walks() -> dict[str, Callable[[], object]]:
    """The acts, by name; the page is awake, and caches are filled."""
    text = programs.load("follower")
    bench = Bench(text, bridge="sim", clock=VirtualClock())
    session, page = bench.session, bench.page()

    def keystroke() -> None:
        page.type(page.text.replace("[0.2])    ; m/s", "[0.21])    ; m/s"))

    page.type(text.replace("[1.0]       ; rad/s", "[1.1]       ; rad/s"))
    session.run(2.0)
    bench.publish()
    session.run(0.5)
    now = session.frame.tick
    return {
        "a tick": lambda: session.run(0.1),
        "publishing after it": bench.publish,
        "a keystroke": keystroke,
        "why_not": lambda: session.why_not("tend"),
        "fork": lambda: session.fork(now - 5).close(),
        "what_if": lambda: session.what_if(now - 5, text, 1.0),
    }


def main() -> None:
    """Print a table."""
    for name, act in walks().items():
        print(f"{name:24}{len({each for each in functions(act) if '<' not in each[1].rsplit('.', 1)[-1]}):6}")


if __name__ == "__main__":
    main()
