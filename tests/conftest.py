import os

from hypothesis import settings

settings.register_profile("long", max_examples=3000, deadline=None)
settings.register_profile("normal", deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "normal"))
