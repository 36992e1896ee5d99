"""A robot with an action and a service of ROS 1, for the tests: `python action_node.py full|simple`.

`/move_base` (MoveBase) is served by Debian's actionlib: by its SimpleActionServer, or (`full`) by the
ActionServer below it, with which every fault can be had. It drives as long as it has a goal that was not
cancelled, and prints `drives X` and `stands`. How a goal goes is said on its standard input, a line each:

* ``feedback X``, ``succeed``, ``abort WHY``, each for the goal that it drives to;
* ``reject WHY``: the goals that come from now on (it prints `rejects`);
* ``hold``: cancels are not confirmed from now on (`holds`), although it stands; ``confirm``: those are;
* ``again``: the last result is sent a second time;
* ``reset``: it is as in the beginning, and prints that.

`/lamp` (SetBool) answers at once, or after ``slow`` on ``answer``; it fails if the lamp is on already.
"""

from __future__ import annotations

import os
import sys
import threading

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseFeedback, MoveBaseResult
from std_srvs.srv import SetBool, SetBoolRequest, SetBoolResponse

NAME = "/move_base"


def tell(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def target(goal: object) -> float:
    return float(goal.target_pose.pose.position.x)  # type: ignore[attr-defined]


def feedback(x: float) -> MoveBaseFeedback:
    message = MoveBaseFeedback()
    message.base_position.pose.position.x = x
    return message


class Full:
    """Every goal is a handle; a new one replaces the one before, as in move_base."""

    def __init__(self) -> None:
        self.goal, self.held, self.rejects, self.holds = None, [], "", False
        self.server = actionlib.ActionServer(NAME, MoveBaseAction, self.begin, self.cancel, auto_start=False)
        self.server.start()

    def begin(self, goal: actionlib.ServerGoalHandle) -> None:
        if self.rejects:
            goal.set_rejected(None, self.rejects)
            return
        before, self.goal = self.goal, goal
        goal.set_accepted("on the way")
        tell(f"drives {target(goal.get_goal())}")
        if before is not None:
            before.set_canceled(None, "another goal came")

    def cancel(self, goal: actionlib.ServerGoalHandle) -> None:
        if goal == self.goal:
            self.goal = None
            tell("stands")
        self.held.append(goal)
        if not self.holds:
            self.confirm()

    def confirm(self) -> None:
        held, self.held = self.held, []
        for goal in held:
            goal.set_canceled(None, "as you wish")

    def end(self) -> actionlib.ServerGoalHandle:
        goal, self.goal = self.goal, None
        tell("stands")
        return goal

    def obey(self, word: str, rest: str) -> None:
        if word == "feedback":
            self.goal.publish_feedback(feedback(float(rest)))
        elif word == "succeed":
            self.last = self.end()
            self.last.set_succeeded(MoveBaseResult(), "there")
        elif word == "abort":
            self.last = self.end()
            self.last.set_aborted(MoveBaseResult(), rest)
        elif word == "again":
            self.server.publish_result(self.last.status_tracker.status, MoveBaseResult())
        elif word == "reject":
            self.rejects = rest
            tell("rejects")
        elif word == "hold":
            self.holds = True
            tell("holds")
        elif word == "confirm":
            self.confirm()
        elif word == "reset":
            if self.goal is not None:
                self.cancel(self.goal)
            self.confirm()
            self.rejects, self.holds = "", False
            tell("reset")


class Simple:
    """One goal at a time, by the server that most robots use."""

    def __init__(self) -> None:
        self.server = actionlib.SimpleActionServer(NAME, MoveBaseAction, auto_start=False)
        self.server.register_goal_callback(self.begin)
        self.server.register_preempt_callback(self.cancel)
        self.server.start()

    def begin(self) -> None:
        tell(f"drives {target(self.server.accept_new_goal())}")

    def cancel(self) -> None:
        if not self.server.is_new_goal_available():
            tell("stands")
            self.server.set_preempted(None, "as you wish")

    def obey(self, word: str, rest: str) -> None:
        if word == "feedback":
            self.server.publish_feedback(feedback(float(rest)))
        elif word == "succeed":
            tell("stands")
            self.server.set_succeeded(MoveBaseResult(), "there")
        elif word == "abort":
            tell("stands")
            self.server.set_aborted(MoveBaseResult(), rest)


class Lamp:
    def __init__(self) -> None:
        self.is_on, self.may_answer = False, threading.Event()
        self.may_answer.set()
        rospy.Service("/lamp", SetBool, self.switch)

    def switch(self, request: SetBoolRequest) -> SetBoolResponse:
        tell(f"lamp {request.data}")
        self.may_answer.wait()
        if request.data and self.is_on:
            raise rospy.ServiceException("«An» is what it is: it's on")
        self.is_on = request.data
        return SetBoolResponse(True, "on" if self.is_on else "off")

    def obey(self, word: str) -> None:
        if word == "slow":
            self.may_answer.clear()
            tell("slow")
        elif word == "answer":
            self.may_answer.set()
        elif word == "reset":
            self.is_on = False
            self.may_answer.set()


def main(kind: str) -> None:
    rospy.init_node("navigation", disable_signals=True, disable_rosout=True)
    rospy.on_shutdown(lambda: os._exit(1))  # when another takes its name: rospy would spin
    server, lamp = Full() if kind == "full" else Simple(), Lamp()
    tell("ready")
    for line in sys.stdin:
        word, _, rest = line.strip().partition(" ")
        lamp.obey(word)
        server.obey(word, rest)


if __name__ == "__main__":
    main(sys.argv[1])
