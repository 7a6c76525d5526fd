"""Properties are tried on the same examples in every run; ``--hypothesis-profile=random`` draws new ones."""

from hypothesis import settings

settings.register_profile("fixed", derandomize=True)
settings.register_profile("random", derandomize=False)
settings.load_profile("fixed")
