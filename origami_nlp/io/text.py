"""Text that users and files give, made safe to show: a name must not steer the terminal that prints it."""

from __future__ import annotations

_SHOWN: dict[int, str] = {
    **{code: chr(0x2400 + code) for code in range(32)},  # pictures of the control characters
    127: "\u2421",
    # C1 controls, line separators, marks that turn the direction of writing, halves of surrogate pairs
    **dict.fromkeys(
        (*range(0x80, 0xA0), 0x200E, 0x200F, *range(0x2028, 0x202F), *range(0x2066, 0x206A)),
        "\ufffd",
    ),
    **dict.fromkeys(range(0xD800, 0xE000), "\ufffd"),
}
_BUT_LINES = {code: shown for code, shown in _SHOWN.items() if code not in (9, 10)}


def printable(text: str, *, lines: bool = False) -> str:
    r"""Return a text with each control character replaced by a visible one, such as U+241B for escape.

    Parameters
    ----------
    text
        Of a user or a file.
    lines
        Keep line ends and tabs.

    Returns
    -------
    str
        As many characters.

    Examples
    --------
    >>> from origami_nlp.io import printable
    >>> printable("\x1b[2J")
    '␛[2J'
    """
    return text.translate(_BUT_LINES if lines else _SHOWN)


def is_unicode(text: str) -> bool:
    """Return whether a text can be written as UTF-8: half of a surrogate pair is no character.

    Parameters
    ----------
    text
        The text.

    Returns
    -------
    bool
        Whether it can.
    """
    return not any(0xD800 <= ord(c) < 0xE000 for c in text)


def is_number(text: str) -> bool:
    """Return whether a text is a number, as Python reads it.

    Parameters
    ----------
    text
        The text.

    Returns
    -------
    bool
        Whether it is.
    """
    try:
        float(text)
    except ValueError:
        return False
    return True
