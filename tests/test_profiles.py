"""How property tests draw: the same examples in the normal tests, random ones with the long studies."""

from hypothesis import settings


def test_the_profile_follows_the_marker(request):
    random = request.config.option.markexpr == "slow"
    if not request.config.option.hypothesis_profile:
        assert settings().derandomize is not random
