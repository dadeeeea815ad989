"""Ways to spoil a file: bytes, numbers, words, lines, and the parts of JSON."""

from __future__ import annotations

import copy
import json
import random
import re
from collections.abc import Callable
from typing import Any

NUMBER = re.compile(rb"-?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?")
WORD = re.compile(rb"[A-Za-z_][\w:]*")
ODD_NUMBERS = (
    *(b"nan", b"inf", b"-1", b"0", b"-0.0", b"1e308", b"-1e308", b"1e-320", b"1e400", b"0.5"),
    *(b"99999999999999999999", b"2147483648", b"9" * 400, b"1e-9", b"1e9", b"'a'", b'"a"'),
    *(b"null", b"[]", b"[1, 2]", b"{}", b"true", b"", b"-", b"1_0", b"0x10", b"\xc2\xbd"),
)
ODD_VALUES: tuple[Any, ...] = (
    *(None, True, "", "a", -1, 0, 1e308, 5e-324, 2**70, 10**400, float("nan"), float("-inf")),
    *([], {}, [[]], [None], [0, 0], {"a": 1}, [1.5, "x"], "\x1b[31m\u202e", [[1, [2, [3]]]]),
)


def spoil(raw: bytes, seed: int) -> bytes:
    """Return a file spoilt in one to three ways, the same for the same seed."""
    rng = random.Random(seed)
    if raw[:1] == b"{" and rng.random() < 0.6:
        if len(rows := raw.splitlines()) == 1 or rows[1][:1] != b"{":
            return _parts(raw, rng)
        k = rng.randrange(len(rows))  # JSON lines
        return b"\n".join((*rows[:k], _parts(rows[k], rng), *rows[k + 1 :])) + b"\n"
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        raw = rng.choice(WAYS)(raw, rng)
    return raw


def _parts(raw: bytes, rng: random.Random) -> bytes:
    """Change entries of JSON, shallow ones as often as deep ones."""
    data = json.loads(raw)
    for _ in range(rng.choice((1, 1, 2))):
        at: Any = data
        while True:
            inner = list(at) if isinstance(at, dict) else [*range(len(at))]
            if not inner:
                break
            key = rng.choice(inner)
            if isinstance(at[key], dict | list) and at[key] and rng.random() < 0.7:
                at = at[key]
                continue
            _change(at, key, rng)
            break
    return json.dumps(data).encode()


def _change(at: Any, key: Any, rng: random.Random) -> None:
    """Change one entry of a dict or list."""
    way = rng.randrange(5)
    if way == 0:
        del at[key]
    elif way == 1 and isinstance(at, list):
        at.insert(key, at[key])
    elif way == 2:
        other = rng.choice(list(at) if isinstance(at, dict) else [*range(len(at))])
        at[key], at[other] = at[other], at[key]
    elif way == 3 and type(at[key]) in (int, float):
        at[key] = rng.choice((-1, 1e-9, 1e9, 1 + 1e-7, 0)) * at[key]
    else:
        at[key] = copy.deepcopy(rng.choice(ODD_VALUES))


def _swap(what: re.Pattern[bytes], by: Callable[[random.Random, list[bytes]], bytes]) -> Any:
    """Return a way that puts another word where one matches."""

    def way(raw: bytes, rng: random.Random) -> bytes:
        found = [*what.finditer(raw)]
        if not found:
            return raw
        one = rng.choice(found)
        return raw[: one.start()] + by(rng, [m.group() for m in found]) + raw[one.end() :]

    return way


def _byte(raw: bytes, rng: random.Random) -> bytes:
    k = rng.randrange(len(raw) + 1)
    return raw[:k] + bytes([rng.randrange(256)]) + raw[k + rng.randrange(2) :]


def _cut(raw: bytes, rng: random.Random) -> bytes:
    a, b = sorted(rng.randrange(len(raw) + 1) for _ in range(2))
    return raw[:a] + raw[b:] if rng.random() < 0.5 else raw[:b]


def _again(raw: bytes, rng: random.Random) -> bytes:
    a, b = sorted(rng.randrange(len(raw) + 1) for _ in range(2))
    return raw[:b] + raw[a:b] * rng.choice((1, 1, 5, 200 if b - a < 1000 else 1)) + raw[b:]


def _lines(raw: bytes, rng: random.Random) -> bytes:
    rows = raw.splitlines(keepends=True) or [b""]
    a, b = rng.randrange(len(rows)), rng.randrange(len(rows))
    way = rng.randrange(4)
    if way == 0:
        del rows[a]
    elif way == 1:
        rows.insert(b, rows[a])
    elif way == 2:
        rows[a], rows[b] = rows[b], rows[a]
    else:
        rng.shuffle(rows)
    return b"".join(rows)


WAYS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    *(_swap(NUMBER, lambda rng, _: rng.choice(ODD_NUMBERS)),) * 3,
    _swap(NUMBER, lambda rng, found: rng.choice(found)),
    *(_swap(WORD, lambda rng, found: rng.choice(found)),) * 2,
    _swap(WORD, lambda rng, _: rng.choice((b"", b"a", b"\xff", b"__import__", b"x" * 5000))),
    *(_byte, _cut, _again, _lines),
)
