import random
from typing import Any

import pytest

from lrp_jupyter.graph.layout import layout
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Program

FOLLOWER = """
(var maxlook := [100])
(machine follower
  (state moving)
  (on outofline moving -> looking tlooking)
  (on intheline looking -> moving tmoving)
  (event outofline [robot.light.data > 138])
  (event intheline [robot.light.data < 118])
  (state looking
    (machine lookalgo
      (var time := [maxlook])
      (state lookleft) (state returnleft) (state lookright) (state returnright (onexit [time = time * 2]))
      (ontime time lookleft -> returnleft treturnleft)
      (ontime time returnleft -> lookright tlookright)
      (ontime time lookright -> returnright treturnright)
      (ontime time returnright -> lookleft tlookleft))
    (onentry (spawn lookalgo lookleft)))
  (var nobump := [True])
  (event bumping [robot.bumper.data == 1 and nobump])
  (event ending [robot.bumper.data == 1 and not nobump])
  (on bumping *-> bumpback)
  (on ending *-> end tend)
  (state bumpback (onentry [nobump = False]))
  (state bumpturn)
  (ontime 1000 bumpback -> bumpturn)
  (ontime 3000 bumpturn -> looking)
  (state end))
(spawn follower looking)
"""

KINDS = """
(machine kinds
  (event lowbattery [True]) (event hit [True]) (event stop [True]) (event go [True]) (event panic [True])
  (state drive) (state rest) (state check)
  (state docking
    (machine dock
      (state approach) (state align) (state locked)
      (event near [True])
      (on near approach -> align)
      (on near align -> locked)
      (exit near align -> drive giveup)
      (exit [robot.charged] locked -> drive)
      (exit near approach -> nowhere))
    (onentry (spawn dock approach)))
  (on lowbattery drive -> docking)
  (eps check -> drive)
  (ontime 500 drive -> check)
  (on hit drive -> drive)
  (ontime 20 drive -> drive)
  (on stop *-> rest)
  (on go rest -> nowhere)
  (on nosuch rest -> drive)
  (on panic {drive check} -> rest)
  (on panic *-{docking} -> rest calm))
(spawn kinds drive)
"""

LONG = """
(machine a_machine_with_a_rather_long_name_indeed
  (state approaching_the_charging_station_from_the_left)
  (state waiting_for_the_operator_to_confirm_the_docking)
  (state ok)
  (event docking_was_confirmed_by_the_operator_at_last [True])
  (on [robot.bumper.data == 1 and robot.light.data > lightlim + 10]
      approaching_the_charging_station_from_the_left -> waiting_for_the_operator_to_confirm_the_docking)
  (on docking_was_confirmed_by_the_operator_at_last
      waiting_for_the_operator_to_confirm_the_docking -> ok)
  (ontime [maximal_waiting_time * 2 + extra]
      waiting_for_the_operator_to_confirm_the_docking -> approaching_the_charging_station_from_the_left)
  (on docking_was_confirmed_by_the_operator_at_last *-> ok))
(spawn a_machine_with_a_rather_long_name_indeed approaching_the_charging_station_from_the_left)
"""


SHARED = """
(machine patrol
  (state left (onentry (spawn move go)))
  (state right (onentry (spawn move turn)))
  (state rest)
  (ontime 4000 left -> right)
  (ontime 4000 right -> left))
(machine move
  (event near [robot.distance.data < 0.1])
  (state go) (state turn)
  (on [robot.distance.data < 0.1 and robot.light.data < 3] go -> turn finished)
  (exit [robot.distance.data > 0.1 and robot.light.data < 3] go -> rest found)
  (exit near turn -> rest))
(spawn patrol left)
"""


def _figure_3() -> str:
    names = ["one", "two", "three", "four", "five"]
    forms = [f"(on never {a} -> {b})" for a in names for b in names if a != b]
    forms += [f"(on always {a} -> {b})" for a, b in zip(names, [*names[1:], "one"], strict=True)]
    states = " ".join(f"(state {name})" for name in names)
    events = "(event never [False]) (event always [True])"
    return f"(machine bench {states} {events} {' '.join(forms)}) (spawn bench one)"


def _forty() -> str:
    dice = random.Random(1)
    names = [f"s{i:02d}" for i in range(40)]
    forms = [f"(on e {names[dice.randrange(max(0, i - 4), i)]} -> {names[i]})" for i in range(1, 40)]
    for i in range(18):
        source, target = dice.sample(names, 2)
        kind = dice.choice(["on e", f"ontime {100 * i}", "eps"])
        forms.append(f"({kind} {source} -> {target})")
    states = " ".join(f"(state {name})" for name in names)
    return f"(machine forty {states} (event e [True]) {' '.join(forms)} (on e *-> s39)) (spawn forty s00)"


def _ring() -> str:
    states = " ".join(f"(state step{i})" for i in range(40))
    forms = " ".join(f"(ontime 100 step{i} -> step{(i + 1) % 40})" for i in range(40))
    return f"(machine ring {states} {forms}) (spawn ring step0)"


TEXTS = {
    "follower": FOLLOWER,
    "figure 3": _figure_3(),
    "kinds": KINDS,
    "long names": LONG,
    "shared": SHARED,
    "forty states": _forty(),
    "ring of forty": _ring(),
    "one state": "(machine single (state alone) (event e [True]) (on e alone -> alone)) (spawn single alone)",
    "no state": "(machine nothing)",
    "no machine": "",
}


@pytest.fixture(scope="session")
def programs() -> dict[str, Program]:
    return {name: parse(text) for name, text in TEXTS.items()}


@pytest.fixture(scope="session")
def drawn(programs: dict[str, Program]) -> dict[str, list[dict[str, Any]]]:
    """The first layouts of all machines of each program."""
    return {name: drawings(program) for name, program in programs.items()}


def drawings(program: Program) -> list[dict[str, Any]]:
    return [layout(machine, program=program, path=path) for path, machine in program.walk()]


@pytest.fixture(scope="session")
def follower(programs: dict[str, Program]) -> Program:
    return programs["follower"]
