"""The lessons of a static site as pages, with labs that run in them."""

import pytest

from e2e.pages import LabPage
from e2e.sites import PlainPage
from lrp_jupyter.grading.handing_in import programs_in


class Lesson:
    """A lesson that a visitor reads."""

    def __init__(self, page, site, name):
        self.page = page
        page.goto(f"{site.url}/lessons/{name}.html")

    def place(self, index):
        return self.page.locator(".lab").nth(index)

    def run(self, index):
        """Run the lab at a place."""
        self.place(index).locator('[data-do="run"]').click()
        self.place(index).locator('.live [data-lrp="lab"]').wait_for()
        return LabPage(self.page).ready()

    def hand_in(self, index):
        """Return the address of the link."""
        self.place(index).locator('[data-do="hand-in"]').click()
        link = self.place(index).locator('[role="status"] a')
        link.wait_for()
        return link.get_attribute("href")


def test_a_lesson_is_read_run_and_handed_in_by_a_link(visitor, visitors, site, simulator):
    visitor.context.set_offline(False)
    lesson = Lesson(visitor, site, "00-hello-live-robot")
    assert "does its path look like" in lesson.page.locator("main").inner_text()
    first = lesson.run(0)
    first.goes_on()
    PlainPage.drives(first)
    second = lesson.run(1)
    assert lesson.page.locator('[data-lrp="lab"]').count() == 1, "one lab at a time"
    second.replace("speed := [0.3]", "speed := [0.15]")
    second.goes_on()
    link = lesson.hand_in(1)
    [handed_in] = programs_in(link)
    assert handed_in.challenge == "half the speed"
    assert "(var speed := [0.15])" in handed_in.text

    other = visitors()
    PlainPage(other, site).show(link.removeprefix(f"{site.url}/")).reads(":scope", "speed := [0.15]")
    other.close()

    again = Lesson(visitor, site, "00-hello-live-robot")
    assert "[0.15]" in again.run(1).text, "what was typed is kept"
    again.page.locator('a[rel="next"]').first.click()
    assert "Exercises 0" in again.page.locator("h1").inner_text()
    visitor.context.set_offline(True)
    again.page.go_back()
    again.page.locator("h1", has_text="Hello").wait_for()
    visitor.context.set_offline(False)


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("08-why-did-it-not-fire", 1),
        ("12-safe-live-editing", 0),
        ("15-how-much", 1),
        ("exercises-01-states-and-events", 0),
    ],
)
def test_a_lab_has_the_goals_and_the_robot_that_its_lesson_defines(name, place, visitor, site, simulator):
    visitor.context.set_offline(False)
    Lesson(visitor, site, name).run(place).goes_on()


def test_python_that_does_not_answer_is_started_again_in_a_lesson(visitor, site, simulator):
    lesson = Lesson(visitor, site, "01-states-and-events")
    lab = lesson.run(0)
    lab.select("robot.move(linear=0.3)")
    lab.page.keyboard.insert_text("sum(range(10**15))")
    lab.page.locator("#restart").click()
    lab.page.locator('[data-do="run"]').first.wait_for()
    lesson.place(0).locator('[data-do="run"]').click()
    lab = LabPage(visitor).ready("paused")
    lab.reads(":scope", "did not answer and was started again")
