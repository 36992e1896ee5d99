"""Why a transition did not fire, why a state is active, and why the robot does what it does.

Everything here reads what is recorded and changes nothing: the journal says what happened in a tick, the
bridge what was read and commanded, and a condition is evaluated again over those values, part by part. Where
a value is not recorded (it was changed in place, or a function was called), the answer says so, unless the
tick can be run again in a fork.
"""
