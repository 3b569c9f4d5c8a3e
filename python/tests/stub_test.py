# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The stub and the module name the same things."""
import ast
import inspect
import pathlib

import edged

STUB = ast.parse(pathlib.Path(edged.__file__).with_name("__init__.pyi").read_text())
DEFINITIONS = (ast.ClassDef, ast.FunctionDef)
OF_EVERY_CLASS = {"__init__", "__repr__", "__str__"}


def names_of(body):
    names = {node.name for node in body if isinstance(node, DEFINITIONS) and node.name != "_BodyState"}
    return names | {node.target.id for node in body if isinstance(node, ast.AnnAssign)}


def stub_class(name):
    return next(node for node in STUB.body if isinstance(node, ast.ClassDef) and node.name == name)


def members_of(name):
    """With those that it inherits within the stub."""
    node = stub_class(name)
    names = names_of(node.body) | {target.id for item in node.body if isinstance(item, ast.Assign) for target in item.targets}
    for base in node.bases:
        if isinstance(base, ast.Name) and base.id.startswith("_"):
            names |= members_of(base.id)
    return names


def test_every_public_name_of_the_module_is_in_the_stub_and_the_other_way_round():
    assert names_of(STUB.body) - {"__all__"} == set(edged.__all__)
    assert all(hasattr(edged, name) for name in edged.__all__)


def test_every_member_of_a_class_is_in_the_stub_and_the_other_way_round():
    for name in edged.__all__:
        found = getattr(edged, name)
        if not inspect.isclass(found) or name == "InputError":
            continue
        mine = {member for member in vars(found) if not member.startswith("_") or member in ("__iter__", "__next__")}
        of_enums = {"name", "value"} if name == "Status" else set()
        assert mine - of_enums == members_of(name) - OF_EVERY_CLASS, name


def test_every_argument_of_a_function_written_in_python_is_in_the_stub():
    for node in STUB.body:
        if isinstance(node, ast.FunctionDef) and inspect.isfunction(getattr(edged, node.name)):
            mine = list(inspect.signature(getattr(edged, node.name)).parameters)
            assert mine == [argument.arg for argument in [*node.args.args, *filter(None, [node.args.kwarg])]], node.name


def test_every_argument_of_a_function_of_the_library_is_in_the_stub():
    for node in STUB.body:
        if isinstance(node, ast.FunctionDef) and not inspect.isfunction(getattr(edged, node.name)):
            signature = getattr(edged, node.name).__doc__.splitlines()[0]
            for argument in node.args.args:
                assert f"{argument.arg}:" in signature, (node.name, signature)
