"""A task waits for a time or an event, in any event loop."""

import asyncio

import pytest

from lrp_jupyter.live.running.waking import TaskEvent


class Strict(asyncio.SelectorEventLoop):
    """A loop that refuses times that have passed, as Pyodide's does; time jumps, as on a loaded machine."""

    late = 0.0

    def time(self):
        self.late += 0.001
        return super().time() + self.late

    def call_later(self, delay, callback, *args, context=None):
        if delay < 0:
            raise ValueError("Can't schedule in the past")
        return super().call_at(super().time() + delay, callback, *args, context=context)

    def call_at(self, when, callback, *args, context=None):
        return self.call_later(when - self.time(), callback, *args, context=context)


@pytest.fixture
def within():
    loops = []

    def within(loop, waiting):
        loops.append(loop)
        return loop.run_until_complete(waiting)

    yield within
    for loop in loops:
        loop.close()


def test_a_wait_that_is_over_before_it_begins_is_no_fault(within):
    async def wait():
        event = TaskEvent()
        for microseconds in range(0, 5000, 100):
            await event.wait(microseconds / 1e6)
        return "waited"

    assert within(Strict(), wait()) == "waited"


@pytest.mark.parametrize("seconds", [None, 0, 3600])
def test_other_tasks_run_while_one_waits_for_what_has_happened(within, seconds):
    async def wait():
        event, seen = TaskEvent(), []
        asyncio.get_running_loop().call_soon(seen.append, "other")
        event._event.set()
        await event.wait(seconds)
        return seen

    assert within(asyncio.new_event_loop(), wait()) == ["other"]


def test_an_event_ends_a_wait_and_a_wait_without_one_ends_by_itself(within):
    async def wait():
        event, loop = TaskEvent(), asyncio.get_running_loop()
        loop.call_soon(event.set)
        await event.wait(3600)
        event.clear()
        await event.wait(0.001)
        return loop._scheduled

    assert within(asyncio.new_event_loop(), wait()) == []
