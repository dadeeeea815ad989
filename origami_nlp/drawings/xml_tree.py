"""XML as a tree, from anybody: no entity is defined or expanded, nothing is fetched."""

from __future__ import annotations

from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from origami_nlp.errors import DrawingError

DEEPEST = 500
"""Elements within each other."""


def parse_xml(raw: bytes, name: str) -> Element:
    """Return the root of an XML document; tags come without their namespaces.

    Parameters
    ----------
    raw
        The file.
    name
        How messages call it.

    Returns
    -------
    Element
        The root.

    Raises
    ------
    DrawingError
        If it is no XML, defines an entity, or is nested too deeply.

    Examples
    --------
    >>> parse_xml(b'<svg xmlns="http://www.w3.org/2000/svg"><g/></svg>', "it")[0].tag
    'g'
    """
    builder, depth = TreeBuilder(), 0
    parser = expat.ParserCreate(namespace_separator="}")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise DrawingError(f"{name} has more than {DEEPEST} elements within each other")
        builder.start(_local(tag), {_local(k): v for k, v in attributes.items()})

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(_local(tag))

    def refuse(*_: object) -> NoReturn:
        raise DrawingError(f"{name} defines XML entities, which can hide anything: save it anew")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(raw, True)
    except expat.ExpatError as error:
        raise DrawingError(f"{name} is not valid XML: {error}") from None
    except (LookupError, ValueError) as error:  # an unknown encoding
        if isinstance(error, DrawingError):
            raise
        raise DrawingError(f"{name} is not valid XML: {error}") from None
    return builder.close()


def _local(tag: str) -> str:
    return tag.rpartition("}")[2]
