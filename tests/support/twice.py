"""A program whose machine `follow` runs in two places at a time."""

TWICE = """(var n := [0]) (event near [n > 3])
(machine follow (var side := [1]) (var twice := [2 * side])
  (state search) (state found)
  (on [n > 5 + side] search -> found hit)
  (on near for 400 found -> search lost))
(machine m
  (state left (onentry (spawn follow search (var side := [2])))) (state right)
  (on follow.found left -> right done))
(machine k (state one (onentry (spawn follow search))))
(machine clock (state t (running [n += 1])))
(spawn m left) (spawn k one) (spawn clock t)
"""
