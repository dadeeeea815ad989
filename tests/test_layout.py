"""Rooms stand in an order and are entered by their faces, modules make no circle, and importing stays light.

Every import counts, wherever it stands: at the top, inside a function, under TYPE_CHECKING, or as the
name of a module in a string.
"""

import ast
import re
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

import nbformat
import pytest

import origami_nlp

PACKAGE = Path(origami_nlp.__file__).parent
ROOT = PACKAGE.parent
ORDER = (
    "version errors arguments workers io numerics closed_forms symbolic drawings pattern problem kkt "
    "pattern_problem search escapes continuation display hinges chart proof "
    "minima pattern_states contact barriers paper paths inverse_design "
    "sweep validity results verbs cli __main__"
).split()
"""Files at the root, then rooms; each imports only from those before it."""
BESIDE = ("symbolic", "benchmarks")
"""Packages beside it, run from a checkout; `symbolic` is installed with it, as `origami_nlp.symbolic`."""
ROOMS = [name for name in ORDER if (PACKAGE / name).is_dir()]
LONGEST = 560  # lines of a file
HEAVY = ("casadi", "matplotlib", "sympy", "rich", "typer", "scipy", "shapely", "pandas")


class Import(NamedTuple):
    """`from module import name`, or `import module` (name is None)."""

    module: str
    name: str | None
    line: int


def dotted(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def modules(package: str) -> dict[str, Path]:
    """Modules of a package by their full name."""
    return {dotted(path): path for path in sorted((ROOT / package).rglob("*.py"))}


def imports_of(tree: ast.AST, inside: str = "") -> Iterator[Import]:
    """What code imports; relative imports are those of a package's `__init__`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            module = ".".join(filter(None, (inside if node.level else "", node.module)))
            yield from (Import(module, alias.name, node.lineno) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (Import(alias.name, None, node.lineno) for alias in node.names)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            if re.fullmatch(r"origami_nlp(\.\w+)+", node.value):  # for import_module and such
                yield Import(node.value, None, node.lineno)


@cache
def read(path: Path) -> tuple[tuple[Import, ...], tuple[tuple[str, int], ...]]:
    """What a file imports, and its classes with their lines: each file is parsed once."""
    tree = ast.parse(path.read_text())
    classes = ((n.name, n.lineno) for n in ast.walk(tree) if isinstance(n, ast.ClassDef))
    return tuple(imports_of(tree, dotted(path))), tuple(classes)


def imports(path: Path) -> tuple[Import, ...]:
    return read(path)[0]


@cache
def face(room: str) -> dict[str, str]:
    """Names of a room's face (``"paper.cone"``: of a room within a room) with the module that each comes from."""
    path = PACKAGE.joinpath(*room.split("."))
    stub = path / "__init__.pyi"
    source = stub if stub.exists() else path / "__init__.py"
    names = {}
    for item in imports(source):
        if item.module.startswith(f"origami_nlp.{room}") and item.name:
            whole = item.module == f"origami_nlp.{room}"  # `from . import name`: a module as such
            names[item.name] = f"{item.module}.{item.name}" if whole else item.module
    if source != stub:
        for node in ast.parse(source.read_text()).body:  # defined in the face itself
            targets = node.targets if isinstance(node, ast.Assign) else [node]
            own = (getattr(t, "id", getattr(t, "name", None)) for t in targets)
            names |= {name: f"origami_nlp.{room}" for name in own if name}
    return names


def room_of(module: str) -> str:
    """The room, or file at the root, of a module of the package; "" for the package itself."""
    return module.split(".")[1] if "." in module else ""


def entered(item: Import) -> str:
    """What an import enters: `from origami_nlp import kkt` enters the room."""
    whole = item.module == "origami_nlp" and item.name in ORDER
    return f"origami_nlp.{item.name}" if whole else item.module


def is_face(module: str) -> bool:
    """Whether a module is entered from outside as it is: a room, a room within a room, or any of `symbolic`."""
    stub = ROOT.joinpath(*module.split("."), "__init__.pyi")
    return module.count(".") < 2 or stub.exists() or room_of(module) == "symbolic"


def ours(path: Path) -> list[Import]:
    return [i for i in imports(path) if i.module.split(".")[0] == "origami_nlp"]


def test_every_room_has_its_place_in_the_order():
    found = {p.stem for p in PACKAGE.iterdir() if p.is_dir() or p.suffix == ".py"}
    assert found - {"__init__", "__pycache__"} == set(ORDER)


@pytest.mark.parametrize("room", ORDER)
def test_rooms_import_only_those_before_them_and_only_their_faces(room):
    before = ORDER[: ORDER.index(room)]
    paths = sorted((PACKAGE / room).rglob("*.py")) or [PACKAGE / f"{room}.py"]
    wrong = []
    for path in paths:
        for item in ours(path):
            module = entered(item)
            other = room_of(module)
            if other == room:
                continue
            where = f"{path.relative_to(PACKAGE)}:{item.line} imports {module} {item.name or ''}"
            if other not in before:
                wrong.append(f"{where}, which is not before it")
            elif not is_face(module):
                wrong.append(f"{where}, behind the face of {other}")
    assert not wrong, "\n".join(wrong)


def aim(item: Import, known: dict[str, Path]) -> str:
    """The module that an import ends at: where a face takes the name from, or the file itself."""
    if f"{item.module}.{item.name}" in known:
        return f"{item.module}.{item.name}"
    room = room_of(item.module)
    if room in ROOMS and item.module.count(".") == 1 and item.name:
        return face(room).get(item.name, item.module)
    return item.module


@pytest.mark.parametrize("package", ["origami_nlp", *BESIDE])
def test_modules_make_no_circle(package):
    known = modules(package)
    stubs = {
        m: p
        for m, p in known.items()
        if p.name == "__init__.py" and (p.parent / "__init__.pyi").exists()
    }
    graph = {
        name: {aim(i, known) for i in imports(path)} & set(known) - {name, *stubs}
        for name, path in known.items()
        if name not in stubs  # a lazy face imports nothing by itself
    }
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" <- ".join(error.args[1]))


@pytest.mark.parametrize("room", ROOMS)
def test_every_name_of_a_face_resolves(room):
    module = import_module(f"origami_nlp.{room}")
    names = face(room)
    assert names and set(names) <= set(dir(module))
    for name, source in names.items():
        one = import_module(source)
        assert getattr(module, name) in (getattr(one, name, one), one)  # one: `from . import name`


@pytest.mark.parametrize("room", ROOMS)
def test_no_name_of_a_face_hides_a_file(room):
    """A function named like its file is replaced by the module as soon as that is imported."""
    files = {path.stem for path in (PACKAGE / room).iterdir()}
    hidden = {n for n, source in face(room).items() if n in files and not source.endswith(f".{n}")}
    assert not hidden


@pytest.mark.parametrize("path", sorted((PACKAGE).rglob("__init__.pyi")), ids=dotted)
def test_a_face_is_a_stub_and_a_docstring(path):
    tree = ast.parse(path.with_suffix(".py").read_text())
    assert ast.get_docstring(tree)
    assert {i.module for i in imports_of(tree)} == {"lazy_loader"}


def behind(item: Import, own: str = "") -> str:
    """What is wrong with an import from outside a room: "" if it is of the package's face or of a room's."""
    module = entered(item)
    room = room_of(module)
    if item.module.split(".")[0] != "origami_nlp" or room == own != "":
        return ""
    if not is_face(module):
        return f"{module} is behind the face of {room}"
    if room and not (PACKAGE / room).is_dir() and not (PACKAGE / f"{room}.py").is_file():
        return f"there is no room {room}"
    inside = module.partition(".")[2]
    known = face(inside) if room in ROOMS else () if room else (*origami_nlp.__all__, "__version__")
    if item.name and module == item.module and known and item.name not in known:
        return f"{module} has no {item.name} in its face"
    return ""


def test_tests_look_behind_the_face_of_their_own_room_only():
    wrong = []
    for path in sorted((ROOT / "tests").rglob("*.py")):
        where = path.relative_to(ROOT / "tests")
        named = (
            item for item in ours(path) if item.name
        )  # strings may say what is replaced in a test
        wrong += [f"{where}:{i.line} {why}" for i in named if (why := behind(i, where.parts[0]))]
    assert not wrong, "\n".join(wrong)


def blocks(path: Path) -> Iterator[str]:
    """Python that a page or a notebook shows."""
    if path.suffix == ".ipynb":
        cells = nbformat.read(path, as_version=4).cells
        sources = [cell.source for cell in cells if cell.cell_type == "code"]
    else:
        sources = re.findall(r"^ *```python\n(.*?)^ *```", path.read_text(), flags=re.S | re.M)
    for source in sources:  # without prompts and commands of the notebook
        source = re.sub(r"^(>>>|\.\.\.) ?", "", textwrap.dedent(source), flags=re.M)
        yield re.sub(r"^[%!].*$", "", source, flags=re.M)


def readers() -> list[Path]:
    """What shows people how the package is called, and what stands beside it."""
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")]
    books = (ROOT / "notebooks").rglob("*.ipynb")
    beside = ("notebooks", *BESIDE)
    return sorted([*pages, *books, *(p for room in beside for p in (ROOT / room).rglob("*.py"))])


def test_only_faces_are_imported_from_outside():
    wrong = []
    for path in readers():
        if path.suffix == ".py":
            found = [*imports(path)]
        else:
            found = [i for source in blocks(path) for i in imports_of(ast.parse(source))]
        wrong += [f"{path.relative_to(ROOT)}: {why}" for i in found if (why := behind(i))]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("package", ["origami_nlp", *BESIDE, "tests"])
def test_files_read_in_one_sitting(package):
    long = {n: p for n, p in modules(package).items() if len(p.read_text().splitlines()) > LONGEST}
    assert not long


def test_no_two_classes_share_a_name():
    where: dict[str, list[str]] = {}
    for name, path in modules("origami_nlp").items():
        for one, line in read(path)[1]:
            where.setdefault(one, []).append(f"{name}:{line}")
    assert len(where) > 300 and not {name: at for name, at in where.items() if len(at) > 1}


def test_import_is_fast_and_light():
    code = (
        "import time, sys; t = time.process_time(); import origami_nlp; "
        "s = time.process_time() - t; from importlib import import_module; "
        f"[import_module('origami_nlp.' + room) for room in {ROOMS[:-1]}]; "
        f"print(s, sorted(set({HEAVY}) & set(sys.modules)))"
    )
    times = []
    for _ in range(3):  # the best of three: the machine may be busy
        out = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        seconds, heavy = out.split(maxsplit=1)
        assert heavy.strip() == "[]"
        times.append(float(seconds))
    assert min(times) < 0.5  # of processor time; 0.05 on a quiet machine


def test_public_names_exist():
    for name in origami_nlp.__all__:
        assert getattr(origami_nlp, name) is not None
    with pytest.raises(AttributeError):
        _ = origami_nlp.nothing
