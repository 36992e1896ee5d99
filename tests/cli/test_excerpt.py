from lrp_jupyter.cli.excerpt import excerpt, finding_text, summary
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.program import Finding


def test_carets_are_below_what_is_meant():
    assert excerpt("a\n  (on bumb)\n", 2, 7, 2, 11) == ["    2 |   (on bumb)", "      |       ^^^^"]


def test_tabs_and_wide_letters_do_not_shift_the_carets():
    assert excerpt("\tx = 1", 1, 2, 1, 3) == ["    1 |     x = 1", "      |     ^"]
    assert excerpt("日本 x", 1, 4, 1, 5) == ["    1 | 日本 x", "      |      ^"]


def test_a_range_of_several_lines_is_marked_to_the_end_of_the_first():
    assert excerpt("(state a\n(state b\n", 1, 1, 3, 1)[1] == "      | ^^^^^^^^"


def test_without_an_end_the_word_is_marked():
    assert excerpt("[robot.move()]", 1, 2)[1] == "      |  ^^^^^"


def test_every_kind_of_line_end_ends_a_line():
    for end in ("\n", "\r\n", "\r"):
        assert excerpt(f"a{end}bc{end}d", 2, 2, 2, 3) == ["    2 | bc", "      |  ^"]


def test_a_place_outside_the_text_has_no_excerpt_and_the_end_of_it_has_one():
    assert excerpt("a", 2, 1) == []
    assert excerpt("a", 1, 2) == ["    1 | a", "      |  ^"]


def test_a_finding_has_place_code_sentence_and_remedy():
    text = "(machine m (state a) (state b) (on bumb a -> b)) (event bump [True]) (spawn m a)"
    finding = check(text)[0]
    lines = str(finding_text("my.lrp", text, finding)).splitlines()
    assert lines[0].startswith("my.lrp:1:36: error LRP301: ")
    assert lines[2].strip(" |") == "^^^^"
    assert lines[3] == "      = fix: Change to `bump`"


def test_findings_are_counted_in_words():
    def finding(severity):
        return Finding("LRP999", severity, "", 1, 1, 1, 1)

    assert summary([]) == "no findings"
    assert summary([finding("hint"), finding("error"), finding("error")]) == "2 errors, 1 hint"


def test_of_a_long_line_the_part_around_the_place_is_shown():
    text = "(" + "x = 1; " * 3000 + "here" + "; y = 2" * 3000 + ")"
    column = text.index("here") + 1
    line, carets = excerpt(text, 1, column, 1, column + 4)
    assert len(line) < 140
    assert line[carets.index("^") : carets.rindex("^") + 1] == "here"
    assert line[8] == line[-1] == "…"
    line, carets = excerpt(text, 1, 1, 2, 1)
    assert (line[8:10], line[-1], carets[8:10]) == ("(x", "…", "^^")
    line, carets = excerpt(text, 1, len(text), 1, len(text) + 1)
    assert (line[8], line[-1], carets[len(line) - 1 :]) == ("…", ")", "^")
