from . import report as report
from .pinned import report_contacts as report_contacts
from .segments import SLOPE as SLOPE, STIFFNESS as STIFFNESS, flat_parts as flat_parts
