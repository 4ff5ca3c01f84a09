"""Equations as MathML, made when the site is built: no script and no network when it is read."""

from __future__ import annotations

import html
import re

from latex2mathml.converter import convert
from mkdocs.exceptions import PluginError

_MATH = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)
_BAR = re.compile(r"<mo[^>]*>(?:&#x0007C;|\|)</mo>")


def _rendered(match: re.Match[str]) -> str:
    tag, bracket, latex = match.groups()
    latex = html.unescape(latex).strip()
    # bars are fences, not operators with space around them
    mathml = convert(latex, display="block" if bracket == "[" else "inline")
    mathml = _BAR.sub('<mo form="prefix" stretchy="false" lspace="0" rspace="0">|</mo>', mathml)
    if "\\" in mathml:  # latex2mathml passes a command on that it does not know
        raise PluginError(f"not all of this equation can be rendered: {latex}")
    return f'<{tag} class="math">{mathml}</{tag}>'


def on_page_content(content: str, **_: object) -> str:
    """Replace what pymdownx.arithmatex marked."""
    return _MATH.sub(_rendered, content)
