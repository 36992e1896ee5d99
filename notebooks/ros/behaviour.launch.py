"""`ros2 launch behaviour.launch.py`: a program as a node of ROS 2."""

from pathlib import Path

from launch import LaunchDescription
from launch_ros.actions import Node

HERE = Path(__file__).parent


def generate_launch_description() -> LaunchDescription:
    """Return the description: one node."""
    return LaunchDescription(
        [
            Node(
                name="behaviour",
                namespace="robot1",
                executable=str(Path.home() / "lrp" / "bin" / "lrp"),
                arguments=[
                    *("run", str(HERE / "wander.lrp"), "--bridge", "ros"),
                    *(
                        "-o",
                        f"setup={HERE / 'robot.json'}",
                        "-o",
                        "patience=inf",
                        "-o",
                        "state_topic=lrp/state",
                    ),
                ],
                remappings=[("cmd_vel", "/base/cmd_vel")],
                respawn=True,
                output="screen",
            )
        ]
    )
