"""What can be known of a session."""


def values(interpreter):
    """The variables as text, functions left out."""
    return {path: repr(value) for path, value in interpreter.variables.items() if not callable(value)}


def seen(session):
    """All that can be known of a session, as text: nothing in it may depend on identity."""
    frame = session.frame
    robot = frame.robot
    shown = (robot.time, robot.robots, robot.solids, robot.marks) if robot else ()
    values = {path: text for path, text in frame.variables.items() if "function" not in text}
    return (
        frame.tick,
        frame.time,
        frame.active,
        repr(values),
        dict(sorted(frame.visits.items())),
        dict(sorted(frame.fired.items())),
        [(str(issue), issue.resolved) for issue in frame.issues],
        frame.restarts,
        shown,
        session.program.text,
    )


def come_to_the_end(fork, session):
    """Run a fork to the time of its session; return why that is not possible."""
    try:
        fork.run(session.frame.time - fork.frame.time)
        while fork._script:
            fork.run(0.1)
    except ValueError as error:
        return str(error)
    return ""
