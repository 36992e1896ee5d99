"""Fingers on a touch screen: the browser makes of them what it makes of real ones, and may scroll instead."""

from time import time

ANSWERS = '.lrp-menu, .lrp-tip[role="tooltip"]'  # to a long press
STEPS = 8


class Fingers:
    """One finger where a mouse would be, which takes a long press for the right button; and two of them."""

    def __init__(self, page):
        self.page = page
        self.wire = page.context.new_cdp_session(page)

    def touch(self, kind, *points, **more):
        touches = [{"x": x, "y": y, "id": index} for index, (x, y) in enumerate(points)]
        self.wire.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches, **more})

    def click(self, x, y, button="left"):
        if button == "left":
            self.tap(x, y, 1)
            return
        self.touch("touchStart", (x, y))
        self.page.locator(ANSWERS).first.wait_for()
        self.touch("touchEnd")

    def dblclick(self, x, y):
        self.tap(x, y, 2)

    def tap(self, x, y, count):
        """Tap as fast as a person does, however slow the page is to hear of each touch."""
        was_long = True
        while was_long:
            begun, was_long = time(), False
            for n in range(count):
                self.touch("touchStart", (x, y), timestamp=begun + n * 0.1)
                self.touch("touchEnd", timestamp=begun + n * 0.1 + 0.03)
                was_long = was_long or self.was_long()

    def drag(self, start, end):
        was_long = True
        while was_long:
            self.touch("touchStart", start)
            was_long = self.move_all([(at,) for at in between(start, end, STEPS)])

    def two(self, starts, ends):
        """Put two fingers down, one after the other, and move them."""
        was_long = True
        while was_long:
            self.touch("touchStart", starts[0])
            self.touch("touchStart", *starts)
            ways = [between(start, end, STEPS) for start, end in zip(starts, ends, strict=True)]
            was_long = self.move_all(zip(*ways, strict=True))

    def move_all(self, moves):
        """Move the fingers and lift them; return whether the page has taken that for a long press."""
        for points in moves:
            self.touch("touchMove", *points)
        was_long = self.was_long()
        self.touch("touchEnd")
        return was_long

    def was_long(self):
        """Whether a slow page has taken a touch for a long press; close what that has opened."""
        is_answered = self.page.locator(ANSWERS).count() > 0
        if is_answered:
            self.page.keyboard.press("Escape")
        return is_answered


def between(start, end, steps):
    """Return so many points on the way, with the end."""
    (x, y), (u, v) = start, end
    return [(x + (u - x) * n / steps, y + (v - y) * n / steps) for n in range(1, steps + 1)]
