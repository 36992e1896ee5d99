import pytest

ROUGH = "(machine m(state a(running[x = 1]))) ; so\n(spawn m  a)"
NEAT = "(machine m\n  (state a (running [x = 1]))) ; so\n(spawn m a)\n"


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_file_is_formatted_in_its_place(lrp, program, end):
    path = program(ROUGH.replace("\n", end))
    result = lrp("format", path)
    assert (result.exit_code, result.stdout) == (0, f"{path}: formatted\n")
    assert path.read_bytes().decode() == NEAT.replace("\n", end)
    assert (lrp("format", path).exit_code, lrp("format", path).stdout) == (0, "")


def test_with_check_nothing_is_written(lrp, program):
    path = program(ROUGH)
    result = lrp("format", "--check", path, program(NEAT, "neat.lrp"))
    assert (result.exit_code, result.stdout) == (1, f"{path}: would be formatted\n")
    assert path.read_text() == ROUGH


def test_standard_input_is_formatted_to_standard_output(lrp):
    assert lrp("format", "-", input=ROUGH).stdout == NEAT


def test_a_text_with_errors_is_left_and_the_errors_are_shown_and_the_others_are_formatted(lrp, program):
    broken, path = program("(machine m", "broken.lrp"), program(ROUGH)
    result = lrp("format", broken, "missing.lrp", path)
    assert result.exit_code == 2
    assert "error LRP101" in result.stderr
    assert "`missing.lrp` is neither a file nor a bundled program." in result.stderr
    assert (broken.read_text(), path.read_text()) == ("(machine m", NEAT)
