# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Gives what is compiled the docstrings of the stub, for help() and notebooks."""
import ast


def _members(node, classes):
    """Functions and properties of a class of the stub, with those of its bases there."""
    for base in node.bases:
        if isinstance(base, ast.Name) and base.id in classes:
            yield from _members(classes[base.id], classes)
    yield from (item for item in node.body if isinstance(item, ast.FunctionDef))


def _add(found, doc, append_doc):
    if doc is None:
        return
    if isinstance(found, property):
        found.__doc__ = doc
    elif not hasattr(found, "__code__"):
        append_doc(found, doc)


def add_docs(names, stub, append_doc):
    """names: those of the module; append_doc(function, text) does what Python cannot."""
    tree = ast.parse(stub.read_text(encoding="utf-8"))
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            _add(names[node.name], ast.get_docstring(node), append_doc)
    for name, node in classes.items():
        if name not in names or name == "Status":
            continue
        names[name].__doc__ = ast.get_docstring(node)
        for member in _members(node, classes):
            _add(vars(names[name]).get(member.name), ast.get_docstring(member), append_doc)
