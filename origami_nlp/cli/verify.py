"""`origami-nlp verify`: prove or refute every claim of the paper."""


def verify() -> None:
    """Prove or refute every claim of the source paper."""
    raise SystemExit("not built yet")
