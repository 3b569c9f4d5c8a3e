# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The stub says what the module is: its names, docstrings, and the arguments of what is compiled. types_test.py
compares the rest."""
import ast
import inspect
import pathlib
import re

import edged

STUB = ast.parse(pathlib.Path(edged.__file__).with_name("__init__.pyi").read_text())
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}


def members_of(node):
    """With those that it inherits within the stub."""
    bases = [CLASSES[ast.unparse(base)] for base in node.bases if ast.unparse(base) in CLASSES]
    inherited = [member for base in bases for member in members_of(base)]
    return inherited + [member for member in node.body if isinstance(member, ast.FunctionDef)]


def definitions():
    """Every public class, function, method and property: its name, its node in the stub, what the module has."""
    for node in STUB.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, node, getattr(edged, node.name)
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            found = getattr(edged, node.name)
            yield node.name, node, found
            for member in members_of(node):
                yield f"{node.name}.{member.name}", member, getattr(found, member.name)


def help_of(found):
    return inspect.getdoc(found) or ""


def variables_of(node):
    """Each name that a module or class declares, with the docstring below it."""
    for variable, below in zip(node.body, [*node.body[1:], None]):
        if isinstance(variable, ast.AnnAssign):
            has_doc = isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant)
            yield ast.unparse(variable.target), inspect.cleandoc(below.value.value) if has_doc else None


def test_the_stub_names_what_the_module_exports():
    named = {name for name, _, _ in definitions() if "." not in name} | {name for name, _ in variables_of(STUB)}
    assert named == set(vars(edged)["__all__"])


def test_every_public_name_has_the_docstring_of_the_stub():
    for name, node, found in definitions():
        text = ast.get_docstring(node)
        assert text, f"{name} has no docstring in the stub"
        assert text in help_of(found), name
    for owner, node in ((edged, STUB), (edged.Status, CLASSES["Status"])):
        for name, text in variables_of(node):
            assert text, f"{name} has no docstring in the stub"
            assert f"{name}: {text}" in help_of(owner), name
    assert help_of(edged).startswith("Edged USLAM: ")


def test_a_text_is_written_once():
    for source in ("__init__.py", "_program.py"):
        tree = ast.parse(pathlib.Path(edged.__file__).with_name(source).read_text())
        again = {node.name for node in tree.body if isinstance(node, ast.FunctionDef) and ast.get_docstring(node)}
        assert not again & {name for name, _, _ in definitions()}, source


def test_every_argument_of_what_is_compiled_is_in_the_stub_with_its_default():
    count = 0
    for name, node, found in definitions():
        if not isinstance(node, ast.FunctionDef) or isinstance(found, property) or inspect.isfunction(found):
            continue
        count += 1
        signature = found.__doc__.splitlines()[0]
        given = node.args.args
        assert re.findall(r"[(, ](\w+): ", signature) == [argument.arg for argument in given], (name, signature)
        with_default = given[len(given) - len(node.args.defaults):]
        for argument, default in zip(with_default, node.args.defaults):
            wanted = rf"\b{argument.arg}: [^=:]* = {re.escape(ast.unparse(default))}[,)]"
            assert re.search(wanted, signature), (name, argument.arg)
    assert count > 30
