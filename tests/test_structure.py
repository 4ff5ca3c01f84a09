"""The structure that the house rules ask for, beside the import contracts: seams in sight, rooms not crowded."""

from __future__ import annotations

import ast
from collections import defaultdict
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import grimp
import pytest

SOURCE = Path(__file__).parents[1] / "src" / "viewgauge"
MODULES = sorted(SOURCE.rglob("*.py"))

MOST_FILES, MOST_LINES, MOST_PARAMETERS = 15, 80, 8

LONG = {
    "planning/bounds/box_bounds.py: _box": "one compiled loop whose steps share thirty intervals",
}
MANY = {
    "cli/": "a parameter of a command is an option of the command line",
    "errors/independent/ratio_sum.py: evaluate_laws": "compiled as a generalized ufunc: numba knows no objects",
    "formats/tables/row_text.py: _write_rows": "compiled: numba knows no objects to group the arrays in",
    "jobs/evaluate.py: evaluate_into": "public, with options by keyword",
    "jobs/images/simulate.py: simulate": "public, with options by keyword",
    "jobs/images/validate.py: validate": "public, with options by keyword",
    "jobs/planning/plan.py: plan": "public, with options by keyword",
    "planning/cover/dominance.py: _sift": "compiled: numba knows no objects to group the arrays in",
}
"""Exceptions, with their reasons: a function, or all of a folder."""


def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def functions():
    for path in MODULES:
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield path.relative_to(SOURCE).as_posix(), node


def is_compiled(node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Compiled loops take arrays one by one: numba knows no objects to group them in."""
    return any("njit" in ast.unparse(d) or "vectorize" in ast.unparse(d) or "_inlined" in ast.unparse(d)
               for d in node.decorator_list)  # fmt: skip


def test_nothing_is_imported_by_name_but_public_names():
    """A contract sees no import by a string; only the lazy public names of the package itself are found so."""
    found = []
    for path in MODULES:
        names = {"import_module", "__import__", "attach", "attach_stub", "run_module"}
        for node in ast.walk(tree(path)):
            called = node.func if isinstance(node, ast.Call) else None
            name = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
            if name in names:
                found.append(path.relative_to(SOURCE).as_posix())
    assert found == ["__init__.py"]


def test_no_module_imports_itself_by_way_of_others():
    """Imports for type checkers count too."""
    graph = grimp.build_graph("viewgauge", cache_dir=None)
    arrows = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    try:
        TopologicalSorter(arrows).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(reversed(error.args[1])))


def test_no_folder_is_crowded():
    crowded = {
        folder.relative_to(SOURCE).as_posix(): count
        for folder in {path.parent for path in MODULES}
        if (count := len(list(folder.glob("*.py")))) > MOST_FILES
    }
    assert not crowded


def test_every_folder_says_what_lives_there():
    silent = [path for path in MODULES if path.name == "__init__.py" and len(ast.get_docstring(tree(path)) or "") < 40]
    assert not silent


def test_no_function_is_long():
    long = {
        f"{path}: {node.name}": node.end_lineno - node.lineno + 1
        for path, node in functions()
        if node.end_lineno - node.lineno + 1 > MOST_LINES
    }
    assert long.keys() == LONG.keys(), long


def test_no_function_has_many_parameters():
    many = {}
    for path, node in functions():
        a = node.args
        names = [argument.arg for argument in (*a.posonlyargs, *a.args, *a.kwonlyargs)]
        count = len([name for name in names if name not in ("self", "cls")])
        if count > MOST_PARAMETERS and not is_compiled(node):
            many[f"{path}: {node.name}"] = count
    excused = {name for name in many if any(name.startswith(key) for key in MANY)}
    assert not many.keys() - excused, {name: many[name] for name in many.keys() - excused}
    assert all(any(name.startswith(key) for name in many) for key in MANY), "an exception that nothing needs"


def test_no_two_modules_of_a_room_have_one_name():
    """Within a top-level folder, where a reader has several open together."""
    of = defaultdict(list)
    for path in MODULES:
        room, *_ = path.relative_to(SOURCE).parts
        if path.name != "__init__.py":
            of[room, path.name].append(path)
    assert not {key: paths for key, paths in of.items() if len(paths) > 1}


def test_no_two_public_classes_have_one_name():
    of = defaultdict(list)
    for path in MODULES:
        for node in tree(path).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                of[node.name].append(path.relative_to(SOURCE).as_posix())
    assert not {name: paths for name, paths in of.items() if len(paths) > 1}
