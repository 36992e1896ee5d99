"""How long a class and a sweep take, on one processor, all, and a cluster: run this file as a script.

Each row of a table is the same batch, and its results are compared with those of the first row. Times are
wall seconds, because it is about processors that wait: measure on a machine that does nothing else. The
cluster is one of Dask (the extra `batch`) on this machine, with a worker for each processor; its start does
not count.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from contextlib import ExitStack
from time import perf_counter

from lrp_jupyter import programs
from lrp_jupyter.grading.challenges import challenge
from lrp_jupyter.grading.cluster import local_cluster
from lrp_jupyter.grading.marks import Marks, grade_class
from lrp_jupyter.grading.submissions import Submission
from lrp_jupyter.grading.sweep import Sweep, sweep_axes
from lrp_jupyter.grading.workers import HowRun, processors
from lrp_jupyter.language.edits.initials import with_initial

FOLLOWER = programs.load("follower")
DRIVE = "(machine m (state driving (running [{}]))) (spawn m driving)"
LIMIT = 30.0  # wall seconds of a run; a block that hangs is ended after a sixth of it


def submissions(count: int) -> list[Submission]:
    """Return the programs of a class, all different; one of them hangs, and one crashes."""
    values = [0.5 + 1.5 * index / count for index in range(count - 2)]
    texts = [with_initial(FOLLOWER, ("search",), repr(value)) for value in values]
    texts.insert(count // 3, DRIVE.format("while True: pass"))
    texts.insert(2 * count // 3, DRIVE.format("import os; os.abort()"))
    return [Submission(f"student {number}", f"{number}.lrp", text) for number, text in enumerate(texts)]


def table(title: str, how: dict[str, HowRun], make: Callable[[HowRun], Marks | Sweep]) -> Marks | Sweep:
    """Print the time of a batch for each way to make its runs; return its result."""
    print(f"\n**{title}**\n\n| | s | times as fast | results |\n|---|---:|---:|---|")
    first: tuple[float, Marks | Sweep] | None = None
    for name, way in how.items():
        begin = perf_counter()
        result = make(way)
        seconds = perf_counter() - begin
        first = first or (seconds, result)
        same = "the same" if result == first[1] else "DIFFERENT"
        print(f"| {name} | {seconds:.1f} | {first[0] / seconds:.2f} | {same} |", flush=True)
    assert first is not None
    return first[1]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small batches, to see that it works")
    quick = parser.parse_args().quick
    task = challenge("first move" if quick else "there and back")
    students, seeds, values = (3, 1, 2) if quick else (30, 5, 9)
    limit = 6.0 if quick else LIMIT
    group = submissions(students)
    healthy = [each for each in group if each.text and each.text.startswith(";")]
    axes = {"search": tuple(round(0.4 + 1.6 * step / (values - 1), 3) for step in range(values))}

    with ExitStack() as opened:
        begin = perf_counter()
        address = local_cluster(opened, processors()).scheduler_address
        started = perf_counter() - begin
        how = {
            "one processor": HowRun(limit, processes=1),
            f"all {processors()} processors": HowRun(limit),
            "a Dask cluster": HowRun(limit, scheduler=address),
        }
        for way in how.values():  # so that all are warm
            grade_class(healthy[: processors()], task, processors(), way)

        def grade_them(each: list[Submission]) -> Callable[[HowRun], Marks]:
            return lambda way: grade_class(each, task, seeds, way)

        runs = f"{students} submissions, {seeds} seeds"
        table(f"A class of {runs}; one hangs and one crashes", how, grade_them(group))
        table("The same class without these two", how, grade_them(healthy))
        result = table(
            f"A sweep of {values} values, {2 * seeds} seeds",
            how,
            lambda way: sweep_axes(FOLLOWER, task, axes, 2 * seeds, way, lambda done, of: None),
        )
    print(f"\n{result}\n\nThe cluster started in {started:.1f} s.")


if __name__ == "__main__":
    main()
