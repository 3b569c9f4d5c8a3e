# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Gives the module the docstrings of the stub, for help() and notebooks."""
import ast
import inspect


def _doc_of(node):
    """The docstring, and a paragraph for each variable that has one below it: a value cannot hold its own."""
    paragraphs = [ast.get_docstring(node) or ""]
    for variable, below in zip(node.body, node.body[1:]):
        if isinstance(variable, ast.AnnAssign) and isinstance(below, ast.Expr):
            paragraphs.append(f"{ast.unparse(variable.target)}: {inspect.cleandoc(ast.literal_eval(below.value))}")
    return "\n\n".join(paragraphs)


def _members(node, classes):
    """Functions and properties of a class of the stub, with those of its bases there."""
    for base in node.bases:
        if isinstance(base, ast.Name) and base.id in classes:
            yield from _members(classes[base.id], classes)
    yield from (item for item in node.body if isinstance(item, ast.FunctionDef))


def _add(found, node, append_doc):
    if isinstance(found, property) or hasattr(found, "__code__"):
        found.__doc__ = _doc_of(node)
    else:
        append_doc(found, _doc_of(node))


def add_docs(names, stub, append_doc):
    """names: those of the module; append_doc(function, text) does what Python cannot."""
    tree = ast.parse(stub.read_text(encoding="utf-8"))
    names["__doc__"] = _doc_of(tree)
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            _add(names[node.name], node, append_doc)
    del names["Status"].__doc__  # of pybind11, which only lists its values
    for name in classes.keys() & names.keys():
        names[name].__doc__ = _doc_of(classes[name])
        for member in _members(classes[name], classes):
            _add(vars(names[name])[member.name], member, append_doc)
