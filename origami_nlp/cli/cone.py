"""`origami-nlp cone`: uniform vertices of any even degree; its commands are registered here."""

from __future__ import annotations

from origami_nlp.cli.cone_branch import branch
from origami_nlp.cli.cone_count import count
from origami_nlp.cli.cone_draw import draw
from origami_nlp.cli.cone_foldings import foldings
from origami_nlp.cli.cone_full import full
from origami_nlp.cli.cone_limits import limits
from origami_nlp.cli.cone_phase import phase
from origami_nlp.cli.cone_section5 import fractions
from origami_nlp.cli.cone_speed import speed
from origami_nlp.cli.group import Group

cone = Group("Cones (uniform vertices of even degree): branches, their minima, different foldings.")
cone.add(count, foldings, branch, draw, phase, fractions, full, limits, speed)
