"""`origami-nlp paper`: the study of the source paper; its commands are registered here."""

from __future__ import annotations

from origami_nlp.cli.audit import audit
from origami_nlp.cli.demo import demo
from origami_nlp.cli.grid import grid
from origami_nlp.cli.group import Group
from origami_nlp.cli.panels import panels
from origami_nlp.cli.reproduce import reproduce
from origami_nlp.cli.verify import verify

PAPER = (demo, panels, reproduce, verify, audit, grid)

paper = Group("The source paper: its 18 panels, figures, equations and published states.")
paper.add(*PAPER)
