"""Blocks that wait are found, and blocks that only look as if they did are not."""

import pytest

from lrp_jupyter.language.checks import check

WAITS = {
    "LRP540": [
        "while True: pass",
        "while 1:\n  robot.move()",
        "\nwhile True:\n  for i in range(3):\n    if i: break",
        "\nwhile True:\n  try: robot.move()\n  except Exception: pass",
        "\nwhile True:\n  def f(): return 1",
        "\ndef wait():\n  while True: pass\nwait()",
        "\nif robot.ready:\n  while True: pass",
    ],
    "LRP541": [
        "while not robot.bumper.data: pass",
        "while robot.distance.data > 0.3: robot.move(linear=0.1)",
        "while robot.bumper.data == 0 and abs(robot.light.data) > 3: continue",
        "while not done: pass",
        "\nx = 1\nwhile x < count: y = 2",
    ],
    "LRP542": [
        "import time; time.sleep(1)",
        "from time import sleep; sleep(0.1)",
        "import time as t; t.sleep(1)",
        "time.sleep(1)",
        "\nfrom time import sleep\ndef wait(): sleep(1)\nwait()",
    ],
    "LRP543": ["x = input()", "print(input('Name? '))"],
}
WELL = [
    "\nitems = alias = [0]\nwhile items[0] < 3: alias[0] += 1",
    "\nn = 0\nwhile n < 3: import math as n",
    "\nwhile True:\n  if robot.bumper.data: break",
    "\ndef f():\n  while True:\n    return 1\nf()",
    "\nwhile True:\n  for i in range(3): pass\n  else: break",
    "\nwhile True:\n  while True: break\n  break",
    "\ntry:\n  while True: done = iterator()\nexcept StopIteration: pass",
    "\nwhile True: x = next(values)",
    "\ndef numbers():\n  while True: yield 1\nnumbers()",
    "\nimport threading, time\ndef work():\n  while True: time.sleep(1)\n"
    "threading.Thread(target=work).start()",
    "while False: pass",
    "\nn = 5\nwhile n > 0: n -= 1",
    "while done: count = read()",
    "while values: values.pop()",
    "while len(values) > 3: del values[0]",
    "\nwhile robot.light.data > count: count += 1",
    "while queue.get(): pass",
    "while (x := robot.read()): pass",
    "clock.sleep(1)",
    "robot.input()",
    "input = 3",
]
NAMES = {"done", "count", "values", "queue", "clock", "read", "iterator", "time", "x"}


def codes(block, before=""):
    text = before + "(machine m (state a (running [" + block + "]))) (spawn m a)"
    return [finding.code for finding in check(text, NAMES) if "LRP540" <= finding.code <= "LRP549"]


@pytest.mark.parametrize(
    ("code", "block"), [(code, block) for code, blocks in WAITS.items() for block in blocks]
)
def test_a_block_that_waits_is_found_once(code, block):
    assert codes(block) == [code]


@pytest.mark.parametrize("block", WELL)
def test_a_block_that_ends_is_not_found(block):
    assert codes(block) == []


def test_variables_of_the_program_are_not_what_they_are_called():
    assert codes("time.sleep(1)", "(var time := [robot])") == []
    assert codes("input()", "(var input := [robot.read])") == []


def test_a_finding_is_at_the_head_of_the_loop():
    text = "(machine m (state a (running [\n  n = 1\n  while True:\n    n += 1])))\n(spawn m a)"
    (finding,) = check(text)
    assert (finding.line, finding.column, finding.end_column) == (3, 3, 13)
    assert "`break`" in finding.message
