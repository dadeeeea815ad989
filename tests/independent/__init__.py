"""A second formulation of folding, closure, contact and minima, against which the package is tested.

Nothing here imports the rooms that model, solve or judge (`problem`, `kkt`, `minima`): rotation matrices
instead of quaternions, the full vertex with tied fold angles instead of wedges, orientation tests and
explicit insertion of layers instead of separating planes and boolean tables.
"""
