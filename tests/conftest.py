"""Viewpoints of the whole suite."""

import os

from hypothesis import settings

# On a CI machine property tests draw the same examples each time: a red run is then the change's doing. Elsewhere
# they go on looking for new ones. None has a deadline: the first call of compiled code compiles it.
settings.register_profile("ci", derandomize=True, print_blob=True, deadline=None)
settings.register_profile("search", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "search")
