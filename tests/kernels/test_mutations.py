"""Tests see central lines of the kernel that are made wrong."""

import pytest

from tests.kernels.mutations import MUTATIONS, Mutation, caught


def test_each_line_stands_once_in_the_package() -> None:
    for mutation in MUTATIONS:
        assert mutation.wrong in mutation.source


@pytest.mark.slow
@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda m: m.wrong)
def test_a_test_of_the_room_fails(mutation: Mutation) -> None:
    assert caught(mutation)[0]
