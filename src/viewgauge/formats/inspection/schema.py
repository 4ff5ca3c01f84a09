"""The inspection file's JSON Schema, made of the sections' models: what editors complete and other programs check."""

from __future__ import annotations

from typing import Any, TypeVar

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from .camera_section import CalibratedCameraSection, CameraSection
from .sections import InspectionSections
from .values import QUANTITIES, Apart, Elsewhere, Schema

__all__ = ["inspection_schema"]

_Mark = TypeVar("_Mark")


def inspection_schema() -> Schema:
    """The schema (draft 7) of an inspection file as any YAML parser reads it.

    A file that is right by it may still be found wrong: it says little of how values relate to each other.
    """
    whole = {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Inspection file of viewgauge",
        "description": "What is inspected, with which camera, how well its pose is known, and what is required.",
        **_section_schema(InspectionSections),
    }
    referring: Schema = _with_references(whole)
    definitions = {name: _with_references(schema, within=name) for name, schema in sorted(QUANTITIES.items())}
    return {**referring, "definitions": definitions}


def _section_schema(model: type[BaseModel]) -> Schema:
    if model is CameraSection:
        calibrated, stated = _keys_schema(CalibratedCameraSection), _keys_schema(CameraSection)
        return {"type": "object", "if": {"required": ["calibration"]}, "then": calibrated, "else": stated}
    return _keys_schema(model)


def _keys_schema(model: type[BaseModel]) -> Schema:
    schema = model.model_json_schema()
    properties = {
        name: _key_schema(field, schema["properties"][name])
        for name, field in model.model_fields.items()
        if _mark(field, Elsewhere) is None
    }
    rest = {key: value for key, value in schema.items() if key not in ("title", "description", "properties", "type")}
    return {"type": "object", "properties": properties, **rest}


def _key_schema(field: FieldInfo, own: Schema) -> Schema:
    """The schema of a key: its section's where that is read apart, else that of its value."""
    described = {"title": own["title"].capitalize(), "description": _sentence(field.description or "")}
    apart = _mark(field, Apart)
    if apart is not None:
        section = _section_schema(apart.section)
        if apart.listed:
            return {**described, "type": "array", "items": section}
        return {**described, **section, "type": ["object", "null"] if apart.optional else "object"}
    value = {key: rest for key, rest in own.items() if key not in ("title", "description", "default")}
    options = [option for option in value.get("anyOf", ()) if option != {"type": "null"}]  # null: the key is absent
    if len(options) == 1:
        value = options[0]
    elif options:
        value["anyOf"] = options
    if value in QUANTITIES.values():
        return {**described, "allOf": [value]}  # beside a reference nothing else counts
    return {**described, **value}


def _with_references(value: Any, within: str | None = None) -> Any:
    """A schema with each quantity as a reference to its definition, except where it is that definition."""
    if isinstance(value, list):
        return [_with_references(item) for item in value]
    if not isinstance(value, dict):
        return value
    for name, schema in QUANTITIES.items():
        if value == schema and name != within:
            return {"$ref": f"#/definitions/{name}"}
    return {key: _with_references(item) for key, item in value.items()}


def _mark(field: FieldInfo, kind: type[_Mark]) -> _Mark | None:
    marks: list[Any] = field.metadata
    return next((mark for mark in marks if isinstance(mark, kind)), None)


def _sentence(text: str) -> str:
    """A description with a capital and a full stop."""
    return text[:1].upper() + text[1:].rstrip(".") + "."
