"""Derivation and verification of every closed form of the source paper, in SymPy."""
