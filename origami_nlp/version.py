"""The version, where every room can read it."""

__version__ = "2.0.0.dev0"
