import json

import pytest

GOOD = "(machine m (state a)) (spawn m a)\n"
BAD = """(machine m (state a) (state b)
  (on bumb a -> b))
(event bump [robot.bumper.data == 1])
(spawn m a)
"""
SHADY = "(machine m (state a) (state b)) (spawn m a)\n"
BROKEN = "(machine m (state a)\n(spawn m a)\n"


def test_a_good_file_has_no_findings(lrp, program):
    result = lrp("check", program(GOOD))
    assert (result.exit_code, result.stdout) == (0, f"{program(GOOD)}: no findings\n")


def test_an_error_is_shown_at_its_place_and_fails(lrp, program):
    result = lrp("check", program(BAD))
    assert result.exit_code == 1
    first, source, carets, fix, *_ = result.stdout.splitlines()
    assert first.startswith(f"{program(BAD)}:2:7: error LRP301: ")
    assert source == "    2 |   (on bumb a -> b))"
    assert carets == "      |       ^^^^"
    assert fix == "      = fix: Change to `bump`"
    assert "1 error" in result.stdout.splitlines()[-1]


def test_warnings_alone_do_not_fail(lrp, program):
    result = lrp("check", program(SHADY))
    assert result.exit_code == 0
    assert "LRP401" in result.stdout


def test_a_text_that_is_not_a_program_fails(lrp, program):
    assert lrp("check", program(BROKEN)).exit_code == 1


def test_an_unreadable_file_is_a_sentence_and_the_others_are_checked(lrp, program, tmp_path):
    result = lrp("check", tmp_path / "none.lrp", program(BAD), tmp_path)
    assert result.exit_code == 2
    assert "LRP301" in result.stdout
    assert len(result.stderr.splitlines()) == 2
    assert all(line.startswith("lrp: ") for line in result.stderr.splitlines())


def test_bytes_that_are_not_text_are_reported_in_a_sentence(lrp, tmp_path):
    path = tmp_path / "my.lrp"
    path.write_bytes(b"; caf\xe9")
    result = lrp("check", path)
    assert (result.exit_code, result.stderr) == (
        2,
        f"lrp: `{path}` is not valid UTF-8: byte 5 cannot be decoded.\n",
    )


def test_a_byte_order_mark_and_any_line_ends_are_read(lrp, program):
    assert lrp("check", program("\ufeff" + GOOD.replace(" (spawn", "\r\n(spawn"))).exit_code == 0


def test_standard_input_is_checked_as_well(lrp):
    result = lrp("check", "-", input=BAD)
    assert result.exit_code == 1
    assert result.stdout.startswith("<stdin>:2:7: error LRP301")


def test_json_has_every_finding_with_its_fix(lrp, program):
    result = lrp("check", program(BAD), "follower", "--format", "json")
    assert result.exit_code == 1
    found = json.loads(result.stdout)
    first = found[0]
    assert {each["file"] for each in found} == {str(program(BAD))}
    assert (first["code"], first["severity"], first["line"], first["column"]) == ("LRP301", "error", 2, 7)
    (edit,) = first["fix"]["edits"]
    assert BAD[: edit["start"]] + edit["text"] + BAD[edit["end"] :] == BAD.replace("on bumb", "on bump")


def test_json_without_findings_is_an_empty_list(lrp, program):
    result = lrp("check", program(GOOD), "--format", "json")
    assert (result.exit_code, json.loads(result.stdout)) == (0, [])


def test_a_wrong_name_is_answered_with_the_nearest(lrp, here):
    (here / "mine.lrp").write_text(GOOD)
    assert "Did you mean `follower`?" in lrp("check", "folower").stderr
    assert "Did you mean `mine.lrp`?" in lrp("check", "minw.lrp").stderr
    assert "Bundled programs: box-pusher" in lrp("check", "xyz").stderr


@pytest.mark.parametrize(
    "arguments", [["chek"], ["check"], ["check", "follower", "--format", "xml"], ["--nope"]]
)
def test_wrong_usage_is_a_sentence_and_exit_code_2(lrp, arguments):
    result = lrp(*arguments)
    assert result.exit_code == 2
    assert "Traceback" not in result.stderr
    assert "Error" in result.stderr
