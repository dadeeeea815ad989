"""A second formulation of folding, closure, contact and minima, against which the package is tested.

Nothing here imports `origami_nlp.model`, `solve` or `judge`: rotation matrices instead of
quaternions, the full vertex with tied fold angles instead of wedges, orientation tests and explicit
insertion of layers instead of separating planes and boolean tables.
"""
