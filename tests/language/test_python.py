"""Python's parser in several threads."""

import ast
import gc
import sys
import threading
from collections.abc import Iterator

import pytest

from lrp_jupyter.language.python.block_suite import children, parse_suite
from lrp_jupyter.language.python.python_parser import parse_python

BLOCK = "\n".join("print([i * j for i in range(3) for j in range(i) if j])" for _ in range(5))


@pytest.fixture
def busy_collector() -> Iterator[None]:
    """Collect garbage while a tree is built, and let another thread run then."""

    def between(*_: object) -> None:
        for _ in range(3):
            pass

    interval, threshold = sys.getswitchinterval(), gc.get_threshold()
    sys.setswitchinterval(1e-6)
    gc.set_threshold(5)
    gc.callbacks.append(between)
    yield
    gc.callbacks.remove(between)
    gc.set_threshold(*threshold)
    sys.setswitchinterval(interval)


@pytest.mark.skipif(sys.platform == "emscripten", reason="Python in a page has no threads")
@pytest.mark.usefixtures("busy_collector")
@pytest.mark.parametrize("parse", [parse_python, parse_suite])
def test_two_threads_can_parse_at_once(parse: object) -> None:
    errors: list[BaseException] = []

    def work() -> None:
        try:
            for _ in range(80):
                parse(BLOCK)  # type: ignore[operator]
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert errors == []


def test_an_error_of_the_parser_is_not_asked_again() -> None:
    with pytest.raises(SyntaxError):
        parse_python("1 +")


def test_what_others_note_in_the_nodes_of_all_trees_is_no_part_of_a_tree() -> None:
    """IPython's tracebacks note a parent in every node of a file, and one `Load` is in all trees."""
    shared = ast.parse("x").body[0].value.ctx  # type: ignore[attr-defined]
    assert shared is ast.parse("y").body[0].value.ctx  # type: ignore[attr-defined]
    shared.parent = ast.parse("x = 1")
    try:
        nodes: list[ast.AST] = [*parse_suite("x + 1")[0].body]
        while nodes:
            assert not any(isinstance(node, (ast.Module, ast.Assign)) for node in nodes)
            nodes = children(nodes)
    finally:
        del shared.parent
