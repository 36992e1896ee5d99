"""The referee of one run: what each criterion of a challenge says, at any moment of the run and at its end.

This is the one place where runs are judged: the goal panel of a lab asks the referee of the run that one
watches, and grading asks one for each of its runs.
"""

from __future__ import annotations

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import Finding, ended
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import Criterion, State, Verdict, no_faults, not_carried
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.sim.world import World


class Referee:
    """Judges one run, tick by tick.

    `world`: in which the robot drives.
    """

    def __init__(self, task: Challenge, world: World) -> None:
        self.task = task
        self.run = RunRecord(world)
        self._restarts = 0  # of the interpreter, before the run began
        self._decided: dict[Criterion, Verdict] = {}
        self._latest: dict[Criterion, Verdict] = {}
        self._met_since: float | None = None  # all criteria
        self._done = 0.0  # the most so far of the shares of what has to be met once

    def see(self, bridge: SimBridge, interpreter: Interpreter, findings: tuple[Finding, ...] = ()) -> bool:
        """Record the tick that has just ended; return whether the run is decided. On the loop's thread.

        `findings`: what the checks find in the program that runs.
        """
        run = self.run
        run.findings = findings
        if not run.samples:
            self._restarts = interpreter.restarts
        run.sample(bridge, interpreter)
        run.restarts = interpreter.restarts - self._restarts
        run.restart_reason = interpreter.restart_reason
        return self._judge()

    def go_back(self, time: float) -> None:
        """Forget what happened from a time on, in seconds of the run."""
        self.run.cut(time)
        self._decided.clear()
        self._latest.clear()
        self._met_since, self._done = None, 0.0

    def _judge(self) -> bool:
        """Ask all criteria whose answer can still change; return whether the run is decided.

        It is when one is broken, or when all have been met for long enough; or when some are not met and the
        time is over, which all that is met may outlast.
        """
        missing, broken, done = False, False, 0.0
        for criterion in (*self.task.criteria, *_RULES):
            verdict = self._decided.get(criterion)
            if verdict is None:
                verdict = self._latest[criterion] = self._verdict(criterion)
                if verdict.decided is not None:
                    self._decided[criterion] = verdict
            missing = missing or not verdict.passed
            broken = broken or verdict.state == "failed"
            done += verdict.share if criterion.when == "once" else 0.0
        now = self.run.seconds
        if done > self._done + 1e-3:
            self._done = done
            self.run.steps.append(now)
        if broken or missing:
            self._met_since = None
            return broken or now >= self.task.seconds - 1e-6
        if self._met_since is None:
            self._met_since = now
        return now - self._met_since >= self.task.hold - 1e-6

    def _verdict(self, criterion: Criterion) -> Verdict:
        found, reason = criterion.judge(self.run)
        share = min(1.0, max(0.0, float(found)))
        passed = share >= 1
        state: State = "so far" if passed else "open"
        if criterion.when == "once" and passed:
            state = "met"
        elif criterion.when == "always" and not passed:
            state = "failed"
        is_decided = state in ("met", "failed")
        return Verdict(
            criterion.sentence, passed, reason, share, state, self.run.seconds if is_decided else None
        )

    def verdicts(self, is_over: bool) -> tuple[Verdict, ...]:
        """Return the verdict on each criterion; when the run is over, each is met or failed.

        If a criterion was broken, the run has ended before the others were decided: those stay open.
        """
        latest = self._latest
        shown = [latest.get(each, Verdict(each.sentence, False, "")) for each in self.task.criteria]
        known = {verdict.sentence for verdict in shown}
        shown += [
            verdict._replace(reason=f"{ended(verdict.reason)} This costs all points of the run.")
            for verdict in self._broken
            if verdict.sentence not in known
        ]
        if not is_over:
            return tuple(shown)
        cut = any(each.state == "failed" for each in shown)
        end = f"not decided, because the run failed after {self.run.seconds:.1f} s"
        return tuple(
            each._replace(state="met")
            if each.passed
            else each._replace(reason=end)
            if cut and each.decided is None
            else each._replace(state="failed")
            for each in shown
        )

    @property
    def _broken(self) -> list[Verdict]:
        """The verdicts on the rules of every challenge that are broken."""
        found = (self._latest.get(rule) for rule in _RULES)
        return [verdict for verdict in found if verdict is not None and not verdict.passed]

    @property
    def share(self) -> float:
        """The share of the points that the run earns, 0 to 1.

        The criteria count alike, in their order, up to the first one that is not met, of which its share
        counts: what comes later is not earned before. A run that breaks a rule of every challenge earns
        nothing.
        """
        if self._broken:
            return 0.0
        earned = 0.0
        for criterion in self.task.criteria:
            verdict = self._latest.get(criterion)
            if verdict is None or (criterion.when == "always" and not self.run.samples):
                break
            earned += verdict.share
            if not verdict.passed:
                break
        return earned / len(self.task.criteria) if self.task.criteria else 1.0


_RULES = (not_carried(), no_faults())  # of every challenge; they are shown when they are broken
