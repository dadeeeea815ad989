"""The style that our figures share."""

from __future__ import annotations


def plain(text: str) -> str:
    """Text that matplotlib does not take for a formula."""
    pretty = (
        text.replace("alpha_1", "α₁").replace("r_k", "rₖ").replace("*pi", "π").replace("pi/", "π/")
    )
    return pretty.replace("$", r"\$")
