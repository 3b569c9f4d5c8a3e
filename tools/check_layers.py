#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Checks that no file includes, and no module links, what the layer tables in ARCHITECTURE.md do not allow, and that
no components include one another in a cycle, that public headers include no private ones, and that no two headers define
a type of the same name.

The table is the rule: `| module | may use | public | holds |`, one row a module, bottom to top. A row may name only rows
above it, so there are no cycles of modules; modules of the method lie in src/edged, and may use none of the toolbox's, in
toolbox/edged, which may be missing as a whole. `public` names the headers that are the module's in include/edged, or in
toolbox/include/edged where it is of the toolbox. A component is a path without its extension, module/x: x.hpp, a public one
too, and x.cpp are one, x_test.cpp is of none. Folders within io are archive, parse and core, each of which may include
those before it, and families of formats, which may include these three but not one another; loose sources of io join the
families. Usage: check_layers.py [ROOT]; prints every violation, a cycle as `a -> b -> a`, and exits 1 if there is one.
"""
import graphlib
import itertools
import pathlib
import re
import sys

ROW = re.compile(r"^\|\s*`([\w/]+)`\s*\|([^|]*)\|([^|]*)\|")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"')
ROOTS = ("src", "toolbox")  # where "edged/module/..." is included from; the method's first
OUTSIDE = ("apps", "ros", "python/src")  # C++ outside the modules
PUBLIC = ("include", "toolbox/include")  # where public headers are, in the same order
ANY_INCLUDE = re.compile(r'^\s*#\s*include\s+[<"]([^>"]+)[>"]')
PUBLIC_INCLUDE = re.compile(r"\w+|Eigen/\w+|opencv2/core(/[\w/]+)?\.hpp")
TYPE = re.compile(r"^(?:struct|class|enum class) (\w+)\b[^;()]*\{")  # of the namespace: nested ones are indented
LINKS = re.compile(r"\b(TEST_DEPENDS|DEPENDS)\b|\bedged::(\w+)|^\s*(SOURCES|TESTS)\b")
IO_FOLDER = re.compile(r"edged/io/(\w+)/")
IO_SHARED = ("archive", "parse", "core")  # folders of io that families share, bottom to top; its other folders are families


def read_table(architecture, what):
    """Of the table of modules, or of folders: name -> names it may use, in the order of the table; public header -> its
    module; what is wrong with the table."""
    allowed, public, errors, inside = {}, {}, [], False
    for number, line in enumerate(architecture.read_text().splitlines(), 1):
        if re.match(rf"^\|\s*{what}\s*\|\s*may use\s*\|", line):
            inside = True
        elif inside and not line.startswith("|"):
            break
        elif inside and (row := ROW.match(line)):
            name, uses = row.group(1), re.findall(r"`([\w/]+)`", row.group(2))
            errors += [f"{architecture.name}:{number}: `{name}` uses `{use}`, which has no row above it"
                       for use in uses if use not in allowed]
            allowed[name] = set(uses)
            public.update((header, name) for header in re.findall(r"`([\w/]+)`", row.group(3)))
    return allowed, public, errors


def modules(root):
    """Module -> its folder."""
    return {p.parent.name: p.parent for base in ROOTS for p in sorted((root / base / "edged").glob("*/CMakeLists.txt"))}


def public_header(root, name):
    """The file of that name, maybe filled in by CMake; None where there is none."""
    files = (root / base / "edged" / (name + end) for base in PUBLIC for end in (".hpp", ".hpp.in"))
    return next(filter(pathlib.Path.is_file, files), None)


def public_component(module, name):
    """Those of the toolbox have their module's folder in their names."""
    return f"edged/{name}" if name.startswith(f"{module}/") else f"edged/{module}/{name}"


def code_files(root, folders, public):
    """(module, file, component) of all code."""
    for name, module in public.items():
        if file := public_header(root, name):
            yield module, file, public_component(module, name)
    for module, folder in folders.items():
        for file in sorted(folder.rglob("*")):
            if file.suffix in (".hpp", ".cpp"):
                yield module, file, str(file.relative_to(folder.parent.parent).with_suffix(""))


def check_includes(root, folders, public, allowed):
    for module, file, _ in code_files(root, folders, public):
        for number, line in enumerate(file.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            where, included = f"{file.relative_to(root)}:{number}", match.group(1)
            if not included.startswith("edged/"):
                yield f'{where}: "{included}" is not included from the root (edged/...)'
                continue
            target = public.get(included.removeprefix("edged/").removesuffix(".hpp"))
            if not target and not any((root / base / included).is_file() for base in ROOTS):
                yield f'{where}: "{included}" does not exist'
            else:
                target = target or included.split("/")[1]
                if target != module and target not in allowed.get(module, set()):
                    yield f"{where}: {module} may not include {target}"


def check_public_names(root, public, method):
    """The headers there are, and those of the table; the toolbox may be missing."""
    for base in PUBLIC:
        folder = root / base / "edged"
        headers = {str(p.relative_to(folder)).removesuffix(".in").removesuffix(".hpp") for p in folder.rglob("*.hpp*")}
        named = {name for name, module in public.items() if (module in method) == (base == PUBLIC[0])}
        yield from (f"ARCHITECTURE.md: no row has {base}/edged/{name}.hpp" for name in sorted(headers - named))
        if folder.is_dir():
            yield from (f"ARCHITECTURE.md: there is no {base}/edged/{name}.hpp" for name in sorted(named - headers))


def check_public(root, public):
    """A public header includes others, the standard library's, Eigen's and those of OpenCV's core."""
    for name in public:
        file = public_header(root, name)
        for number, line in enumerate(file.read_text().splitlines() if file else (), 1):
            included = ANY_INCLUDE.match(line)
            if included and not PUBLIC_INCLUDE.fullmatch(included := included.group(1)) and not (
                    included.startswith("edged/") and included.removeprefix("edged/").removesuffix(".hpp") in public):
                yield f"{file.relative_to(root)}:{number}: a public header may not include {included}"


def uses_of_components(root, folders, public):
    """Component -> components that it includes."""
    uses = {}
    for _, file, component in code_files(root, folders, public):
        if component.endswith("_test"):
            continue
        for include in filter(None, map(INCLUDE.match, file.read_text().splitlines())):
            used = pathlib.PurePath(include.group(1)).with_suffix("")
            if (name := str(used.relative_to("edged"))) in public:
                used = public_component(public[name], name)
            uses.setdefault(component, {})[str(used)] = None
        uses.get(component, {}).pop(component, None)
    return uses


def uses_of_folders(root, allowed, errors):
    """The same of what lies outside the modules, tests apart, which includes its own from apps, from ros, or from beside
    it. Adds to `errors` what the table of folders does not allow."""
    uses = {}
    for file in sorted(f for top in OUTSIDE for f in (root / top).rglob("*.[ch]pp") 
                       if "tests" not in f.parts and not f.stem.endswith("_test")):
        folder = file.parent.relative_to(root).as_posix()
        if folder not in allowed:
            errors.append(f"{file.relative_to(root)}: {folder} has no row in the table of folders of ARCHITECTURE.md")
            continue
        component = str(file.relative_to(root).with_suffix(""))
        for number, line in enumerate(file.read_text().splitlines(), 1):
            include = INCLUDE.match(line)
            places = [base / include.group(1) for base in (root / "apps", root / "ros", file.parent)] if include else []
            used = next(filter(pathlib.Path.is_file, places), None)
            if not used:
                continue
            other = used.parent.relative_to(root).as_posix()
            if other != folder and other not in allowed[folder]:
                errors.append(f"{file.relative_to(root)}:{number}: {folder} may not include {other}")
            uses.setdefault(component, {})[str(used.relative_to(root).with_suffix(""))] = None
        uses.get(component, {}).pop(component, None)
    return uses


def check_cycles(uses):
    """Cycles of components, no two of which share a step."""
    while True:
        try:
            return graphlib.TopologicalSorter(uses).prepare()
        except graphlib.CycleError as error:
            cycle = error.args[1][::-1]
            yield "include cycle: " + " -> ".join(cycle)
            for component, used in itertools.pairwise(cycle):
                del uses[component][used]


def check_families(root, folders):
    """Folders of io: a shared one includes those below it, a family the shared ones, a loose header none of a family."""
    for file in sorted(folders["io"].rglob("*.[ch]pp")) if "io" in folders else ():
        own = (match := IO_FOLDER.search(file.relative_to(root).as_posix())) and match.group(1)
        if not own and file.suffix == ".cpp" or file.name.endswith(("_test.cpp", "_test_support.hpp")) and own in IO_SHARED:
            continue
        below = IO_SHARED[:IO_SHARED.index(own)] if own in IO_SHARED else IO_SHARED
        for number, line in enumerate(file.read_text().splitlines(), 1):
            other = (include := INCLUDE.match(line)) and IO_FOLDER.match(include.group(1))
            if other and other.group(1) not in (own, *below):
                where = f"io/{own}" if own else "a header of io"
                yield f"{file.relative_to(root)}:{number}: {where} may not include io/{other.group(1)}"


def check_names(root, folders, public):
    """One namespace has one type of a name: a program that links two runs the code of either."""
    defined = {}
    for _, file, _ in code_files(root, folders, public):
        for match in filter(None, map(TYPE.match, file.read_text().splitlines() if file.suffix != ".cpp" else ())):
            defined.setdefault(match.group(1), []).append(str(file.relative_to(root)))
    for name, files in defined.items():
        if len(files) > 1:
            yield f"{' and '.join(files)} define a type of the same name, {name}"


def check_links(root, folders, allowed):
    """What CMake links: DEPENDS of a module; test programs link what they like."""
    for module, folder in folders.items():
        section, file = None, folder / "CMakeLists.txt"
        for line in file.read_text().splitlines():
            for keyword, target, other in LINKS.findall(line):
                if keyword or other:
                    section = keyword or other
                elif section == "DEPENDS" and target not in allowed.get(module, set()):
                    yield f"{file.relative_to(root)}: {module} may not link {target}"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    allowed, public, errors = read_table(root / "ARCHITECTURE.md", "module")
    outside, _, wrong = read_table(root / "ARCHITECTURE.md", "folder")
    errors += wrong
    folders = modules(root)
    if (root / "toolbox").is_dir():
        errors += [f"ARCHITECTURE.md: `{name}` stands in the table, but there is no edged/{name} in {' or '.join(ROOTS)}"
                   for name in sorted(allowed.keys() - folders.keys())]
    errors += [f"{folders[name].relative_to(root)}: has no row in the table of ARCHITECTURE.md"
               for name in sorted(folders.keys() - allowed.keys())]
    method = {name for name, folder in folders.items() if folder.is_relative_to(root / "src")}
    errors += [f"ARCHITECTURE.md: `{name}` is of the method, `{use}` is not" for name in sorted(method & allowed.keys())
               for use in sorted(allowed[name] - method)]
    errors += check_public_names(root, public, method)
    errors += check_includes(root, folders, public, allowed)
    errors += check_public(root, public)
    uses = uses_of_folders(root, outside, errors)
    errors += check_cycles(uses_of_components(root, folders, public) | uses)
    errors += check_families(root, folders)
    errors += check_names(root, folders, public)
    errors += check_links(root, folders, allowed)
    print("\n".join(errors) or f"{len(allowed)} modules keep their layers, no components include one another in a cycle")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
