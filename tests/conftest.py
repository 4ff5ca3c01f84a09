"""Settings of the whole suite."""

import os

from hypothesis import settings

# On a CI machine property tests draw the same examples each time: a red run is then the change's doing. Elsewhere
# they go on looking for new ones.
settings.register_profile("ci", derandomize=True, print_blob=True)
if os.environ.get("CI"):
    settings.load_profile("ci")
