"""Programs that the tests open."""

from pathlib import Path

import lrp_jupyter

FOLLOWER = (Path(lrp_jupyter.__file__).parent / "programs" / "follower.lrp").read_text()
COUNTER = """\
(var limit := [1000])
(machine m
  (var n := [0])
  (event full [n > limit])
  (state count (running [n = n + 1]))
  (state rest)
  (on full count -> rest tfull))
(spawn m count)
"""
VISITS = """\
(var visits := [0])
(var steps := [0])
(machine m
  (state here (running [steps = steps + 1]))
  (state there (onentry [visits = visits + 1]))
  (on [steps < 0] here -> there tgo))
(spawn m here)
"""
INNER = """\
(machine m
  (state a (onentry (spawn inner x)) (machine inner (state x) (state y) (on [False] x -> y)))
  (state b)
  (ontime 90000 a -> b))
(spawn m a)
"""
EYE = """\
(machine m
  (event dark [robot.light.data < 100])
  (state off)
  (state on)
  (on dark off -> on seen))
(spawn m off)
"""
LONG = """\
import pathlib
import time
print("begun")
end = time.monotonic() + 60
while not pathlib.Path("go").exists() and time.monotonic() < end:
    time.sleep(0.02)
pathlib.Path("over").touch()
"""
SQUARE = """\
(var corners := [0])
(machine m
  (state side (running [robot.move(linear=0.2)]))
  (state corner (running [robot.move(angular=1)]) (onexit [corners = corners + 1]))
  (state home (onentry [robot.stop()]))
  (on [corners == 4] side -> home)
  (ontime 3000 side -> corner) (ontime 1571 corner -> side))
(spawn m side)
"""
TWICE = """\
(var n := [0])
(machine follow
  (var side := [1])
  (state search)
  (state found)
  (on [n > side] search -> found hit)
  (on [n < -side] found -> search lost))
(machine m (state left (onentry (spawn follow search (var side := [90000])))))
(machine k (state one (onentry (spawn follow search))))
(machine clock (state t (running [n += 1])))
(spawn m left) (spawn k one) (spawn clock t)
"""
