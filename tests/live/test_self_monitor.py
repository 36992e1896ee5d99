"""Where there are no threads, a block that does not return interrupts itself."""

import asyncio
import sys
from itertools import count

import pytest

from lrp_jupyter.errors import SessionTimeoutError

pytestmark = pytest.mark.skipif(not hasattr(sys, "monitoring"), reason="Python 3.11 cannot watch itself")

BLOCKS = {
    "loop": "while True: pass",
    "caught": "\nwhile True:\n  try: pass\n  except BaseException: pass",
    "for": "\nimport itertools\nfor each in itertools.count(): pass",
    "finally": "\ntry:\n  while True: pass\nfinally:\n  while True: pass",
    "function": "\ndef wait():\n  while True: pass\nwait()",
    "comprehension": "[each for each in iter(int, 1)]",
}
PROGRAM = "(machine m (var n := [0]) (state a (running [n += 1])) (state b (running [{}]))) (spawn m {})"


@pytest.fixture
def watched(session):
    """Make sessions that a task drives."""

    def watched(text):
        return session(text, rate=100, driver="asyncio", hung_after=0.05)

    return watched


async def until(condition):
    """Let the program run until this holds."""
    for _ in range(10_000):
        if condition():
            return
        await asyncio.sleep(0.001)
    raise AssertionError("it did not come true")


@pytest.mark.parametrize("block", BLOCKS.values(), ids=BLOCKS)
def test_a_block_that_does_not_return_is_interrupted_and_the_program_pauses(watched, block):
    async def scenario():
        hanging = watched(PROGRAM.format(block, "b"))
        hanging.start()
        await until(lambda: hanging.status == "paused")
        assert "`b.running`" in hanging.frame.reason
        assert "did not return within 0.05 s" in hanging.frame.reason
        assert [issue.kind for issue in hanging.issues] == ["did not return"]

    asyncio.run(scenario())


def test_an_edit_mends_a_program_that_was_interrupted(watched):
    async def scenario():
        hanging = watched(PROGRAM.format(BLOCKS["loop"], "b"))
        hanging.start()
        await until(lambda: hanging.status == "paused")
        hanging.edit(PROGRAM.format("n += 1", "b"))
        hanging.start()
        tick = hanging.frame.tick
        await until(lambda: hanging.frame.tick > tick + 3)
        assert hanging.status == "running"

    asyncio.run(scenario())


def test_a_step_into_a_block_that_does_not_return_comes_back(watched):
    async def scenario():
        hanging = watched(PROGRAM.format(BLOCKS["loop"], "b"))
        hanging.start(paused=True)
        hanging.step()
        hanging.step()
        assert [issue.kind for issue in hanging.issues] == ["did not return"]

    asyncio.run(scenario())


def test_many_short_blocks_are_never_interrupted(session, monkeypatch):
    seconds = count(step=0.01)
    monkeypatch.setattr("lrp_jupyter.live.running.self_monitor.monotonic", lambda: next(seconds))

    async def scenario():
        busy = session(
            "(machine m (state a (running [for each in range(20): pass]))) (spawn m a)",
            driver="asyncio",
            rate=100,
            hung_after=1,
        )
        busy.start()
        await until(lambda: busy.frame.tick > 20)
        assert next(seconds) > 2, "the blocks were looked at"
        assert not busy.issues

    asyncio.run(scenario())


def test_a_run_with_a_limit_ends_where_no_thread_can_start(watched, monkeypatch):
    def refused(self):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("threading.Thread.start", refused)
    hanging = watched(PROGRAM.format(BLOCKS["loop"], "b"))
    with pytest.raises(SessionTimeoutError, match=r"`b\.running`"):
        hanging.run(seconds=1, limit=0.1)


def test_nothing_is_watched_once_all_sessions_are_closed(watched):
    async def scenario():
        one, other = watched(PROGRAM.format("pass", "a")), watched(PROGRAM.format("pass", "a"))
        one.start()
        other.start()
        one.close()
        assert sys.monitoring.get_tool(4) == "lrp"
        other.close()
        assert sys.monitoring.get_tool(4) is None

    asyncio.run(scenario())
