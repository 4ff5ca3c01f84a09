"""Viewpoints of the whole suite."""

import os

import pytest
from hypothesis import settings

# On a CI machine property tests draw the same examples each time: a red run is then the change's doing. Elsewhere
# they go on looking for new ones. None has a deadline: the first call of compiled code compiles it.
settings.register_profile("ci", derandomize=True, print_blob=True, deadline=None)
settings.register_profile("search", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "search")

# Files that take longest, the longest first: the last worker to end is then not one that began a long file last.
LONGEST_FIRST = (
    "jobs/test_stopped_jobs.py",
    "test_benchmarks.py",
    "jobs/test_streaming.py",
    "jobs/test_validate.py",
    "jobs/test_example_plan.py",
    "jobs/test_execution.py",
    "web/test_workbench.py",
    "evaluation/test_camera_errors.py",
    "jobs/test_averaging_search.py",
    "cli/test_cli.py",
    "planning/test_probability_bound.py",
    "jobs/test_measure.py",
)


def pytest_configure(config: pytest.Config) -> None:
    """Files go to workers in the order below, not those of most tests first, which are quick ones."""
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long files first."""
    rank = {name: k for k, name in enumerate(LONGEST_FIRST)}
    items.sort(key=lambda item: rank.get(item.nodeid.partition("::")[0].removeprefix("tests/"), len(rank)))
