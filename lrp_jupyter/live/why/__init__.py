"""Why a transition did not fire, why a state is active, and why the robot does what it does.

The code here only reads recorded data: the journal says what happened in a tick, the bridge what was read and
commanded, and a condition is evaluated again with those values, part by part. If a value is not recorded (it
was changed in place, or a function was called), the answer says so, unless the tick can be run again in a
fork.
"""
