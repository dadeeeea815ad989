"""Actuation."""
