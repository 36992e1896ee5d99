"""Plots of variables and readings over time."""

import threading

import pytest

from lrp_jupyter import programs
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.live.past.plots import plotting
from lrp_jupyter.live.session import Session

PROGRAM = """\
(var limit := [5])
(machine m
  (var n := [0]) (var big := [False]) (var name := ["x"])
  (event over [n > limit * 2])
  (state a (running [n += 1; big = n > 8; limit = 6 if n > 4 else 5; name += "y"]))
  (state b)
  (on over a -> b)
  (on [3 < n <= 99] b -> a))
(spawn m a)
"""


def test_the_samples_are_the_values_that_each_tick_left():
    with Session(PROGRAM) as session:
        seen = []
        session.run(1.5, after_tick=lambda: seen.append(session.interpreter.variables["m", "n"]) and False)
        (plot,) = session.plots(["m/n"])
        assert list(plot.values) == seen
        assert plot.times[:3] == (0.0, 0.1, 0.2)


def test_truth_values_are_told_from_numbers_and_texts_cannot_be_drawn():
    with Session(PROGRAM) as session:
        session.run(1.5)
        truth, text, number = session.plots(["m/big", "m/name", "limit"])
        assert (truth.kind, truth.values[0], truth.values[-1]) == ("truth", 0.0, 1.0)
        assert set(text.values) == {None}
        assert number.kind == "number"
        assert "m/name" not in session.timeline().names
        assert {"m/n", "m/big", "limit"} <= set(session.timeline().names)


def test_what_conditions_compare_with_is_evaluated_in_every_tick():
    with Session(PROGRAM) as session:
        session.run(1.5)
        (plot,) = session.plots(["m/n"])
        by_text = {each.text: each.values for each in plot.thresholds}
        assert by_text.keys() == {"limit * 2", "3", "99"}
        assert by_text["limit * 2"][:7] == (10, 10, 10, 10, 12, 12, 12)


def test_readings_of_the_robot_are_plotted_with_their_limits():
    with Session(programs.load("follower"), "sim", world="line") as session:
        session.run(5)
        (plot,) = session.plots(["robot.light.data"])
        assert len(plot.values) == 50
        assert all(0 <= value <= 255 for value in plot.values)
        assert [each.text for each in plot.thresholds] == ["lightlim + 10", "lightlim - 10"]
        assert set(plot.thresholds[0].values) == {138.0}


def test_the_last_seconds_of_what_an_event_reads_come_with_the_thresholds_of_its_condition():
    with Session(programs.load("follower"), "sim", world="line") as session:
        session.run(5)
        (whole,) = session.plots(["robot.light.data"])
        (light,) = session.plots(event="outofline", seconds=2)
        assert (light.name, light.times) == ("robot.light.data", whole.times[-20:])
        assert light.values == whole.values[-20:]
        assert [each.text for each in light.thresholds] == ["lightlim + 10"]
        assert session.plots(["robot.light.data"], "outofline", 2) == [light]
        assert [each.name for each in session.plots(event="bumping")] == [
            "robot.bumper.data",
            "follower/nobump",
        ]
        assert session.plots([], seconds=2) == []
        with pytest.raises(UnknownElementError, match="no event `nothing`"):
            session.plots(event="nothing")


def test_a_machine_that_is_spawned_elsewhere_has_its_own_thresholds():
    program = """\
    (var most := [9])
    (machine counter
      (var n := [0]) (var limit := [5])
      (event full [n > limit + most])
      (state up
        (running [n += 1; limit = 5 + n])
        (onentry (spawn inside i))
        (machine inside (var low := [3]) (state i) (state j) (on [n < low] i -> j)))
      (state done)
      (on full up -> done)
      (on [robot.light.data < limit] up -> done))
    (machine m (state x (onentry (spawn counter up))) (state z) (ontime 1000 x -> z))
    (spawn m x)
    """
    with Session(program, "sim", world="empty") as session:
        for seconds in (0.8, 1):  # while it runs, and afterwards
            session.run(seconds)
            (n,) = session.plots(["m/x/counter/n"])
            by_text = {each.text: each.values[:8] for each in n.thresholds}
            assert by_text == {"limit + most": (*range(15, 23),), "low": (3.0,) * 8}
            if seconds == 0.8:
                (light,) = session.plots(["robot.light.data"])
                assert [(each.text, each.values[-1]) for each in light.thresholds] == [("limit", 13.0)]
                (full,) = session.plots(event="full")
                assert (full.name, full.thresholds) == ("m/x/counter/n", n.thresholds[:1])


def test_a_variable_that_did_not_exist_has_no_samples_then():
    program = """\
    (machine m
      (state a)
      (state b (onentry (spawn inner x)) (machine inner (var k := [7]) (state x)))
      (ontime 500 a -> b)
      (ontime 500 b -> a))
    (spawn m a)
    """
    with Session(program) as session:
        session.run(1.5)
        (plot,) = session.plots(["m/b/inner/k"])
        assert plot.values == (*[None] * 5, *[7.0] * 5, *[None] * 5)


def test_samples_after_a_rewind_are_those_of_the_new_run():
    with Session(PROGRAM) as session:
        session.run(1)
        session.rewind(5)
        session.variables["n"] = 100
        session.run(0.2)
        (plot,) = session.plots(["m/n"])
        assert plot.values == (1, 2, 3, 4, 5, 100, 100)


def test_plots_are_computed_from_what_was_recorded_while_the_run_goes_on():
    names = ["m/n", "m/big", "limit"]
    with Session(PROGRAM) as session:
        session.run(1.5)
        expected = session.plots(names)
        compute = session.call(lambda: plotting(session._loop, dict.fromkeys(names, 0)))
        later = session.call(lambda: plotting(session._loop, {"m/n": 12}))
        session.rewind(8)
        session.edit(PROGRAM.replace("n += 1", "n -= 1").replace("(var big", "(var small"))
        session.run(3)
        assert compute() == expected
        assert later()[0].values == expected[0].values[12:]


def test_plots_are_not_computed_by_the_thread_that_ticks():
    threads = set()

    class Limit(int):
        def __mul__(self, other):
            threads.add(threading.get_ident())
            return int(self) * other

    with Session(
        PROGRAM.replace("[5]", "[Limit(5)]").replace("else 5", "else limit"), namespace={"Limit": Limit}
    ) as session:
        session.start()
        session.wait_for(lambda frame: frame.tick > 2, timeout=120)
        session.pause()
        threads.clear()
        session.plots(["m/n"])
        assert threads == {threading.get_ident()}


def test_a_value_that_is_not_finite_is_left_out():
    with Session("(var x := [float('inf')]) (machine m (state a)) (spawn m a)") as session:
        session.run(0.3)
        assert session.plots(["x"])[0].values == (None, None, None)


@pytest.mark.parametrize("name", ["nothing", "robot.nothing", "m/a/b/c"])
def test_a_name_that_does_not_exist_gives_an_empty_plot_in_the_timeline(name):
    with Session(PROGRAM) as session:
        session.run(0.3)
        assert session.timeline(plots={name: 0}).plots[0].values == (None, None, None)
        with pytest.raises(UnknownElementError, match=f"no variable or reading `{name}`"):
            session.plots([name])


def test_a_variable_is_plotted_by_its_name():
    with Session(PROGRAM) as session:
        session.run(0.3)
        assert session.plots(["n"]) == session.plots(["m/n"])


def test_a_reading_without_robot_is_told_with_what_was_meant():
    with Session(PROGRAM, "sim", world="empty") as session:
        session.run(0.3)
        with pytest.raises(UnknownElementError, match=r"Did you mean `robot\.light\.data`\?"):
            session.plots(["light.data"])
