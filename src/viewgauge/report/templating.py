"""HTML from the files in ``templates/``: all text is escaped there, unless it is markup already."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from .wording import DASH, length, probability, rounded

__all__ = ["Markup", "render", "render_page", "verbatim"]


def render(template: str, **values: Any) -> Markup:
    """A template filled in; a name that it uses and is not given is an error."""
    return Markup(_environment().get_template(template).render(values))


def render_page(template: str, data: Any, **values: Any) -> str:
    """A whole page: a template that extends ``base.html``, with its data as JSON and Plotly's own script."""
    from plotly.offline import get_plotlyjs  # here: 5 MB that only a page needs

    return str(render(template, data=_json(data), plotly=Markup(get_plotlyjs()), **values))


def verbatim(name: str) -> Markup:
    """A style or script file that stands beside the templates, as it is."""
    return Markup(files(__package__).joinpath("templates", name).read_text(encoding="utf-8"))


def _json(data: Any) -> Markup:
    """JSON that cannot end the script element it stands in, whatever strings it holds."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e"))


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader(__package__ or "", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals.update(dash=DASH, verbatim=verbatim)
    environment.filters.update(
        probability=probability,
        mm=length,
        rounded=rounded,
        digits=lambda value: repr(float(value)),
        tenths=lambda value: f"{value:.1f}",
    )
    return environment
