"""411: delays shorter than a tick, where seconds are probably meant."""

from __future__ import annotations

from lrp_jupyter.language.checks.constants import Constants, written_in
from lrp_jupyter.language.checks.report import Reporter, replace
from lrp_jupyter.language.program import Block, Name, Span
from lrp_jupyter.language.resolution import Resolution
from lrp_jupyter.language.triggers import Delay

TICK = 100
"""Milliseconds of a tick at the usual rate."""


_AMOUNTS = frozenset({"INTEGER", "AMOUNT"})


def check_delays(report: Reporter, names: Resolution, tick: float = TICK) -> None:
    """Report delays of less than a tick, which lasts `tick` milliseconds."""
    constants = Constants(names)
    told: set[int] = set()  # variables that several transitions wait for

    def short(number: float, span: Span, name: str = "", has_place: bool = True) -> None:
        if not 0 < number < tick:
            return
        meant = f"{number * 1000:.0f}"
        is_delay = f"`{name}` is a delay in milliseconds" if name else "A delay is in milliseconds"
        message = f"{is_delay}, and {number:g} ms is less than one tick. For {number:g} s, write `{meant}`."
        report.add("LRP411", span, message, replace(span, meant) if has_place else None)

    for scope in names.scopes:
        for arrow in names.arrows[scope]:
            for delay in (arrow.noun.trigger, arrow.noun.hold):
                if isinstance(delay, Delay) and isinstance(delay.amount, Name):
                    written = constants.number(scope.owner("variable", delay.amount), delay.amount)
                    if written is not None and written.number is not None and id(written.block) not in told:
                        told.add(id(written.block))
                        short(written.number, written.block.at(written.span), str(delay.amount))
                elif isinstance(delay, Delay) and isinstance(delay.amount, int):
                    if 0 < delay.amount < tick:
                        span = _amount(report, arrow.noun.span, delay is arrow.noun.hold)
                        short(delay.amount, span or arrow.noun.span, has_place=span is not None)
                elif isinstance(delay, Delay) and isinstance(delay.amount, Block):
                    written = written_in(delay.amount)
                    if written is not None and written.number is not None:
                        short(written.number, delay.amount.at(written.span))


def _amount(report: Reporter, transition: Span, is_hold: bool) -> Span | None:
    """Return where the number of a delay is written; None in a program that was made without a text."""
    if not report.program.text:
        return None
    items = report.sheet.at(transition.start).items
    amounts = [each for each in items if isinstance(each, tuple) and each[0] in _AMOUNTS]
    return Span(*amounts[-1 if is_hold else 0][1:])
