"""Take away from a Python on Linux what Windows lacks; it runs where this folder is one of `site-packages`.

What `subprocess` itself needs here stays: `os.waitpid`, `signal.SIGKILL` and their like.
"""

import os
import signal
import sys

for name in (
    *("fork", "forkpty", "register_at_fork", "setsid", "getsid", "getpgid", "getpgrp", "setpgid", "killpg"),
    *("sched_getaffinity", "sysconf", "O_NOFOLLOW", "getloadavg", "nice", "wait4"),
):
    delattr(os, name)
for name in ("SIGALRM", "SIGHUP", "SIGUSR1", "SIGVTALRM", "alarm", "setitimer", "pthread_kill", "sigwait"):
    delattr(signal, name)
for name in ("fcntl", "grp", "pwd", "resource", "termios", "tty"):
    sys.modules[name] = None  # importing it raises an ImportError
