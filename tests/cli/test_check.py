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
    assert result.stdout.splitlines()[-1] == "1 error. More about a code: lrp explain LRP301"


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


WRONG = """\
(var speed = [0.2]) // slow
(machine m (State a (running (robot.move(linear=speed)))) (state b) (ontime 500ms a => b))
(spawn m a)
"""
FIXED = """\
(var speed := [0.2]) ; slow
(machine m (state a (running [robot.move(linear=speed)])) (state b) (ontime 500 a -> b))
(spawn m a)
"""


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_every_certain_fix_is_applied_and_printed_and_nothing_else_changes(lrp, program, end):
    path = program(WRONG.replace("\n", end))
    path.chmod(0o640)
    result = lrp("check", "--fix", path)
    assert result.exit_code == 0
    assert path.read_bytes().decode() == FIXED.replace("\n", end)
    assert path.stat().st_mode & 0o777 == 0o640
    printed = result.stdout.splitlines()
    assert printed[0].startswith(f"{path}:1:12: fixed LRP104: ")
    assert printed[0].endswith("(Change to `:=`)")
    assert [line.split(" ", 2)[1] for line in printed] == ["fixed"] * 6 + ["no"]


def test_what_is_not_certain_is_left_to_the_user(lrp, program):
    text = WRONG.replace("500ms ", "")
    path = program(text)
    result = lrp("check", "--fix", path)
    assert result.exit_code == 1
    assert "(ontime a -> b)" in path.read_text()
    assert "error LRP108" in result.stdout


def test_a_file_without_mistakes_is_not_written(lrp, program):
    path = program(GOOD)
    before = path.stat().st_mtime_ns, path.stat().st_ino
    assert lrp("check", "--fix", path).exit_code == 0
    assert (path.stat().st_mtime_ns, path.stat().st_ino) == before


def test_a_link_is_followed_to_the_file_that_is_corrected(lrp, program, tmp_path):
    path, link = program(WRONG), tmp_path / "link.lrp"
    link.symlink_to(path)
    assert lrp("check", "--fix", link).exit_code == 0
    assert link.is_symlink()
    assert path.read_text() == FIXED


@pytest.mark.parametrize(
    ("name", "remedy"),
    [("-", "Name a file."), ("follower", "`lrp programs --show follower > mine.lrp` makes a file of it.")],
)
def test_only_files_can_be_corrected(lrp, name, remedy):
    result = lrp("check", "--fix", name, input=WRONG)
    assert result.exit_code == 2
    assert remedy in result.stderr


def test_a_file_that_cannot_be_written_is_reported_in_a_sentence(lrp, program):
    path = program(WRONG)
    path.chmod(0o440)
    result = lrp("check", "--fix", path)
    assert result.exit_code == 2
    assert "write-protected. Make it writable" in result.stderr
    assert path.read_text() == WRONG


def test_fixes_and_findings_for_programs_are_separate(lrp, program):
    result = lrp("check", "--fix", "--format", "json", program(WRONG))
    assert json.loads(result.stdout) == []
    assert result.stderr.count(" fixed ") == 6


def test_a_program_is_checked_for_the_robot_with_which_it_would_be_run(lrp, program):
    turn = "(machine m (state a (running [{}]))) (spawn m a)\n"
    result = lrp("check", program(turn.format("robot.moove(linear=0.2)")))
    assert result.exit_code == 1
    assert "`robot` has no `moove`. Did you mean `move`?" in result.stdout
    assert "Checked for the simulated robot of the world `line`. For another one, write" in result.stdout
    result = lrp("check", program("; world: line\n" + turn.format("robot.moove(linear=0.2)")))
    assert "LRP520" in result.stdout
    assert "Checked for" not in result.stdout
    sides = turn.format("print(robot.left.distance)")
    assert "LRP520" in lrp("check", program(sides)).stdout
    for heading in ("; world: walls", "; challenge: wall follower", "; world: none"):
        result = lrp("check", program(f"{heading}\n{sides}"))
        assert (result.exit_code, result.stdout) == (
            0,
            f"{program(f'{heading}{chr(10)}{sides}')}: no findings\n",
        )
