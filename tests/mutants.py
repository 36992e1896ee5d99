"""How many planted faults the tests notice: ``python -m tests.mutants --sample 600 --out FILE``.

A mutant is the product with one small fault: another operator, constant or order of arguments, a call or a
branch dropped. A seed draws them, as many from each part. Each runs in a copy of the checkout with the tests
that reach its line, quickest first, until one fails; in the page, with what imports its module.
``--again FILE`` tries the mutants of an earlier run, as far as their code still exists.
"""

import argparse
import ast
import contextlib
import copy
import csv
import itertools
import os
import queue
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

_ROOT = Path(__file__).parents[1]
_PARTS = ["interpreter", "language", "live", "bridges", "widgets", "graph", "sim", "grading"]
_BUDGET = 30.0  # s of tests for a mutant, as they take without it
_PATIENCE = 300.0  # s until one that hangs is killed
_PLAIN = "-k=not hang and not return and not sleep"  # blocks are interrupted by a tracer, too
_OTHER = "Lt LtE, Gt GtE, Eq NotEq, Is IsNot, In NotIn, And Or, Add Sub, Mult Div, Mod Add, FloorDiv Mult"
_PAIRS = [tuple(getattr(ast, name) for name in pair.split()) for pair in _OTHER.split(", ")]
_SWAPPED = {one: other for a, b in _PAIRS for one, other in ((b, a), (a, b))}
_TOKENS = "===/!== !==/=== </<= <=/< >/>= >=/> &&/|| ||/&& +/- -/+"
_TEXT = {f" {a} ": f" {b} " for a, b in (pair.split("/") for pair in _TOKENS.split())}
_TEXT |= {"true": "false", "false": "true"}
_PATTERN = "|".join(map(re.escape, _TEXT)) + r"|(?<![\w.#$])\d+(?:\.\d+)?(?![\w.])|(?<=if )\(.*\)(?= \{$)"


class Mutant(NamedTuple):
    """A place in a file, and what stands there instead; the first five fields find it in a later version."""

    path: str
    scope: str
    kind: str
    before: str
    nth: int
    after: str
    line: int
    start: int

    @property
    def part(self) -> str:
        return self.path.split("/")[1 if self.path.startswith("lrp_jupyter") else 0]


def _changed(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """The kinds of faults that a node can have, each with what stands there then."""
    other = copy.deepcopy(node)
    match other:
        case ast.Compare(ops=[op]) if type(op) in _SWAPPED:
            other.ops = [_SWAPPED[type(op)]()]
            yield "comparison", other
        case ast.BinOp(op=op) | ast.BoolOp(op=op) if type(op) in _SWAPPED:
            other.op = _SWAPPED[type(op)]()
            yield "operator", other
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield "negation", operand
        case ast.Constant(value=bool(value)):
            yield "constant", ast.Constant(not value)
        case ast.Constant(value=int(value) | float(value)):
            yield "constant", ast.Constant(value + 1)
        case ast.Call(args=[first, second, *rest]) if not isinstance(first, ast.Starred | ast.Constant):
            other.args = [second, first, *rest]
            yield "arguments", other
        case ast.Expr(value=ast.Call()):
            yield "call", ast.Constant(None)
        case ast.If():
            yield from (("branch True", ast.Constant(True)), ("branch False", ast.Constant(False)))


def _python(path: Path) -> Iterator[Mutant]:
    source, where, seen = path.read_bytes(), str(path.relative_to(_ROOT)), Counter()
    starts = [0, *itertools.accumulate(map(len, source.splitlines(keepends=True)))]

    def visit(node: ast.AST, scope: str) -> Iterator[Mutant]:
        for kind, other in _changed(node):
            place = node.test if isinstance(node, ast.If) else node
            start = starts[place.lineno - 1] + place.col_offset
            before = source[start : starts[place.end_lineno - 1] + place.end_col_offset].decode()
            seen[scope, kind, before] += 1
            nth = seen[scope, kind, before]
            yield Mutant(where, scope, kind, before, nth, f"({ast.unparse(other)})", place.lineno, start)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            scope = f"{scope}.{node.name}".lstrip(".")
        for field, value in ast.iter_fields(node):
            if field not in ("annotation", "returns", "decorator_list", "bases"):
                for child in value if isinstance(value, list) else [value]:
                    if isinstance(child, ast.AST) and not isinstance(child, ast.JoinedStr | ast.Raise):
                        yield from visit(child, scope)

    yield from visit(ast.parse(source), "")


def _typescript(path: Path) -> Iterator[Mutant]:
    where, offset, seen = str(path.relative_to(_ROOT)), 0, Counter()
    for number, line in enumerate(path.read_bytes().splitlines(keepends=True), 1):
        text = line.decode()
        prose = re.match(r"\s*(import|export type|type|/?\*|//)", text)
        calls = re.finditer(r"^\s*[\w.]+\(.*\);$", text)
        for match in [] if prose else itertools.chain(re.finditer(_PATTERN, text), calls):
            ahead, before = text[: match.start()], match[0]
            if any(ahead.count(quote) % 2 for quote in "\"'`"):
                continue
            kind, after = "constant", re.sub(r"^\d+", lambda digits: str(int(digits[0]) + 1), before)
            if before in _TEXT:
                kind, after = "operator", _TEXT[before]
            elif before.endswith(";"):
                kind, after = "call", ";"
            elif before.startswith("("):
                kind, after = "branch", f"(!{before})"
            seen[text, kind] += 1
            start = offset + len(ahead.encode())
            yield Mutant(where, text.strip(), kind, before, seen[text, kind], after, number, start)
        offset += len(line)


def mutants() -> Iterator[Mutant]:
    """Every mutant there is."""
    for path in sorted(path for part in _PARTS for path in (_ROOT / "lrp_jupyter" / part).rglob("*.py")):
        yield from _python(path)
    for path in sorted((_ROOT / "js/src").rglob("*.ts")):
        if path.name not in ("protocol.ts", "parser.ts", "parser.terms.ts"):  # generated
            yield from _typescript(path)


class Suite:
    """Which tests reach which line, how long each takes, and copies of the checkout to run them in."""

    def __init__(self, folder: Path, jobs: int) -> None:
        measured, log, self._copies = folder / "coverage", folder / "durations", queue.Queue()
        for copied in (folder / f"copy{number}" for number in range(jobs)):
            shutil.rmtree(copied, ignore_errors=True)
            shutil.copytree(_ROOT, copied, symlinks=True, ignore=shutil.ignore_patterns(".git", ".venv*"))
            self._copies.put(copied)
        if not log.exists():
            command = _pytest(
                "--durations=0",
                "-vv",
                "-p",
                "pytest_cov",
                "--cov",
                "--cov-context=test",
                "--cov-report=",
                _PLAIN,
            )
            with log.open("w") as file:
                subprocess.run(
                    command, cwd=_ROOT, env=os.environ | {"COVERAGE_FILE": str(measured)}, stdout=file
                )
        self._durations = Counter[str]()
        for seconds, name in re.findall(r"^([\d.]+)s \w+ +(tests/.*)$", log.read_text(), re.MULTILINE):
            self._durations[name] += float(seconds)
        from coverage import CoverageData

        data = CoverageData(str(measured))
        data.read()
        self._reached = {os.path.relpath(f, _ROOT): data.contexts_by_lineno(f) for f in data.measured_files()}

    def _tests(self, mutant: Mutant) -> list[str]:
        lines = self._reached.get(mutant.path, {})
        contexts = lines.get(mutant.line, [])
        if "" in contexts and not any(contexts):  # of the module's own level: what reaches the module
            contexts = itertools.chain(*lines.values())
        names = {context.split("|")[0] for context in contexts} & self._durations.keys()
        ordered = sorted(names, key=lambda name: (self._durations[name], name))
        spent = itertools.accumulate(self._durations[name] for name in ordered)
        return [name for name, seconds in zip(ordered, spent, strict=True) if seconds <= _BUDGET]

    def outcome(self, mutant: Mutant) -> str:
        """Try a mutant: *killed*, *survived*, or *unreached* by any test."""
        where = self._copies.get()
        file = where / mutant.path
        source = file.read_bytes()
        rest = source[mutant.start + len(mutant.before.encode()) :]
        try:
            file.write_bytes(source[: mutant.start] + mutant.after.encode() + rest)
            if mutant.part == "js":
                command = ["npx", "vitest", "related", "--run", "--bail=1", mutant.path.removeprefix("js/")]
                passed = _passes(command, where / "js")
            elif names := self._tests(mutant):
                (where / ".chosen").write_text("\n".join(names))
                passed = _passes(_pytest("-x", "@.chosen"), where)
            else:
                return "unreached"
            return "survived" if passed else "killed"
        finally:
            file.write_bytes(source)
            self._copies.put(where)


def _pytest(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "pytest", "-n0", "--dist=no", "-p", "no:cacheprovider", *arguments]


def _passes(command: list[str], where: Path) -> bool:
    """Whether a command succeeds; one that hangs does not, and what it has started is killed."""
    quiet = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    environment = os.environ | {"PYTHONPATH": str(where)}
    with subprocess.Popen(command, cwd=where, env=environment, start_new_session=True, **quiet) as process:
        try:
            return process.wait(_PATIENCE) == 0
        except subprocess.TimeoutExpired:
            return False
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", type=int, default=600)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--again", type=Path)
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()) / "lrp-mutants")
    parser.add_argument("--out", type=Path, default=Path("mutants.csv"))
    options = parser.parse_args()
    options.folder.mkdir(exist_ok=True)
    parts, draw, totals = defaultdict(list), random.Random(options.seed), defaultdict(Counter)
    for mutant in mutants():
        parts[mutant.part].append(mutant)
    if options.again:
        keys = {tuple(row[:5]) for row in csv.reader(options.again.open())}
        drawn = [each for part in parts.values() for each in part if (*each[:4], str(each.nth)) in keys]
        print(f"{len(drawn)} of {len(keys)} mutants are still there")
    else:
        share = options.sample // len(parts)
        drawn = [each for part in parts.values() for each in draw.sample(part, min(len(part), share))]
    draw.shuffle(drawn)  # a run that is stopped has tried something of all
    suite = Suite(options.folder, options.jobs)
    with ThreadPoolExecutor(options.jobs) as pool, options.out.open("w") as file:
        for mutant, outcome in zip(drawn, pool.map(suite.outcome, drawn), strict=True):
            csv.writer(file).writerow([*mutant[:5], outcome, mutant.line, mutant.after])
            file.flush()
            totals[mutant.part][outcome] += 1
            if outcome != "killed":
                print(f"{mutant.path}:{mutant.line} {outcome}: {mutant.before} -> {mutant.after}", flush=True)
    for part, counts in sorted(totals.items()):
        print(f"{part:12} {counts['killed']:4} of {counts.total():4} killed, {counts['unreached']} unreached")


if __name__ == "__main__":
    main()
