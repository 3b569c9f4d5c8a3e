#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Checks licence lines, header guards, the sizes of files and functions, names that sources share, the letter of the map
frame, and our own format (.clang-format).

Usage: check_style.py [ROOT]; prints warnings and errors, exits 1 if there is an error. Sizes above the first number are a
warning: a place to look. Above the second they are an error.
"""
import pathlib
import re
import shutil
import subprocess
import sys

FILE_LINES = (400, 600)
FUNCTION_LINES = (60, 100)
SPDX = ("SPDX-FileCopyrightText: 2026 Edged USLAM developers", "SPDX-License-Identifier: Apache-2.0")
CODE = {".cpp", ".hpp"}
SCRIPTS = {".py", ".sh", ".cmake"}
# Whose sources become one library, which may be compiled as one file.
MODULES = ("src", "toolbox", "apps", "python", "ros")
CONSTANTS = re.compile(r"^constexpr [^;]*;", re.MULTILINE)
CONSTANT = re.compile(r"(?<!= )\b(k[A-Z]\w*)(?= = |\(|\{|\[)")
CLASS = re.compile(r"^(?:class|struct|enum class) (\w+)(?: final)?(?: : [^{;]*)? \{", re.MULTILINE)
# W is the public API's name of the map frame: sources of the method say O or M, but where they meet that API.
WORLD, WORLD_EDGES = re.compile(r"\bT_W_\w+"), {"output_frame", "state_prediction", "step"}
# What holds functions. A brace after '=' outside a function opens a list of values; every other one there a function.
CONTAINER = re.compile(r"\s*(template\s*<.*>\s*)?(namespace|class|struct|union|enum|extern)\b", re.DOTALL)
NOT_CODE = re.compile(r"""//[^\n]*|/\*.*?\*/|^\s*\#[^\n]*|R"\(.*?\)"|"(?:\\.|[^"\\])*"|(?<![0-9A-Fa-f])'(?:\\.|[^'\\])'""",
                      re.DOTALL | re.MULTILINE)


def files(root):
    """What git tracks or would track."""
    names = subprocess.run(["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard"], check=False,
                           capture_output=True, text=True)
    if names.returncode == 0:
        return [root / name for name in names.stdout.splitlines() if (root / name).is_file()]
    return [p for p in root.rglob("*") if p.is_file() and "build" not in p.relative_to(root).parts]


def functions(text):
    """(first line, length) of every function, members too, counted from its opening brace to its closing one."""
    code = NOT_CODE.sub(lambda match: "\n" * match.group().count("\n"), text)
    line, head, open_braces = 1, "", []  # of each open brace: the line of a function's, None of any other's
    for character in code:
        if character == "{":
            inside = any(begin is not None for begin in open_braces)
            no_function = CONTAINER.match(head) or head.rstrip().endswith("=")
            open_braces.append(None if not inside and no_function else line)
        elif character == "}" and open_braces:
            begin = open_braces.pop()
            if begin is not None and all(outer is None for outer in open_braces):
                yield begin, line - begin + 1
        line += character == "\n"
        head = "" if character in "{};" else head + character


def check(path, name, errors, warnings):
    text = path.read_text(errors="replace")
    lines = text.splitlines()
    head = lines[1:3] if lines and lines[0].startswith("#!") else lines[:2]
    if len(head) < 2 or any(want not in line for want, line in zip(SPDX, head)):
        errors.append(f"{name}:1: the two SPDX lines are missing")
    if path.suffix not in CODE:
        return
    if path.suffix == ".hpp":
        if "#pragma once" not in lines:
            errors.append(f"{name}: no #pragma once")
        if len(lines) < 3 or not lines[2].startswith("// "):
            errors.append(f"{name}:3: says in no sentence what the file is")
    if name.parts[0] == "src" and "test" not in path.stem and path.stem not in WORLD_EDGES:
        errors += [f"{name}:{line}: {word} within the method: the frame is O or M (docs/decisions/map/031-coordinate-frames.md)"
                   for line, text_line in enumerate(lines, 1) for word in WORLD.findall(text_line)]
    for (soft, hard), what, sizes in ((FILE_LINES, "file", [(1, len(lines))]),
                                      (FUNCTION_LINES, "function", functions(text))):
        for line, size in sizes:
            if size > soft:
                (errors if size > hard else warnings).append(f"{name}:{line}: {what} of {size} lines (aim: {soft})")


def check_names(root, paths, errors):
    """Constants of a module's sources, tests apart, and classes of all headers: each has a name of its own."""
    first = {}
    for path in paths:
        name = path.relative_to(root)
        if path.suffix == ".hpp":
            text = path.read_text(errors="replace")
            namespace = re.search(r"^namespace (\S+) \{", text, re.MULTILINE)
            within, names = namespace and namespace[1], CLASS.findall(text) if namespace else []
        elif path.suffix == ".cpp" and name.parts[0] in MODULES:
            module = next(folder for folder in path.parents if (folder / "CMakeLists.txt").exists())
            within = (module, path.stem.endswith("_test"))
            names = [each for group in CONSTANTS.findall(path.read_text()) for each in CONSTANT.findall(group)]
        else:
            continue
        for each in names:
            other = first.setdefault((within, each), name)
            if other != name:
                errors.append(f"{name}: {each} is also in {other}: a file that has both does not compile")


def check_format(root, paths, errors):
    """As clang-format of Debian 12 has it; another version sets some lines otherwise, and is not asked."""
    program = shutil.which("clang-format-14") or shutil.which("clang-format")
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout if program else ""
    if " 14." not in version:
        errors.append(f"clang-format 14 is missing ({version.strip() or 'none found'}): scripts/setup.sh installs it")
        return
    done = subprocess.run([program, "--dry-run", *paths], cwd=root, capture_output=True, text=True, check=False)
    wrong = dict.fromkeys(line.split(": warning:")[0] for line in done.stderr.splitlines() if ": warning:" in line)
    errors.extend(f"{pathlib.Path(place).relative_to(root)}: not our format: clang-format -i mends it"
                  for place in dict.fromkeys(place.split(":")[0] for place in wrong))


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    errors, warnings = [], []
    paths = files(root)
    for path in paths:
        if path.suffix in CODE | SCRIPTS or path.name == "CMakeLists.txt":
            check(path, path.relative_to(root), errors, warnings)
    check_names(root, paths, errors)
    check_format(root, [path for path in paths if path.suffix in CODE], errors)
    for text in warnings:
        print(f"warning: {text}")
    for text in errors:
        print(f"error: {text}")
    print(f"{len(errors)} errors, {len(warnings)} warnings")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
