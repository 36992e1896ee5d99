"""Completion, hover, references, inspection: what an editor asks while the program runs."""

import math
import threading

import pytest
from support.robots import Bare

from lrp_jupyter.codes import CODES
from lrp_jupyter.editors.python_options import fields_of
from lrp_jupyter.widgets.acts.editor_questions import complete, hover

PROGRAM = """\
(var table := [{"near": [1, 2], "far": math.pi}])
(machine m
  (var speed := [0.25])
  (event ready [speed > 0])
  (state a (onentry [twice(speed)]) (running [robot.move(linear=speed)]))
  (state b)
  (on ready a -> b go))
(spawn m a)
"""


def twice(x):
    """Return twice as much."""
    return 2 * x


@pytest.fixture
def lab(bench):
    lab = bench(PROGRAM, bridge="sim", namespace={"math": math, "twice": twice, "_hidden": 1})
    lab.session.step()
    return lab


@pytest.fixture
def page(lab):
    return lab.page()


def options(page, prefix, scope=""):
    return {option["label"]: option for option in page.ask("complete", prefix=prefix, scope=scope)["options"]}


def test_names_of_the_notebook_of_python_and_its_words_complete(page):
    found = options(page, "tw")
    assert found["twice"] == {
        "label": "twice",
        "kind": "function",
        "detail": "(x)",
        "info": "Return twice as much.",
    }
    assert options(page, "ma").keys() >= {"math", "map", "max", "match"} - {"match"}
    assert options(page, "whi")["while"]["kind"] == "keyword"
    assert "_hidden" not in options(page, "")
    assert "_hidden" in options(page, "_h")


def test_members_complete_by_the_living_value(page):
    assert "sqrt" in options(page, "math.sq")
    assert options(page, "table.ke").keys() == {"keys"}
    assert options(page, "speed.is_", scope="m").keys() == {"is_integer"}
    assert options(page, "speed.is_") == {}  # not in scope at the top level
    assert options(page, "robot.light.").keys() == {"data", "new", "age"}
    assert options(page, "nothing.at.all") == {}


def test_degrees_complete_and_are_explained_unless_the_notebook_has_that_name(lab, page):
    assert options(page, "degr")["degrees"]["detail"] == "(angle)"
    assert "from degrees to radians" in page.ask("hover", chain="degrees", scope="m")["hover"]["doc"]
    lab.session.namespace["degrees"] = twice
    assert options(page, "degr")["degrees"]["info"] == "Return twice as much."
    assert page.ask("hover", chain="degrees", scope="m")["hover"]["doc"] == "Return twice as much."


def test_hover_shows_kind_value_and_documentation(page):
    def card(chain, scope=""):
        return page.ask("hover", chain=chain, scope=scope)["hover"]

    assert card("speed", "m") == {"title": "speed", "type": "float", "value": "0.25", "doc": ""}
    assert card("twice")["title"] == "twice(x)"
    assert card("twice")["doc"] == "Return twice as much."
    assert card("robot.light.data")["type"] == "int"
    assert card("robot.move")["title"] == "robot.move(linear=0.0, angular=0.0)"
    assert card("while") is None
    assert card("robot.wings") is None
    assert card("unknown") is None


def test_a_card_shows_how_a_function_is_called_and_what_a_robot_has(lab, page):
    def refuse(why: "str", *, loudly: bool = False) -> "NoReturn":  # noqa: F821
        raise ValueError(why)

    lab.session.namespace["refuse"] = refuse
    chains = ("refuse", "robot", "robot.pen", "robot.light")
    cards = [page.ask("hover", chain=chain, scope="")["hover"] for chain in chains]
    titles = [card["title"] for card in cards]
    assert titles == ["refuse(why, *, loudly=False)", "robot", "robot.pen(down=True)", "robot.light"]
    assert cards[1]["value"].startswith("bumper, distance, drive_by, drive_to, front, gyro")
    assert cards[3]["value"] == "data, new, age"


BEHAVIOUR = """\
(event near [True])
(machine follow
  (var side := [1]) (var found := ["part"])
  (state search) (state track) (eps search -> track))
(machine m
  (var own := [2])
  (state left (onentry (spawn follow search (var side := [-1]))))
  (state right (onentry (spawn follow search)))
  (on follow.track for 9000 left -> right)
  (on [near] right -> left))
(machine n (state one (onentry (spawn follow track))))
(spawn m left)
(spawn n one)
"""


@pytest.fixture
def behaviour(bench):
    lab = bench(BEHAVIOUR)
    for _ in range(5):
        lab.session.step()
    return lab


def test_hover_explains_events_machines_and_times_in_blocks_with_their_values(behaviour):
    page = behaviour.page()

    def card(chain, scope="m"):
        found = page.ask("hover", chain=chain, scope=scope)["hover"]
        return found and (found["type"], found["value"], found["doc"].partition(":")[0])

    assert card("near") == ("event", "", "An event")
    assert card("follow") == ("machine", "track, track", "A machine")
    assert page.ask("hover", chain="follow", scope="m")["hover"]["doc"] == (
        "A machine: `follow.state` is its active state. Its variables: `follow.side`, `follow.found`."
    )
    assert card("follow.state")[:2] == ("str", "'track', 'track'")
    assert card("follow.side") == ("int", "m/left/follow: -1\nn/one/follow: 1", "")
    assert card("follow.found.upper")[0] == "builtin_function_or_method"
    assert card("follow.gone") is None
    assert card("elapsed")[:2] == ("float", "0.4 in `left`")
    assert card("elapsed", "n")[1] == "0.4 in `one`"
    assert card("dt")[:2] == ("float", "")
    assert card("m.state", "n")[1] == "'left'"
    assert card("m.own", "n")[:2] == ("int", "2")
    assert card("m.own", "m") is None  # a machine does not see itself
    behaviour.session.namespace.update(near=5, follow=6, dt=7)
    assert [card(chain)[:2] for chain in ("near", "follow", "dt")] == [("int", each) for each in "567"]


def test_a_variable_hides_what_is_computed(bench):
    lab = bench("(var near := [1]) (var dt := [2])" + BEHAVIOUR)
    lab.session.step()
    cards = [lab.page().ask("hover", chain=chain, scope="m")["hover"] for chain in ("near", "dt")]
    assert [card["value"] for card in cards] == ["1", "2"]


def test_times_complete_with_what_they_are_and_values_of_machines_by_their_members(behaviour):
    page = behaviour.page()
    assert "state was entered" in options(page, "ela", "m")["elapsed"]["info"]
    assert "last tick" in options(page, "d", "m")["dt"]["info"]
    assert options(page, "follow.found.upp", "m").keys() == {"upper"}
    behaviour.session.namespace["dt"] = twice
    assert options(page, "dt", "m")["dt"]["kind"] == "function"


def test_a_name_leads_to_its_definition_wherever_it_is_used(behaviour):
    page = behaviour.page()

    def definition(use, name):
        at = BEHAVIOUR.index(use) + use.index(name)
        line, column = BEHAVIOUR.count("\n", 0, at) + 1, at - BEHAVIOUR.rfind("\n", 0, at)
        found = page.ask("references", line=line, column=column)["references"]
        return found["kind"], found["path"], len(found["references"])

    assert definition("(on follow.track", "follow") == ("machine", "follow", 5)
    assert definition("(on follow.track", "track") == ("state", "follow/track", 4)
    assert definition("(var side := [-1])", "side") == ("variable", "follow/side", 2)
    assert definition("[near]", "near") == ("event", "near", 2)


class Marked:
    """A value that records the threads on which its text was made."""

    def __init__(self):
        self.threads = []

    def __repr__(self):
        self.threads.append(threading.current_thread())
        return "marked"


def hovered(lab, chain):
    """Return the card of a name, asked for on a thread of its own, and publish nothing."""
    return hover(lab.connection, chain, "")


def test_hover_calls_the_code_of_a_value_only_on_the_loops_thread(bench):
    marked = Marked()
    holder = Bare(lambda robot: robot.add_variable("thing", lambda: [marked], "a thing"))
    lab = bench("(machine m (state a (running [robot.thing]))) (spawn m a)", bridge=holder)
    lab.session.start(paused=True)
    lab.session.call(lab.session.bridge.refresh)
    assert hovered(lab, "robot.thing")["value"] == "[marked]"
    assert marked.threads
    assert threading.current_thread() not in marked.threads
    marked.threads.clear()
    assert fields_of(lab.session.bridge, "robot.thing") is None
    assert complete(lab.connection, "robot.thi", "")
    assert threading.current_thread() not in marked.threads


def test_hover_over_a_variable_shows_the_text_of_its_last_frame(bench):
    marked = Marked()
    lab = bench("(var thing := [marked])", namespace={"marked": marked})
    lab.session.step()
    made = len(marked.threads)
    assert made
    assert hovered(lab, "thing")["value"] == "marked"
    assert len(marked.threads) == made


def test_references_lead_from_any_use_to_the_definition(page):
    found = page.ask("references", line=5, column=28)["references"]
    assert (found["kind"], found["path"], found["name"]) == ("variable", "m/speed", "speed")
    assert found["definition"] == {"line": 3, "column": 8, "end_line": 3, "end_column": 13}
    assert [place["line"] for place in found["references"]] == [3, 4, 5, 5]
    assert page.ask("references", line=7, column=20)["references"]["path"] == "m:go"
    assert page.ask("references", line=1, column=1)["references"] is None


def test_references_are_those_of_the_text_in_the_editor(page):
    page.type("(machine x (state y)) (spawn x y)\n")
    assert page.ask("references", line=1, column=10)["references"]["path"] == "x"
    page.type("(machine")
    assert "not a valid program" in page.ask("references", line=1, column=3)["error"]


def test_the_edits_that_format_a_text_are_those_of_white_space(page):
    text = "(machine m(state a))\r\n(spawn m   a)"
    edits = page.ask("format", text=text)["edits"]
    assert [(edit["range"]["line"], edit["range"]["column"], edit["text"]) for edit in edits] == [
        (1, 11, "\r\n  "),
        (2, 9, " "),
        (2, 14, "\r\n"),
    ]
    assert "Correct them first." in page.ask("format", text="(machine m")["error"]


def inspect(page, kind, path="", *into):
    return page.ask("inspect", kind=kind, path=path, into=list(into))


def test_a_variable_is_inspected_step_by_step(page):
    view = inspect(page, "variable", "table")["inspect"]
    assert view["type"] == "dict"
    assert view["source"] == '(var table := [{"near": [1, 2], "far": math.pi}])'
    assert [(facet["label"], facet["deep"]) for facet in view["facets"]] == [
        ("'near'", True),
        ("'far'", False),
    ]
    inner = inspect(page, "variable", "table", "['near']")["inspect"]
    assert [facet["text"] for facet in inner["facets"]] == ["1", "2"]
    assert inner["title"] == "table['near']"
    assert "any more" in inspect(page, "variable", "table", "['gone']")["error"]
    assert inspect(page, "variable", "m/none")["error"]


def test_long_values_are_cut_and_counted(lab, page):
    lab.session.set_variable("table", "list(range(1000))")
    view = inspect(page, "variable", "table")["inspect"]
    assert len(view["facets"]) == 100
    assert view["more"] == 900


def test_states_transitions_machines_events_and_the_robot_can_be_inspected(lab, page):
    state = inspect(page, "state", "m/a")["inspect"]
    said = {facet["label"]: facet["text"] for facet in state["facets"]}
    assert said["active"] == "yes"
    assert said["entered"] == "1 time, last in tick 1"
    assert said["running"] == "[robot.move(linear=speed)]"
    lab.session.step()
    transition = {f["label"]: f["text"] for f in inspect(page, "transition", "m:go")["inspect"]["facets"]}
    assert transition["fired"] == "1 time, last in tick 2"
    assert inspect(page, "machine", "m")["inspect"]["facets"][0]["text"] == "a, b"
    assert inspect(page, "event", "m/ready")["inspect"]["source"] == "(event ready [speed > 0])"
    assert any("light" in facet["label"] for facet in inspect(page, "robot")["inspect"]["facets"])
    for kind, path in [("state", "m/x"), ("transition", "m:x"), ("event", "m/x"), ("machine", "x")]:
        assert "no" in inspect(page, kind, path)["error"]


def test_arguments_and_fields_of_a_command_complete_before_it_is_sent(page):
    assert {"linear", "angular"} <= options(page, "robot.move().").keys()
    assert options(page, "robot.move().linear.").keys() == {"x", "y", "z"}
    assert "linear_x=" in options(page, "robot.move(lin")
    assert "angular_z=" not in options(page, "robot.move(lin")


def test_completion_runs_no_foreign_code(bench):
    class Endless:
        def __repr__(self):
            raise AssertionError("This must not run.")

    page = bench("(machine m (state a (running []))) (spawn m a)", namespace={"thing": Endless()}).page()
    offered = page.ask("complete", prefix="th", scope="m")
    assert [(option["label"], option["detail"]) for option in offered["options"]] == [("thing", "<Endless>")]


def test_why_is_answered_with_the_lines_that_matter(lab, page):
    no = page.ask("why", kind="transition", path="m:go")["error"]
    assert no is None
    lab.session.step()
    why = page.ask("why", kind="transition", path="m:go")["why"]
    assert (why["code"], why["tick"], why["present"]) == ("fired", 2, True)
    assert "`go` (line 7) fired at 0.1 s" in why["sentence"]
    assert why["lines"][0] == {"line": 7, "text": "(on ready a -> b go))"}
    state = page.ask("why", kind="state", path="m/b")["why"]
    assert [line["line"] for line in state["lines"]] == [7, 4]
    robot = page.ask("why", kind="robot", path="")["why"]
    assert robot["code"] == "never"
    assert "no transition" in page.ask("why", kind="transition", path="m:stop")["error"]


def test_a_code_is_explained(page):
    explanation = page.ask("explain", code="transition-fired")["explanation"]
    assert (explanation["code"], explanation["title"]) == ("transition-fired", "It fired")
    assert explanation["address"] == CODES["transition-fired"].address
    assert "Did you mean `LRP301`?" in page.ask("explain", code="LPR301")["error"]


def test_why_is_refused_before_the_first_tick_and_without_a_robot(bench):
    lab = bench("(machine m (state a))(spawn m a)", bridge="none")
    page = lab.page()
    assert "No tick has run yet" in page.ask("why", kind="state", path="m/a")["error"]
    lab.session.step()
    assert "has no command that moves it" in page.ask("why", kind="robot", path="")["error"]
