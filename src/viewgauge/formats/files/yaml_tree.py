"""YAML as plain Python values, with the line of every key: no object is ever constructed."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from .problems import KeyPath, Problems
from .text import unusable_character

__all__ = ["YamlTree", "parse_yaml"]

_LIST_WITH_UNIT = re.compile(r"(\[[^\[\]]*\])[ \t]*([^\W\d_]+|[%°‰])")

_INTEGER, _FLOAT, _BOOLEAN, _NULL, _TEXT, _TIMESTAMP = (
    f"tag:yaml.org,2002:{name}" for name in ("int", "float", "bool", "null", "str", "timestamp")
)
_MOST_INTEGER = 10**30
_COLLECTIONS = {"tag:yaml.org,2002:map", "tag:yaml.org,2002:seq"}


@dataclass
class YamlTree:
    """Values of a YAML document: dicts, lists, str, int, float, bool, None; and the line of each by its path."""

    value: object = None
    lines: dict[KeyPath, int] = field(default_factory=dict)


def parse_yaml(text: str, problems: Problems) -> YamlTree:
    """Values and lines of a YAML document; what is wrong with it goes to ``problems`` (value None if unreadable)."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError
    from ruamel.yaml.reader import ReaderError

    tree = YamlTree()
    problems.lines = tree.lines
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    try:
        node = YAML(typ="safe", pure=True).compose(text)
        tree.value = None if node is None else _Walker(tree, problems).value(node, ())
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = None if mark is None else min(mark.line + 1, text.count("\n") + 1)
        context = f" {error.context}" if error.context else ""
        problems.add((), f"not valid YAML: {error.problem}{context}", line=line, hint=_syntax_hint(text, line))
    except ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        problems.add((), "not valid YAML: a control character", line=line, got=repr(text[error.position]))
    except RecursionError:
        problems.add((), "not usable YAML: nested too deeply", line=1)
    except YAMLError as error:
        problems.add((), f"not valid YAML: {error}", line=1)
    return tree


def _syntax_hint(text: str, line: int | None) -> str | None:
    if line is None:
        return None
    lines = text.split("\n")
    if "\t" in lines[line - 1]:
        return "indent with spaces, not with tabs"
    for candidate in (line, line - 1):  # a parser may see the unit only on the next line
        match = _LIST_WITH_UNIT.search(lines[candidate - 1]) if candidate >= 1 else None
        if match:
            return f'write a list with its unit in quotes: "{match[1]} {match[2]}"'
    return None


class _Walker:
    """Turns the composed nodes into plain values."""

    def __init__(self, tree: YamlTree, problems: Problems) -> None:
        self.tree = tree
        self.problems = problems
        self.seen: set[int] = set()

    def value(self, node: object, path: KeyPath) -> object:
        from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

        assert isinstance(node, Node)
        line = node.start_mark.line + 1
        self.tree.lines.setdefault(path, line)
        if isinstance(node, ScalarNode):
            return self._scalar(node.tag, node.value, path)
        if str(node.tag) not in _COLLECTIONS:
            self.problems.add(path, "tags are not used here", got=str(node.tag), expected="a plain value")
            return None
        if id(node) in self.seen:  # also keeps a small file from becoming an endless tree
            self.problems.add(path, "an alias of a list or of a section is not used here", hint="write it out")
            return None
        self.seen.add(id(node))
        if isinstance(node, MappingNode):
            return self._mapping(node.value, path)
        assert isinstance(node, SequenceNode)
        return [self.value(item, (*path, index)) for index, item in enumerate(node.value)]

    def _mapping(self, pairs: list[tuple[object, object]], path: KeyPath) -> dict[str, object]:
        from ruamel.yaml.nodes import ScalarNode

        result: dict[str, object] = {}
        for key_node, value_node in pairs:
            if not isinstance(key_node, ScalarNode):
                line = key_node.start_mark.line + 1  # type: ignore[attr-defined]  # every node has one
                self.problems.add(path, "a key must be a word", line=line)
                continue
            key, line = str(key_node.value), key_node.start_mark.line + 1
            if (wrong := unusable_character(key)) is not None:
                self.problems.add(path, f"a key holds {wrong}", line=line, got=ascii(key))
                continue
            here = (*path, key)
            if key in result:
                first = self.tree.lines[here]
                self.problems.add(here, f"the key is there twice, first in line {first}", line=line, hint="remove one")
                continue
            self.tree.lines[here] = line
            result[key] = self.value(value_node, here)
        return result

    def _scalar(self, tag: object, text: str, path: KeyPath) -> object:
        name = str(tag)
        if name == _NULL:
            return None
        if name == _BOOLEAN:
            return text.lower() == "true"
        if name == _INTEGER:
            number = _integer(text)
            if isinstance(number, int) and abs(number) <= _MOST_INTEGER:
                return number
            got = text if len(text) <= 60 else f"{text[:40]}... ({len(text)} characters)"
            self.problems.add(path, "the whole number is too large", got=got, expected=f"at most {_MOST_INTEGER:.0e}")
            return None
        if name == _FLOAT:
            return float(text.replace("_", "").replace(".inf", "inf").replace(".nan", "nan"))
        if name not in (_TEXT, _TIMESTAMP):
            self.problems.add(path, "tags are not used here", got=name, expected="a plain value")
            return None
        if (wrong := unusable_character(text)) is not None:
            self.problems.add(path, f"the text holds {wrong}", got=ascii(text), expected="text that UTF-8 can write")
            return None
        return text


def _integer(text: str) -> int | str:
    for base in (10, 0):
        try:
            return int(text, base)
        except ValueError:
            continue
    return text
