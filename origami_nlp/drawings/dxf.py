"""DXF in and out, by `ezdxf`: what a line is says its layer, then its colour.

Old ORIPA drew mountains blue and valleys red, new ORIPA and Oriedita the other way round, all on layers of the
same names: so layers come first.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable
from typing import Any

from origami_nlp.arguments import require
from origami_nlp.drawings.lines import DrawingOptions, LineList, Lines
from origami_nlp.errors import DrawingError

LAYERS = (
    (r"mountain|^mt?n?$", "M"),
    (r"valley|^v(ly)?$", "V"),
    (r"^cut[ _-]?line$|border|outline|contour|boundary|edge", "B"),
    (r"cut|slit", "C"),
    (r"aux|flat|facet", "F"),
    (r"unassigned|^u$", "U"),
)
"""What a layer is, by a part of its name; the first that fits."""
COLOURS = {1: "M", 5: "V", 7: "B", 250: "B", 3: "B", 4: "F"}
"""What a colour of AutoCAD's index is: as the newer programs have them."""
INSUNITS = {1: "in", 4: "mm", 5: "cm", 6: "m"}


def read_dxf(raw: bytes, name: str, options: DrawingOptions) -> Lines:
    """Read the lines and polylines of a DXF drawing; those of blocks are left out and counted.

    Parameters
    ----------
    raw
        The file.
    name
        How messages call it.
    options
        What else is known of it; layers and colours are names here, such as ``"colour 1"``.

    Returns
    -------
    Lines
        In the drawing's units.

    Raises
    ------
    DrawingError
        If it is no DXF, has no line whose letter is known, curves that nothing was said of, or `ezdxf` is not there.
    """
    ezdxf = require("ezdxf", "DXF", "dxf", DrawingError)
    from ezdxf import path, recover

    try:
        document, _ = recover.read(io.BytesIO(raw))
    except (ezdxf.DXFError, OSError, ValueError, LookupError, TypeError, AttributeError) as error:
        why = str(error).splitlines()[0] if str(error) else repr(error)
        raise DrawingError(f"{name} is no DXF file: {why}") from None
    found = LineList(name, options)
    for entity in document.modelspace():
        kind = entity.dxftype()
        if kind not in ("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"):
            found.left_out[kind] += 1
            continue
        letter = _letter(found, entity, document)
        if letter is None:
            continue
        drawn = path.make_path(entity)
        curves = sum(command.type.name != "LINE_TO" for command in drawn.commands())
        found.left_out["curves"] += curves
        if not curves:
            points = [(p.x, p.y) for p in drawn.control_vertices()]
            found.add(points, letter, math.nan, f"in a {kind} of layer {entity.dxf.layer!r}")
    found.length_unit = INSUNITS.get(document.header.get("$INSUNITS", 0), "")
    return found.lines("layers and colours", y_down=False)


def _letter(found: LineList, entity: Any, document: Any) -> str | None:
    layer, colour = entity.dxf.layer, entity.dxf.color
    by_name = next((letter for part, letter in LAYERS if re.search(part, layer, re.I)), None)
    if by_name is not None or found.is_asked(layer):
        return found.letter(layer, by_name)
    if colour == 256 and layer in document.layers:  # as its layer has it
        colour = document.layers.get(layer).color
    return found.letter(f"colour {abs(colour)}", COLOURS.get(abs(colour)))


def dxf_text(layers: dict[str, int], unit: str, draw: Callable[[Any], None]) -> str:
    """Return a DXF document as text, without the date: equal drawings are equal files.

    layers: their colours.  unit: of `INSUNITS`, or "".  draw: what draws in the model space.
    """
    ezdxf = require("ezdxf", "DXF", "dxf", DrawingError)
    from ezdxf.appsettings import update_extents

    codes = {name: code for code, name in INSUNITS.items()}
    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        document = ezdxf.new("R2000", units=codes.get(unit, 0))
        for name, colour in layers.items():
            document.layers.add(name, color=colour)
        space = document.modelspace()
        draw(space)
        # programs that place a drawing by its extents (LibreOffice) show nothing without them
        box = update_extents(document)
        space.reset_limits(box.extmin.vec2, box.extmax.vec2)
        text = io.StringIO()
        document.write(text)
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before
    return text.getvalue()
