"""An example of every static finding: a program that has it, ``---``, and the same program repaired."""

from __future__ import annotations

__all__ = ["EXAMPLES"]

EXAMPLES: dict[str, str] = {
    "LRP101": """
(machine m
  (state a
  (state b)
  (eps a -> b))
(spawn m a)
---
(machine m
  (state a)
  (state b)
  (eps a -> b))
(spawn m a)
""",
    "LRP102": """
(machine m (state a)))
(spawn m a)
---
(machine m (state a))
(spawn m a)
""",
    "LRP103": """
(machine m (state a (running [robot.beep())))
(spawn m a)
---
(machine m (state a (running [robot.beep()])))
(spawn m a)
""",
    "LRP104": """
(machine m (state a) & (state b) (eps a -> b))
(spawn m a)
---
(machine m (state a) (state b) (eps a -> b))
(spawn m a)
""",
    "LRP105": """
a robot that waits
(machine m (state a))
(spawn m a)
---
; a robot that waits
(machine m (state a))
(spawn m a)
""",
    "LRP106": """
(machine m (stat a))
(spawn m a)
---
(machine m (state a))
(spawn m a)
""",
    "LRP107": """
(machine m (state a) (running [1]))
(spawn m a)
---
(machine m (state a (running [1])))
(spawn m a)
""",
    "LRP108": """
(machine m (state a) (state b) (eps a b))
(spawn m a)
---
(machine m (state a) (state b) (eps a -> b))
(spawn m a)
""",
    "LRP109": """
(var speed := [])
(machine m (state a))
(spawn m a)
---
(var speed := [0.2])
(machine m (state a))
(spawn m a)
""",
    "LRP110": """
(var lambda := [1])
(machine m (state a))
(spawn m a)
---
(var wavelength := [1])
(machine m (state a))
(spawn m a)
""",
    "LRP111": "(state s " * 101
    + ")" * 101
    + """
---
(machine m (state a))
(spawn m a)
""",
    "LRP112": """
(machine m (state a) (state b) (eps *-> b))
(spawn m a)
---
(machine m (state a) (state b) (eps {a} -> b))
(spawn m a)
""",
    "LRP113": """
(import follower)
(machine m (state a))
(spawn m a)
---
(machine m (state a))
(spawn m a)
""",
    "LRP114": """
// waits
(machine m (state a))
(spawn m a)
---
; waits
(machine m (state a))
(spawn m a)
""",
    "LRP115": """
(machine m (state a (running (robot.beep()))))
(spawn m a)
---
(machine m (state a (running [robot.beep()])))
(spawn m a)
""",
    "LRP116": """
(machine m (state a (running [robot.beep()  # loud])))
(spawn m a)
---
(machine m (state a (running [robot.beep()])))  # loud
(spawn m a)
""",
    "LRP117": """
(machine m (state a [robot.beep()]))
(spawn m a)
---
(machine m (state a (running [robot.beep()])))
(spawn m a)
""",
    "LRP201": """
(var speed := [1])
(var speed := [2])
(machine m (state a))
(spawn m a)
---
(var speed := [1])
(var fast := [2])
(machine m (state a))
(spawn m a)
""",
    "LRP202": """
(var speed := [1])
(machine m (var speed := [2]) (state a))
(spawn m a)
---
(var speed := [1])
(machine m (var fast := [2]) (state a))
(spawn m a)
""",
    "LRP203": """
(var robot := ["R2"])
(machine m (state a))
(spawn m a)
---
(var model := ["R2"])
(machine m (state a))
(spawn m a)
""",
    "LRP204": """
(var max := [100])
(machine m (state a))
(spawn m a)
---
(var limit := [100])
(machine m (state a))
(spawn m a)
""",
    "LRP205": """
(machine m (state a) (state b)
  (on [x.hot] a -> b)
  (on [x.wet] a -> b))
(var x := [robot])
(spawn m a)
---
(machine m (state a) (state b)
  (on [x.hot] a -> b hot)
  (on [x.wet] a -> b wet))
(var x := [robot])
(spawn m a)
""",
    "LRP206": """
(machine m (state a))
---
(machine m (state a))
(spawn m a)
""",
    "LRP301": """
(event bump [robot.bumper.data])
(machine m (state a) (state b)
  (on bumb a -> b))
(spawn m a)
---
(event bump [robot.bumper.data])
(machine m (state a) (state b)
  (on bump a -> b))
(spawn m a)
""",
    "LRP302": """
(machine m (state moving) (state end)
  (ontime 1000 {moving movin} -> end))
(spawn m moving)
---
(machine m (state moving) (state end)
  (ontime 1000 moving -> end))
(spawn m moving)
""",
    "LRP303": """
(machine m (state a) (state moving)
  (ontime 1000 a -> movin))
(spawn m a)
---
(machine m (state a) (state moving)
  (ontime 1000 a -> moving))
(spawn m a)
""",
    "LRP304": """
(machine follower (state a))
(spawn folower a)
---
(machine follower (state a))
(spawn follower a)
""",
    "LRP305": """
(machine m (state moving))
(spawn m movin)
---
(machine m (state moving))
(spawn m moving)
""",
    "LRP306": """
(machine m
  (state work (onentry (spawn n a))
    (machine n (state a) (exit [robot.bumper.data] a -> res)))
  (state rest))
(spawn m work)
---
(machine m
  (state work (onentry (spawn n a))
    (machine n (state a) (exit [robot.bumper.data] a -> rest)))
  (state rest))
(spawn m work)
""",
    "LRP307": """
(machine m (state a) (state b) (exit [robot.bumper.data] a -> b))
(spawn m a)
---
(machine m (state a) (state b) (on [robot.bumper.data] a -> b))
(spawn m a)
""",
    "LRP308": """
(var maxlook := [100])
(machine m (state a) (state b) (ontime maxlok a -> b))
(spawn m a)
---
(var maxlook := [100])
(machine m (state a) (state b) (ontime maxlook a -> b))
(spawn m a)
""",
    "LRP401": """
(machine m (state a) (state b))
(spawn m a)
---
(machine m (state a) (state b)
  (ontime 1000 a -> b))
(spawn m a)
""",
    "LRP402": """
(machine m
  (state a
    (machine n (state b))))
(spawn m a)
---
(machine m
  (state a
    (onentry (spawn n b))
    (machine n (state b))))
(spawn m a)
""",
    "LRP403": """
(event bump [robot.bumper.data])
(machine m (state a))
(spawn m a)
---
(event bump [robot.bumper.data])
(machine m (state a) (state b)
  (on bump a -> b))
(spawn m a)
""",
    "LRP404": """
(machine m (state a) (state b) (state c)
  (eps a -> b)
  (ontime 500 a -> c)
  (ontime 500 b -> c))
(spawn m a)
---
(machine m (state a) (state b) (state c)
  (ontime 500 a -> c)
  (eps a -> b)
  (ontime 500 b -> c))
(spawn m a)
""",
    "LRP405": """
(machine m (state a)
  (eps a -> a))
(spawn m a)
---
(machine m (state a)
  (ontime 1000 a -> a))
(spawn m a)
""",
    "LRP406": """
(event bump [robot.bumper.data])
(machine m (state a)
  (on bump *-> a))
(spawn m a)
---
(event bump [robot.bumper.data])
(machine m (state a) (state b)
  (on bump *-> b))
(spawn m a)
""",
    "LRP407": """
(machine m (state a))
(machine n (state a))
(spawn m a)
(spawn m a)
(spawn n a)
---
(machine m (state a))
(machine n (state a))
(spawn m a)
(spawn n a)
""",
    "LRP501": """
(machine m (state a (running [robot.move(linear=)])))
(spawn m a)
---
(machine m (state a (running [robot.move(linear=1)])))
(spawn m a)
""",
    "LRP502": """
(var forward := [0.2])
(machine m (state a (running [robot.move(linear=foward)])))
(spawn m a)
---
(var forward := [0.2])
(machine m (state a (running [robot.move(linear=forward)])))
(spawn m a)
""",
    "LRP503": """
(var count := [0])
(machine m (state a (onentry [cuont += 1])))
(spawn m a)
---
(var count := [0])
(machine m (state a (onentry [count += 1])))
(spawn m a)
""",
    "LRP504": """
(var nobump := [True])
(machine m (state a (onentry [nobump == False])))
(spawn m a)
---
(var nobump := [True])
(machine m (state a (onentry [nobump = False])))
(spawn m a)
""",
    "LRP505": """
(var mode := [0])
(event ready [mode = 1])
(machine m (state a) (state b) (on ready a -> b))
(spawn m a)
---
(var mode := [0])
(event ready [mode == 1])
(machine m (state a) (state b) (on ready a -> b))
(spawn m a)
""",
    "LRP506": """
(var f := [def f(x): return 2 * x])
(machine m (state a))
(spawn m a)
---
(var f := [
  def f(x): return 2 * x
  f])
(machine m (state a))
(spawn m a)
""",
    "LRP507": """
(machine m (state a (onentry [robot.stop])))
(spawn m a)
---
(machine m (state a (onentry [robot.stop()])))
(spawn m a)
""",
    "LRP508": """
(event always [1])
(machine m (state a) (state b) (on always a -> b))
(spawn m a)
---
(event always [True])
(machine m (state a) (state b) (on always a -> b))
(spawn m a)
""",
    "LRP509": """
(var nobump := [True])
(event bump [robot.bumper.data == 1 & nobump])
(machine m (state a) (state b) (on bump a -> b))
(spawn m a)
---
(var nobump := [True])
(event bump [robot.bumper.data == 1 and nobump])
(machine m (state a) (state b) (on bump a -> b))
(spawn m a)
""",
    "LRP510": """
(var ready := [True])
(var late := [False])
(machine m (state a (running [if late && ready: robot.stop()])))
(spawn m a)
---
(var ready := [True])
(var late := [False])
(machine m (state a (running [if late and ready: robot.stop()])))
(spawn m a)
""",
    "LRP511": """
(var ready := [True])
(machine m (state a (running [iff ready: robot.stop()])))
(spawn m a)
---
(var ready := [True])
(machine m (state a (running [if ready: robot.stop()])))
(spawn m a)
""",
    "LRP512": """
(var ready := [True])
(machine m (state a (running [if ready robot.stop()])))
(spawn m a)
---
(var ready := [True])
(machine m (state a (running [if ready: robot.stop()])))
(spawn m a)
""",
    "LRP513": """
(var ready := [True])
(machine m (state a (running [robot.move(linear=0.2])))
(spawn m a)
---
(var ready := [True])
(machine m (state a (running [robot.move(linear=0.2)])))
(spawn m a)
""",
    "LRP514": """
(var ready := [True])
(machine m (state a (running [print('ready)])))
(spawn m a)
---
(var ready := [True])
(machine m (state a (running [print('ready')])))
(spawn m a)
""",
    "LRP515": """
(var ready := [True])
(machine m
  (state a (running [
    if ready:
        robot.stop()
          print('stopped')])))
(spawn m a)
---
(var ready := [True])
(machine m
  (state a (running [
    if ready:
        robot.stop()
        print('stopped')])))
(spawn m a)
""",
    "LRP516": """
(var ready := [True])
(machine m (state a (running [if ready = True: robot.stop()])))
(spawn m a)
---
(var ready := [True])
(machine m (state a (running [if ready == True: robot.stop()])))
(spawn m a)
""",
    "LRP517": """
(var ready := [True])
(machine m (state a (running [print 'ready'])))
(spawn m a)
---
(var ready := [True])
(machine m (state a (running [print('ready')])))
(spawn m a)
""",
    "LRP520": """
; world: line
(machine m (state a (running [robot.moove(linear=0.2)])))
(spawn m a)
---
; world: line
(machine m (state a (running [robot.move(linear=0.2)])))
(spawn m a)
""",
    "LRP521": """
; world: line
(machine m (state a (running [robot.move(lineal=0.2)])))
(spawn m a)
---
; world: line
(machine m (state a (running [robot.move(linear=0.2)])))
(spawn m a)
""",
    "LRP522": """
; world: line
(machine m (state a) (state b)
  (on [robot.distance < 0.3] a -> b))
(spawn m a)
---
; world: line
(machine m (state a) (state b)
  (on [robot.distance.data < 0.3] a -> b))
(spawn m a)
""",
    "LRP523": """
; world: line
(machine m (state a (running [robot.light = 0])))
(spawn m a)
---
; world: line
(machine m (state a (running [print(robot.light.data)])))
(spawn m a)
""",
    "LRP524": """
; world: line
(machine m (state a) (state b)
  (on [robot.light.data() < 50] a -> b))
(spawn m a)
---
; world: line
(machine m (state a) (state b)
  (on [robot.light.data < 50] a -> b))
(spawn m a)
""",
    "LRP525": """
; world: line
(machine m (state a) (state b)
  (on [robot.light.data < "50"] a -> b))
(spawn m a)
---
; world: line
(machine m (state a) (state b)
  (on [robot.light.data < 50] a -> b))
(spawn m a)
""",
    "LRP526": """
; world: line
(machine m (state a) (state b)
  (on [robot.light.data == "black"] a -> b))
(spawn m a)
---
; world: line
(machine m (state a) (state b)
  (on [robot.light.data < 50] a -> b))
(spawn m a)
""",
    "LRP518": """
(var speed := [0.2])
(machine m (state a (onentry [speed = 0,5]) (running [robot.move(linear=speed)])))
(spawn m a)
---
(var speed := [0.2])
(machine m (state a (onentry [speed = 0.5]) (running [robot.move(linear=speed)])))
(spawn m a)
""",
    "LRP527": """
(var speed := [0.2])
(machine m (state a
  (onentry [if speed == 1 or 2: robot.stop()])
  (running [robot.move(linear=speed)])))
(spawn m a)
---
(var speed := [0.2])
(machine m (state a
  (onentry [if speed == 1 or speed == 2: robot.stop()])
  (running [robot.move(linear=speed)])))
(spawn m a)
""",
    "LRP528": """
(var speed := [0.2])
(machine m (state a (onentry [if speed is 1: robot.stop()]) (running [robot.move(linear=speed)])))
(spawn m a)
---
(var speed := [0.2])
(machine m (state a (onentry [if speed == 1: robot.stop()]) (running [robot.move(linear=speed)])))
(spawn m a)
""",
    "LRP529": """
(var speed := [0.2])
(machine m (state a (onentry [
    def slow():
      speed = 0.1
    slow()]) (running [robot.move(linear=speed)])))
(spawn m a)
---
(var speed := [0.2])
(machine m (state a (onentry [
    def slow():
      nonlocal speed
      speed = 0.1
    slow()]) (running [robot.move(linear=speed)])))
(spawn m a)
""",
    "LRP530": """
(var speed := [0.2])
(machine m (state a (onentry [sped = 0.5]) (running [robot.move(linear=speed)])))
(spawn m a)
---
(var speed := [0.2])
(machine m (state a (onentry [speed = 0.5]) (running [robot.move(linear=speed)])))
(spawn m a)
""",
    "LRP540": """
(machine m (state a (running [while True: robot.move(linear=0.1)])))
(spawn m a)
---
(machine m (state a (running [robot.move(linear=0.1)])))
(spawn m a)
""",
    "LRP541": """
(machine m
  (state a (running [while robot.distance.data > 0.3: robot.move(linear=0.1)]))
  (state b)
  (ontime 9000 a -> b))
(spawn m a)
---
(machine m
  (state a (running [robot.move(linear=0.1)]))
  (state b)
  (on [robot.distance.data <= 0.3] a -> b))
(spawn m a)
""",
    "LRP542": """
(machine m (state a (onentry [
  import time
  robot.move(linear=0.1)
  time.sleep(2)
  robot.stop()])))
(spawn m a)
---
(machine m
  (state a (running [robot.move(linear=0.1)]))
  (state b (onentry [robot.stop()]))
  (ontime 2000 a -> b))
(spawn m a)
""",
    "LRP543": """
(var speed := [float(input("How fast? "))])
(machine m (state a (running [robot.move(linear=speed)])))
(spawn m a)
---
(var speed := [0.1])
(machine m (state a (running [robot.move(linear=speed)])))
(spawn m a)
""",
}
