"""Scenes as TOML files: read with every mistake named, written so that reading gives the same
scene.

The file is data: text angles go through `parse_angle`, nothing is evaluated.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_number, check_type, shown
from origami_nlp.errors import SceneFileError
from origami_nlp.io import as_text, check_tables, one_of, parse_toml, read_limited
from origami_nlp.numerics import INPUT_TOL
from origami_nlp.pattern.fold_limits import LIMIT_KEYS, stated_limits
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.hinge_tables import law_to_dict, read_law
from origami_nlp.pattern.numbers_read import format_angle, parse_angles
from origami_nlp.pattern.scene import Scene
from origami_nlp.pattern.vertex import Vertex

_KEYS: dict[str, tuple[str, ...]] = {
    "vertex": ("sector_angles", "sector_angles_deg", "flat", "normalize"),
    "creases": ("stiffness", "rest_angles", "rest_angles_deg", "preload", *LIMIT_KEYS, "law"),
    "model": (
        *("symmetry", "contact", "mirror", "name", "fixed_facet", "winding"),
        "symmetry_tolerance",
    ),
    "loads": (),
}
_LARGEST = 1_000_000  # bytes; a scene is a few hundred


def read_scene(source: str | Path) -> Scene:
    """Read a scene from a TOML file.

    Parameters
    ----------
    source
        The file, or ``"-"`` for standard input.

    Returns
    -------
    Scene
        The scene.

    Raises
    ------
    SceneFileError
        If the file cannot be read, is no TOML, or has unknown or missing keys.
    AngleError, VertexError, SceneError, SymmetryError
        If a value in it does not fit.

    Examples
    --------
    >>> import pathlib, tempfile, origami_nlp as o
    >>> path = pathlib.Path(tempfile.mkdtemp(), "scene.toml")
    >>> _ = path.write_text(o.format_scene(o.examples.degree8("pi/4")))
    >>> o.read_scene(path) == o.examples.degree8("pi/4")
    True
    """
    return decode_scene(read_limited(source, _LARGEST, "scene", SceneFileError), str(source))


def decode_scene(raw: bytes, name: str) -> Scene:
    """Read a scene from the bytes of a scene file.

    Parameters
    ----------
    raw
        The bytes.
    name
        Of the file, for messages and as title of reports.

    Returns
    -------
    Scene
        The scene.

    Raises
    ------
    SceneFileError, AngleError, VertexError, SceneError, SymmetryError
        As `read_scene`.
    """
    if len(raw) > _LARGEST:
        raise SceneFileError(f"scene {name!r} is larger than 1 MB: not a scene file")
    if is_json(raw):
        raise SceneFileError(f"scene {name!r} is JSON: `read_fold_scene` reads FOLD files")
    where = f"scene {name!r}"
    tables = parse_toml(as_text(raw, where, SceneFileError), where, SceneFileError)
    return scene_from_dict(tables, "standard input" if name == "-" else name)


def is_json(raw: bytes) -> bool:
    """Return whether bytes begin as a JSON object does, and no TOML file.

    Parameters
    ----------
    raw
        Of a file.

    Returns
    -------
    bool
        Whether the first letter, after a byte order mark and spaces, is a brace.
    """
    return raw.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{")


def parse_scene(text: str) -> Scene:
    """Read a scene from TOML text; the text is data, nothing in it is evaluated.

    Parameters
    ----------
    text
        Tables ``[vertex]``, ``[creases]`` and ``[model]``.

    Returns
    -------
    Scene
        The scene.

    Raises
    ------
    SceneFileError
        If the text is no TOML, or has unknown or missing keys.
    AngleError, VertexError, SceneError, SymmetryError
        If a value in it does not fit.

    Examples
    --------
    >>> from origami_nlp import parse_scene
    >>> scene = parse_scene('''
    ... [vertex]
    ... sector_angles_deg = [90, 90, 90, 90]
    ... [creases]
    ... stiffness = [1, 1, 1, 1]
    ... rest_angles_deg = [-90, 90, 90, 90]
    ... ''')
    >>> scene.degree, scene.group.name
    (4, 'D1')
    """
    if not isinstance(text, str):
        raise SceneFileError(f"text = {shown(text)} must be the text of a scene file")
    return scene_from_dict(parse_toml(text, "scene", SceneFileError))


def scene_from_dict(data: Mapping[str, Any], source: str = "") -> Scene:
    """Make a scene from the tables of a scene file (also the ``scene`` entry of our JSON).

    Parameters
    ----------
    data
        Tables ``vertex``, ``creases`` and ``model``, as `scene_to_dict` writes them.
    source
        What was read, see `Scene`.

    Returns
    -------
    Scene
        The scene.

    Raises
    ------
    SceneFileError
        For an unknown, missing or doubly given key.
    AngleError, VertexError, SceneError, SymmetryError
        If a value does not fit.
    """
    data = dict(data)
    of_laws = data.pop("laws", {})
    if "yield_torque" in (data.get("creases") or ()):
        raise SceneFileError("[creases] yield_torque is of a path: give it to load --yield")
    check_tables(data, _KEYS, "a scene has", SceneFileError, ("loads",))
    vertex, creases = vertex_from_dict(data.get("vertex", {})), data.get("creases", {})
    key = one_of(creases, "[creases]", ("rest_angles", "rest_angles_deg"), SceneFileError)
    in_degrees = key.endswith("_deg")
    rest = parse_angles(creases[key], key, degrees=in_degrees)
    for i, stated in enumerate(creases[key] if in_degrees else (), start=1):
        check_number(f"{key}[{i}]", stated, -180.0, 180.0, SceneFileError)
    if "stiffness" not in creases:
        raise SceneFileError("missing key in [creases]: give stiffness, one number a crease")
    more = stated_limits(creases, vertex.degree)
    if "law" in creases:
        more["laws"] = _laws(creases["law"], of_laws, vertex.degree, source)
    elif of_laws:
        raise SceneFileError("[laws] is not used: name one for each crease, [creases] law = [...]")
    more |= {k: table[k] for table, k in ((creases, "preload"), (data, "loads")) if k in table}
    more |= dict(data.get("model", {}))
    return Scene(vertex, creases["stiffness"], rest, source=source, **more)


def _laws(named: object, stated: object, degree: int, source: str) -> tuple[HingeLaw | None, ...]:
    """Read the laws of the creases by their names."""
    names = [named] * degree if isinstance(named, str) else named
    if not isinstance(names, list) or len(names) != degree or not isinstance(stated, Mapping):
        each = (
            f'the name of a table [laws.NAME], or one for each of {degree} creases, "" for a spring'
        )
        raise SceneFileError(f"[creases] law = {shown(named)} must be {each}")
    laws = {name: read_law(table, str(name), Path(source).parent) for name, table in stated.items()}
    if unknown := [name for name in names if name and name not in laws]:
        raise SceneFileError(f"[creases] law: there is no table [laws.{unknown[0]}]")
    return tuple(laws[name] if name else None for name in names)


def vertex_from_dict(table: Mapping[str, Any]) -> Vertex:
    """Make a vertex from the table ``vertex`` of a scene file.

    Parameters
    ----------
    table
        Sector angles, and whether the sheet is flat.

    Returns
    -------
    Vertex
        The vertex.

    Raises
    ------
    SceneFileError, AngleError, VertexError
        If a key is missing or doubly given, or a value does not fit.
    """
    given = one_of(table, "[vertex]", ("sector_angles", "sector_angles_deg"), SceneFileError)
    more = {key: table[key] for key in ("flat", "normalize") if key in table}
    return Vertex(table[given], **more, degrees=given.endswith("_deg"))


def scene_to_dict(scene: Scene) -> dict[str, Any]:
    """Write a scene as plain tables; `scene_from_dict` gives the same scene back.

    Parameters
    ----------
    scene
        The scene.

    Returns
    -------
    dict
        Tables ``vertex``, ``creases`` and ``model``; multiples of pi are text.

    Raises
    ------
    OptionError
        If `scene` is no scene.
    """
    check_type("scene", scene, Scene)
    own = {key: getattr(scene, key) for key in _KEYS["model"]}
    if scene.symmetry_tolerance == INPUT_TOL:
        del own["symmetry_tolerance"]
    names: dict[HingeLaw, str] = {}
    for law in filter(None, scene.laws):
        taken = [name for other, name in names.items() if other != law]
        names[law] = law.name if law.name not in taken else f"{law.name}-{len(names) + 1}"
    creases = {
        "stiffness": list(scene.stiffness),
        "rest_angles": [_exact(a) for a in scene.rest_angles],
        "preload": list(scene.preload),
        **dict(zip(LIMIT_KEYS[2:], scene.panels or (), strict=False)),
        "law": [names[law] if law else "" for law in scene.laws],
        "limits": [[_exact(a) for a in p] for p in scene.limits],
    }
    flat = {} if scene.vertex.flat else {"flat": False}
    tables = {
        "vertex": {"sector_angles": [_exact(a) for a in scene.vertex.sector_angles], **flat},
        "creases": {key: value for key, value in creases.items() if value not in ([], ())},
        "model": {key: value for key, value in own.items() if value is not None},
        "laws": {name: law_to_dict(law) for law, name in names.items()},
        "loads": [load.to_dict() for load in scene.loads],
    }
    return {name: table for name, table in tables.items() if table}


def format_scene(scene: Scene) -> str:
    """Write a scene as TOML text; `parse_scene` gives the same scene back.

    Parameters
    ----------
    scene
        The scene.

    Returns
    -------
    str
        The text of a scene file.

    Raises
    ------
    OptionError
        If `scene` is no scene.

    Examples
    --------
    >>> from origami_nlp import examples, format_scene
    >>> print(format_scene(examples.degree8("pi/4")).splitlines()[0])
    [vertex]
    """
    lines = []
    for name, content in scene_to_dict(scene).items():
        tables = [(f"[{name}]", content)]
        if name == "laws":
            tables = [(f"[laws.{_toml(law)}]", table) for law, table in content.items()]
        elif isinstance(content, list):
            tables = [(f"[[{name}]]", table) for table in content]
        for head, table in tables:
            lines += [head, *(f"{key} = {_toml(value)}" for key, value in table.items()), ""]
    return "\n".join(lines)


def _exact(angle: float) -> str | float:
    """Write a multiple of pi as text where it reads back to the very same number."""
    text = format_angle(angle)
    return text if "pi" in text and parse_angles([text], "")[0] == angle else angle


def _toml(value: Any) -> str:
    """Write a value; TOML has JSON's numbers, lists and texts, but for the letter DEL."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
