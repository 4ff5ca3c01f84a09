"""The Python of the how-to pages that needs no part runs, and gives the numbers in its comments."""

import re
from pathlib import Path

import numpy as np
import pytest

HOWTO = Path(__file__).resolve().parents[2] / "docs" / "howto"


@pytest.mark.parametrize("page", ["python.md", "full_camera_model.md"])
def test_snippets_run_and_give_what_their_comments_say(page):
    blocks = re.findall(r"```python\n(.*?)```", (HOWTO / page).read_text(encoding="utf-8"), flags=re.DOTALL)
    names: dict[str, object] = {}
    exec("import viewgauge as vg", names)
    checked = 0
    for block in blocks:
        if "inspection" in block:
            continue
        exec(block, names)
        for line in block.splitlines():
            stated = re.fullmatch(r"(vg\.success_probability\(.*\)) +# ([\d. ]+)", line)
            if stated:
                expected = [float(number) for number in stated[2].split()]
                # a digit more than is printed; quasi-Monte Carlo is right to 1e-3
                tolerance = 1e-3 if "monte-carlo" in line else 6e-6
                np.testing.assert_allclose(np.atleast_1d(eval(stated[1], names)), expected, atol=tolerance)
                checked += 1
    assert checked >= 2
