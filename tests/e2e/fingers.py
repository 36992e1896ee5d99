"""Fingers on a touch screen: the browser makes of them what it makes of real ones, and may scroll instead."""

ANSWERS = '.lrp-menu, .lrp-tip[role="tooltip"]'  # to a long press
STEPS = 8


class Fingers:
    """One finger where a mouse would be, which takes a long press for the right button; and two of them."""

    def __init__(self, page):
        self.page = page
        self.wire = page.context.new_cdp_session(page)
        self.at = None
        self.is_down = False

    def touch(self, kind, *points):
        touches = [{"x": x, "y": y, "id": index} for index, (x, y) in enumerate(points)]
        self.wire.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})

    def move(self, x, y, steps=1):
        if self.is_down:
            for at in between(self.at, (x, y), steps):
                self.touch("touchMove", at)
        self.at = x, y

    def down(self):
        self.is_down = True
        self.touch("touchStart", self.at)

    def up(self):
        self.is_down = False
        self.touch("touchEnd")

    def click(self, x, y, button="left"):
        self.move(x, y)
        self.down()
        if button == "right":
            self.page.locator(ANSWERS).first.wait_for()
        self.up()

    def dblclick(self, x, y):
        self.click(x, y)
        self.click(x, y)

    def drag(self, start, end):
        self.move(*start)
        self.down()
        self.move(*end, steps=STEPS)
        self.up()

    def two(self, starts, ends):
        """Put two fingers down, one after the other, and move them."""
        self.touch("touchStart", starts[0])
        self.touch("touchStart", *starts)
        ways = [between(start, end, STEPS) for start, end in zip(starts, ends, strict=True)]
        for points in zip(*ways, strict=True):
            self.touch("touchMove", *points)
        self.touch("touchEnd")


def between(start, end, steps):
    """Return so many points on the way, with the end."""
    (x, y), (u, v) = start, end
    return [(x + (u - x) * n / steps, y + (v - y) * n / steps) for n in range(1, steps + 1)]
