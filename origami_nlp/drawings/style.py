"""How an SVG says what a line looks like: colours, attributes, style sheets, and what groups hand down."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import suppress
from xml.etree.ElementTree import Element

SIMULATOR_COLOURS = {
    "#000000": "B",
    "#ff0000": "M",
    "#0000ff": "V",
    "#00ff00": "C",
    "#ffff00": "F",
    "#ff00ff": "U",
    "#808080": "F",
    "#888888": "F",
}
"""Of Origami Simulator (js/pattern.js), and the gray with which Flat-Folder and Rabbit Ear draw flat lines."""
LOOKS = ("stroke", "stroke-opacity", "opacity", "display", "visibility")
INHERITED = ("stroke", "stroke-opacity", "visibility")
"""Properties that are read, and those of them that groups hand down; opacity is the element's own."""
_SELECTOR = re.compile(r"([.#]?)([\w-]+|\*)")

Declarations = dict[str, str]


def canonical_colour(text: str) -> str:
    """Return a colour as ``#rrggbb``, whichever way CSS writes it; what is none, as it is.

    Examples
    --------
    >>> canonical_colour("RGB(255, 0,0)"), canonical_colour("#0f0"), canonical_colour("url(#a)")
    ('#ff0000', '#00ff00', 'url(#a)')
    """
    from matplotlib.colors import CSS4_COLORS, to_hex

    colour = re.sub(r"\s+", "", text).lower()
    with suppress(ValueError):
        if found := re.fullmatch(r"rgba?\(([\d.]+%?),([\d.]+%?),([\d.]+%?)(,[\d.]+%?)?\)", colour):
            shares = (
                float(p.replace("%", "")) * (2.55 if "%" in p else 1) for p in found.groups()[:3]
            )
            return "#" + "".join(f"{min(round(p), 255):02x}" for p in shares)
        if colour.startswith("#") or colour in CSS4_COLORS:
            return to_hex(colour)
    return colour


def declarations(text: str) -> Declarations:
    """Return what a style attribute, or the body of a rule, says of the properties that are read."""
    found = {}
    for one in _bare(text).split(";"):
        key, _, value = one.partition(":")
        if (key := key.strip().lower()) in LOOKS:
            found[key] = re.sub(r"!\s*important", "", value).strip()
    return found


def _bare(text: str) -> str:
    """Return CSS without comments; in time that grows with its length."""
    first, *rest = text.split("/*")
    return first + "".join(part.partition("*/")[2] for part in rest)


class Sheet:
    """Rules of the style sheets of a file: selectors of one tag, class or id.

    Parameters
    ----------
    root
        Of the file.

    Attributes
    ----------
    left_out
        Selectors of other kinds.
    """

    def __init__(self, root: Element) -> None:
        self.rules: list[tuple[str, str, Declarations]] = []
        self.left_out: list[str] = []
        for style in root.iter("style"):
            text = _bare(style.text or "").replace("<!--", "").replace("-->", "")
            for rule in text.split("}")[:-1]:
                head, _, body = rule.rpartition("{")
                said = declarations(body)
                # after what imports, or stands around it
                selectors = head.rpartition("{")[2].rpartition(";")[2]
                for selector in selectors.split(",") if said else ():
                    if match := _SELECTOR.fullmatch(selector.strip()):
                        self.rules.append((match[1], match[2], said))
                    else:
                        self.left_out.append(" ".join(selector.split()))
        self.rules.sort(key=lambda rule: (" .#".index(rule[0] or " "), rule[1] != "*"))

    def look(self, element: Element, inherited: Mapping[str, str]) -> Declarations:
        """Return the look of an element, and what it inherits."""
        own = {key: element.attrib[key].strip() for key in LOOKS if key in element.attrib}
        names = {"": ("*", element.tag), "#": (element.get("id"),)}
        names["."] = tuple(element.get("class", "").split())
        for kind, name, said in self.rules:
            if name in names[kind]:
                own |= said
        own |= declarations(element.get("style", ""))
        own = {key: value for key, value in own.items() if value != "inherit"}
        return {key: inherited[key] for key in INHERITED if key in inherited} | own
