"""Checks that several test files make of claims.

That every claim is decided, and that damaged statements are refuted, is tested for the whole catalogue in
test_catalogue.py and test_mutations.py.
"""


def accepts(claim, corrected):
    """A claim that fails as printed is proved when its corrected statement is put in its place."""
    assert claim.decide().verdict in ("refuted", "convention")
    assert claim.decide(corrected).verdict == "proved"
