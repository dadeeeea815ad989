"""How a command ends: all exit codes."""

from enum import IntEnum


class Ended(IntEnum):
    """Exit codes, of every command."""

    DONE = 0
    """The answer is there; of what is checked: it holds."""
    NO = 1
    """What was asked does not hold: faults, a claim that is not confirmed, springs that cannot be, failed scenes."""
    WRONG = 2
    """A call, a file or a value that cannot be used: one line says which; nothing is written."""
    OPEN = 3
    """Of a design: neither found nor refuted."""
    FAULT = 70
    """A fault of ours (EX_SOFTWARE of sysexits.h); a report is written."""
    OUT_OF_TIME = 124
    """The time of ``--seconds`` was over, as of `timeout`; what is whole until then is written."""
    INTERRUPTED = 130
    """Ctrl-C, 128 + SIGINT; searches, paths, barriers and sweeps write what they found."""
    CLOSED_PIPE = 141
    """Who reads what is printed has gone, 128 + SIGPIPE."""
