"""A ROS robot for the tests that says and hears what it is told, `python body_node.py`.

Each line of its standard input is a list in JSON:

* ``["says", TOPIC, TYPE, {FIELD: VALUE}]``: publish that twenty times a second, stamped with the time;
* ``["tells", TOPIC, TYPE, {FIELD: VALUE}]``: publish that once, to whoever subscribes;
* ``["hears", TOPIC, TYPE]``: print each message that is another one, ``TOPIC {"FIELD": VALUE}``.
"""

from __future__ import annotations

import json
import sys
import threading
from typing import Any

import genpy
import roslib.message
import rospy

_PERIOD = 0.05  # s


class Body:
    def __init__(self) -> None:
        self.said: dict[str, Any] = {}
        self.publishers: dict[str, Any] = {}
        self.heard: dict[str, str] = {}
        self.gone = threading.Event()

    def says(self, topic: str, type_: str, fields: dict[str, Any]) -> None:
        self.said[topic] = self._message(topic, type_, fields)

    def tells(self, topic: str, type_: str, fields: dict[str, Any]) -> None:
        message = self._message(topic, type_, fields)
        while not (self.publishers[topic].get_num_connections() or self.gone.wait(0.01)):
            pass
        self.publishers[topic].publish(message)

    def hears(self, topic: str, type_: str) -> None:
        rospy.Subscriber(topic, roslib.message.get_message_class(type_), self._hear, callback_args=topic)

    def _message(self, topic: str, type_: str, fields: dict[str, Any]) -> Any:
        kind = roslib.message.get_message_class(type_)
        if topic not in self.publishers:
            self.publishers[topic] = rospy.Publisher(topic, kind, queue_size=1000, tcp_nodelay=True)
        message = kind()
        genpy.message.fill_message_args(message, [fields])
        return message

    def _hear(self, message: Any, topic: str) -> None:
        text = json.dumps(_as_dict(message))
        if self.heard.get(topic) != text:
            self.heard[topic] = text
            sys.stdout.write(f"{topic} {text}\n")
            sys.stdout.flush()

    def live(self) -> None:
        while not self.gone.wait(_PERIOD):
            for topic, message in tuple(self.said.items()):
                _stamp(message)
                self.publishers[topic].publish(message)


def _as_dict(message: Any) -> Any:
    if hasattr(message, "__slots__"):
        return {name: _as_dict(getattr(message, name)) for name in message.__slots__}
    return message


def _stamp(message: Any) -> None:
    if hasattr(message, "header"):
        message.header.stamp = rospy.Time.now()
    for each in getattr(message, "transforms", ()):
        each.header.stamp = rospy.Time.now()


def main() -> None:
    rospy.init_node("body", disable_signals=True, disable_rosout=True)
    body = Body()
    threading.Thread(target=body.live, daemon=True).start()
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    for line in sys.stdin:
        word, *rest = json.loads(line)
        getattr(body, word)(*rest)
    body.gone.set()


if __name__ == "__main__":
    main()
