"""A variable that holds a robot: shown as a program writes it, now and in the past."""

from lrp_jupyter import Session

TEXT = "(var me := [robot.follower])(var both := [[robot, me]])(machine m (state a))(spawn m a)"


def test_a_robot_is_shown_as_a_program_writes_it():
    with Session(TEXT, "sim", world="convoy") as session:
        session.run(0.3)
        for frame in (session.frame, session.at(1)):
            assert dict(frame.variables) == {("me",): "robot.follower", ("both",): "[robot, robot.follower]"}
