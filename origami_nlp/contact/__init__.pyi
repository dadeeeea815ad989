from . import report as report
from .pinned import report_contacts as report_contacts
from .segments import (
    SLOPE as SLOPE,
    STIFFNESS as STIFFNESS,
    find_segments as find_segments,
    flat_parts as flat_parts,
)
