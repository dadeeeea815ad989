"""Spoil files of every format and see how each reader ends: `python -m tests.hostile [COUNT [FIRST]]`.

Prints a line for each file that ends in a traceback, takes more than its time or 2 GB, and a count by format; the exit
code is 1 where there is one.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import NamedTuple

from origami_nlp import (
    OrigamiError,
    check,
    convert,
    examples,
    find_minima,
    format_scene,
    layer_orders,
    read_result,
)
from origami_nlp.errors import Interrupted
from tests.command_line import run
from tests.documentation.pages import ROOT
from tests.hostile.spoiling import spoil

SECONDS, OVER, HANGS, MOST = 1.0, 2.0, 30.0, 2 << 30
"""Of `--seconds`; processor time allowed over it; wall time after which a file hangs; memory [bytes]."""
FILES = (
    *("inspect {}", "check {}", "convert {} out.svg", "minima {} --seconds 1"),
    *("check {} --orders --seconds 1", "inspect {} --path --seconds 1"),
    *("minima {} --snap 1e-3 --bend 0.1 --seconds 1", "load {} --crease 1 --seconds 1"),
)
SCENES = (
    *("inspect {}", "minima {} --seconds 1", "load {} --crease 1 --seconds 1"),
    *("contacts {} --seconds 1", "barriers {} --seconds 1", "landscape {} --seconds 1"),
    "follow {} --parameter creases.stiffness[1]=0.5:1.5 --seconds 1",
)


class Sample(NamedTuple):
    """A sound file, and commands, or `read_result`, that are asked to read it."""

    name: str
    raw: bytes
    reads: tuple[str | Callable[[str], None], ...]


def read_back(file: str) -> None:
    """Read a result, and have it say and write what it can."""
    try:
        result = read_result(file)
    except OrigamiError:
        return
    asked = [lambda: result.report(verbose=True), lambda: repr(result)]
    asked += [
        partial(result.save, f"again.{end}") for end in ("json", "html", "csv", "fold", "svg")
    ]
    asked += [result.to_frame] if hasattr(result, "to_frame") else []
    for ask in asked:
        with suppress(OrigamiError):
            ask()


def beans(cp: str, title: str = "") -> bytes:
    """Return the lines of a .cp file as ORIPA's older programs write them: no property that is 0."""
    number = '<void property="{0}"><{1}>{2}</{1}></void>'
    lines = ""
    for k, row in enumerate(cp.split("\n")[:-1]):
        each = zip(
            ("type", "x0", "y0", "x1", "y1"), ("int", *["double"] * 4), row.split(), strict=True
        )
        own = "".join(number.format(*one) for one in each if float(one[2]))
        lines += f'<void index="{k}"><object class="oripa.OriLineProxy">{own}</object></void>'
    lines = f'<void property="lines"><array class="oripa.OriLineProxy">{lines}</array></void>'
    title = f'<void property="title"><string>{title}</string></void>'
    return f'<java><object class="oripa.DataSet">{lines}{title}</object></java>'.encode()


def samples(folder: Path) -> Iterator[Sample]:
    """Make a sound file of every format that is read."""
    miura = examples.crease_pattern("miura", 3, 3)
    yield Sample("a.fold", json.dumps(miura).encode(), FILES)
    found = find_minima("miura:2x2", starts=4, seconds=20)
    yield Sample("states.fold", json.dumps(found.to_fold()).encode(), FILES[:2])
    for ending in ("svg", "cp", "dxf"):
        path = folder / f"a.{ending}"
        convert("miura:3x3", path)
        yield Sample(path.name, path.read_bytes(), FILES)
    yield Sample("a.opx", beans((folder / "a.cp").read_text()), FILES)
    traced = (ROOT / "docs" / "files" / "traced.svg").read_bytes()
    yield Sample("traced.svg", traced, FILES)
    for name, scene in (
        ("miura.toml", "miura"),
        ("six.toml", "degree6"),
        ("law.toml", "tape-spring"),
        ("stops.toml", "thick-panel"),
    ):
        text = run("example", scene).out.encode()
        yield Sample(name, text, SCENES)
    targets = run("example", "switch").out.encode()
    yield Sample("targets.toml", targets, ("design {} --seconds 1 --effort quick",))
    swept = (ROOT / "docs" / "files" / "sweep.toml").read_bytes()
    yield Sample("sweep.toml", swept, ("sweep {} --folder swept --workers 1 --seconds 1",))
    run("sweep", ROOT / "docs" / "files" / "sweep.toml", "--folder", folder / "swept")
    rows = (folder / "swept" / "sweep.jsonl").read_bytes()
    yield Sample(
        "swept/sweep.jsonl",
        rows,
        (f"sweep {ROOT}/docs/files/sweep.toml --folder swept --workers 1",),
    )
    tape = (ROOT / "docs" / "files" / "tape.csv").read_bytes()
    yield Sample("tape.csv", tape, ("hinge {} --seconds 1",))
    proof = folder / "proof.json"
    words = ("minima", "miura:2x2", "--contact", "fold-limits", "--certificate", proof)
    assert run(*words, "--seconds", 60).code == 0
    yield Sample("proof.json", proof.read_bytes(), ("check-proof {} --seconds 1",))
    results = {
        "minima.json": found,
        "scene.json": find_minima(examples.miura(), max_starts=4),
        "check.json": check("miura:2x2"),
        "layers.json": layer_orders("miura:2x2"),
    }
    for name, result in results.items():
        result.save(folder / name)
        yield Sample(name, (folder / name).read_bytes(), (read_back,))
    for name, line in {
        "load.json": "load miura.toml --crease 1",
        "follow.json": "follow miura.toml --parameter creases.stiffness[1]=0.5:1.5",
        "motion.json": "inspect miura:2x2 --path",
        "inspect.json": "inspect miura:2x2",
        "barriers.json": "barriers miura.toml",
        "hinge.json": f"hinge {ROOT}/docs/files/tape.csv",
    }.items():
        done = run(*line.split(), "-o", name)
        assert done.code == 0, done
        yield Sample(name, Path(name).read_bytes(), (read_back,))


def judge(read: str | Callable[[str], None], file: str) -> str:
    """Have a file read in a process of its own; what was wrong with how it ended, or ""."""
    out, into = os.pipe()
    if not (child := os.fork()):
        os.close(out)
        os.write(into, _in_child(read, file).encode()[-2000:])
        os._exit(0)
    os.close(into)
    begin, said = time.monotonic(), ""
    while not (done := os.wait4(child, os.WNOHANG))[0]:
        if time.monotonic() - begin > HANGS:
            os.kill(child, signal.SIGKILL)
            said = "hangs"
        time.sleep(0.005)
    with open(out, "rb") as pipe:
        return said or (f"killed by signal {done[1]}" if done[1] else pipe.read().decode())


def _in_child(read: str | Callable[[str], None], file: str) -> str:
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + MOST, taken + MOST))
    begin = time.process_time()
    try:
        if callable(read):
            read(file)
        else:
            done = run(*read.format(file).split())
            if done.code == 70 or "Traceback" in done.err + done.out or "\x1b" in done.err:
                return f"code {done.code}: {done.err[-600:]}"
    except BaseException as error:
        if isinstance(error, Interrupted):
            return ""
        import traceback

        return traceback.format_exc()[-1200:]
    took = time.process_time() - begin
    return f"{took:.1f} s" if took > SECONDS + OVER else ""


def main() -> int:
    """Spoil and read; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", nargs="?", type=int, default=3000)
    parser.add_argument("first", nargs="?", type=int, default=0)
    parser.add_argument("--only", default="", help="formats whose name has this in it")
    given = parser.parse_args()
    bad, asked = Counter[str](), Counter[str]()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.chdir(folder)
        (folder / "miura.toml").write_text(format_scene(examples.miura()))
        sound = [s for s in samples(folder) if given.only in s.name]
        for seed in range(given.first, given.first + given.count):
            one = sound[seed % len(sound)]
            file = folder / one.name
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(spoil(one.raw, seed))
            read = one.reads[seed // len(sound) % len(one.reads)]
            asked[one.name] += 1
            if wrong := judge(read, str(file)):
                bad[one.name] += 1
                print(f"{seed} {one.name} {read}: {wrong}", flush=True)
    for name, many in asked.items():
        print(f"{name}: {many} spoilt, {bad[name]} end badly")
    return bool(bad)


if __name__ == "__main__":
    sys.exit(main())
