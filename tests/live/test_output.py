import io

from lrp_jupyter.live.running.output import Output


def test_printing_does_what_print_does():
    output = Output()
    output.print("a", 1, None, sep="-")
    output.print("no end", end="")
    output.print("!", flush=True)
    output.print()
    assert str(output) == "a-1-None\nno end!\n\n"


def test_what_is_printed_into_a_file_goes_there():
    output, file = Output(), io.StringIO()
    output.print("elsewhere", file=file)
    assert (str(output), file.getvalue()) == ("", "elsewhere\n")


def test_old_lines_are_forgotten_but_counted():
    output = Output(lines=3)
    for number in range(10):
        output.print(number)
    assert output.since(0) == (10, ("7", "8", "9"))


def test_a_reader_gets_each_line_once():
    output = Output()
    output.print("a")
    count, lines = output.since(0)
    assert lines == ("a",)
    output.print("b\nc")
    assert output.since(count) == (3, ("b", "c"))
    assert output.since(3) == (3, ())


def test_cleared_lines_are_gone_and_the_count_continues():
    output = Output()
    output.print("a")
    output.clear()
    output.print("b")
    assert output.since(0) == (2, ("b",))


def test_a_line_without_end_does_not_grow_for_ever():
    output = Output()
    for _ in range(30):
        output.print("x" * 1000, end="")
    assert len(str(output)) <= 10_000
