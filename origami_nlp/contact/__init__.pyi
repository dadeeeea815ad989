from .report import ContactReport as ContactReport, find_contacts as find_contacts
from .segments import find_segments as find_segments, flat_parts as flat_parts
from .symmetry_blocks import breaking_stiffnesses as breaking_stiffnesses
