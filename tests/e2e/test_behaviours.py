"""What a behaviour is made of, typed letter by letter into a program that runs."""

from e2e.typist import Typist

ARM = """\
(var ready := [True])
(var got := [0])
(var looked := [0])
(machine move
  (var side := [1])
  (var tries := [0])
  (state send)
  (state reached (running [tries += 1]))
  (ontime 300 send -> reached))
(machine arm
  (var ticks := [0])
  (state look
    (onentry [ticks = 0])
    (running [ticks += 1])
    (onexit [looked = ticks]))
  (state carrying (onentry (spawn move send)))
  (on [ready] look -> carrying))
(spawn arm look)
"""
NUMBER = "(element, least) => Number(element.textContent) >= least"


def shows(lab, variable, least):
    """Wait until a variable is at least so much."""
    lab.until(NUMBER, f'[data-lrp-variable="{variable}"] .lrp-value', least)


def test_every_form_of_a_behaviour_is_typed_into_the_machine_that_runs(open_lab):
    lab = open_lab(ARM, "arm")
    typist = Typist(lab)
    text = ARM

    def typed(after, *lines):
        nonlocal text
        typist.after(after)
        typist.types(*lines)
        lab.page.keyboard.press("Escape")
        new = "\n  ".join(lines)
        text = text.replace(after, after + new)
        typist.rests()
        lab.misses("[data-lrp-issue]")
        assert lab.text == text
        typist.has_disturbed_nothing()
        assert typist.faults == []

    lab.is_active("move/reached")
    lab.sees('[data-lrp-machine="move"]').click()  # for its variables
    tried = typist.kernel("session.variables['tries']")
    typed("(spawn move send", " (var side := [-1])")
    lab.has_value("move/side", "-1")
    assert typist.visits["carrying"] == 1
    shows(lab, "move/tries", tried + 1)

    typed("look -> carrying)", "", "(on move.reached carrying -> look)")
    lab.sees('[data-lrp-transition$=":carrying->look"][data-fired]')
    typed("carrying -> look", " (effect [got = move.tries])")
    shows(lab, "got", 1)
    typed("move.reached", " for 400")
    shows(lab, "got", 4)
    typed("(on [ready", " and elapsed >= 0.5")
    shows(lab, "looked", 4)
