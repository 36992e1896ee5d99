import json
import re
from importlib.metadata import version

import pytest

from lrp_jupyter import programs
from lrp_jupyter.bridges.ros.setup import setup_from_dict
from lrp_jupyter.codes import CODES
from lrp_jupyter.grading.challenges import challenges_by_series
from lrp_jupyter.sim.worlds import BUNDLED, load


def _first_words(text):
    return [line.split("   ")[0].strip() for line in text.splitlines()[1:]]


def test_the_version_is_printed(lrp):
    assert lrp("--version").stdout == f"lrp {version('lrp-jupyter')}\n"


def test_every_program_is_listed_with_its_world(lrp):
    text = lrp("programs").stdout
    assert _first_words(text) == list(programs.names())
    assert "line" in next(line for line in text.splitlines() if line.startswith("follower "))


def test_the_text_of_a_program_is_printed_to_the_letter(lrp):
    assert lrp("programs", "--show", "exit").stdout == programs.load("exit")
    result = lrp("programs", "--show", "exti")
    assert (result.exit_code, result.stderr.startswith("lrp: There is no bundled program")) == (2, True)


def test_every_world_is_listed(lrp):
    assert _first_words(lrp("worlds").stdout) == list(BUNDLED)


def test_a_world_is_drawn_and_is_to_be_had_as_json(lrp, tmp_path):
    drawn = lrp("worlds", "--show", "line").stdout
    assert "#" in drawn
    assert "→" in drawn
    assert "zones: near, far" in drawn
    assert drawn.splitlines()[-1].startswith(
        "robot: light.data, bumper.data, distance.data, front.distance, "
    )
    text = lrp("worlds", "--json", "line").stdout
    path = tmp_path / "mine.json"
    path.write_text(text)
    assert load(path) == load("line")
    assert lrp("worlds", "--show", path).stdout.splitlines()[1:] == drawn.splitlines()[1:]
    assert json.loads(text)["version"] == 1


@pytest.mark.parametrize("option", ["--show", "--json"])
def test_an_unknown_world_is_a_sentence(lrp, option):
    result = lrp("worlds", option, "lin")
    assert result.exit_code == 2
    assert "Did you mean `line`?" in result.stderr


def test_every_bridge_is_listed_with_what_it_is(lrp):
    text = lrp("bridges").stdout
    assert {"none", "sim"} <= set(_first_words(text))
    assert "A robot in a simulated world." in text


def test_the_options_of_a_bridge_are_listed_with_their_types(lrp):
    text = lrp("bridges", "ev3").stdout
    assert text.startswith("ev3: A Lego EV3 brick as `robot`.\n\noption")
    rows = {row.split()[0]: " ".join(row.split()[1:]) for row in text.splitlines() if row}
    assert rows["patience"] == (
        "a number 12.0 Seconds to wait for a brick's beacon where an address is given."
    )
    assert "--option NAME=VALUE" in text
    assert "takes no options" in lrp("bridges", "none").stdout


def test_the_options_of_ros_say_what_a_setup_is(lrp):
    text = lrp("bridges", "ros").stdout
    for key in ("subscriptions", "publishers", "actions", "services", "stop", "tick", "stale_after"):
        assert f'"{key}"' in text
    setup = json.loads("{" + text.partition("{")[2].rpartition("}")[0] + "}")
    assert {wire.variable for wire in setup_from_dict(setup)} >= {"odom", "move", "drive_to", "spawn"}


def test_the_options_of_a_bridge_that_does_not_exist_are_a_sentence(lrp):
    result = lrp("bridges", "evr")
    assert result.exit_code == 2
    assert "There is no bridge `evr`" in result.stderr


def test_challenges_are_listed_when_none_is_named(lrp):
    result = lrp("grade")
    tables = result.stdout.split("\n\n")
    listed = [[name for name in _first_words(table) if name] for table in tables]  # no second lines of tasks
    by_series = challenges_by_series()
    assert (result.exit_code, listed) == (0, [[each.name for each in some] for some in by_series.values()])
    assert [table.split("   ")[0] for table in tables[1:]] == list(by_series)[1:]
    result = lrp("grade", "stopwatch")
    assert result.exit_code == 2
    assert "--challenge" in result.stderr


@pytest.mark.slow
def test_the_challenge_is_the_one_that_the_program_names(lrp):
    result = lrp("grade", "edge-guard", "--seeds", "1")
    assert result.exit_code == 0
    assert result.stdout.startswith("edge-guard, edge guard: passed")


@pytest.mark.slow
def test_a_good_program_passes_with_every_seed(lrp):
    result = lrp("grade", "follower", "--challenge", "there-and-back", "--seeds", "2")
    assert result.exit_code == 0
    assert result.stdout.startswith("follower, there and back: passed")


def test_a_bad_program_fails_with_reasons(lrp, program):
    path = program("(machine m (state idle)) (spawn m idle)")
    result = lrp("grade", path, "--challenge", "first move")
    assert result.exit_code == 1
    assert "✗ gets 30 cm away from its start" in result.stdout
    assert "Hint: " in result.stdout


def test_an_unknown_challenge_is_a_sentence(lrp):
    result = lrp("grade", "follower", "--challenge", "frst move")
    assert result.exit_code == 2
    assert "Did you mean `first move`?" in result.stderr
    assert re.search(r"edit it live, exercise [\d.]+ to exercise [\d.]+[,;]", result.stderr)


def test_every_code_is_listed(lrp):
    assert _first_words(lrp("explain").stdout) == list(CODES)


def test_a_code_is_explained_with_its_program_its_remedy_and_its_address(lrp, monkeypatch):
    monkeypatch.setattr("lrp_jupyter.codes.DOCUMENTATION", "https://example.org/lrp")
    text = lrp("explain", "lrp301").stdout
    assert text.startswith("LRP301: Unknown event (error)\n\nThe transition never fires.")
    assert "    (on bumb a -> b))\n" in text.partition("\nWhat to do\n")[0]
    assert "    (on bump a -> b))\n" in text.partition("\nWhat to do\n")[2]
    assert text.endswith("\n\nhttps://example.org/lrp/errors.html#LRP301\n")


def test_an_unknown_code_is_a_sentence(lrp):
    result = lrp("explain", "LPR301")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == (
        "lrp: There is no code `LPR301`. Did you mean `LRP301`? `lrp explain` lists the codes.\n"
    )
