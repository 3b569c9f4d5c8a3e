#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Names keep to docs/glossary.md: no private word in public headers, Python module, options, columns and metrics, no private name in the
sources of the method, no odd phrase in messages and pages; every public type is named there or contains a term of it. Environment: EDGED, the program (without it options are read from the sources)."""
import json
import os
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/program"))  # of option_keys
HEADERS = sorted(path for folder in ("include", "toolbox") for path in (ROOT / folder).rglob("*.hpp*")
                 if "include" in path.relative_to(ROOT).parts)
MODULE = [*(ROOT / "python/edged").glob("*.py"), *(ROOT / "python/edged").glob("*.pyi")]


def words_of(text):
    """In small letters, one blank between them: of identifiers (snake_case, CamelCase, dotted) and of sentences."""
    text = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", text)
    return " ".join(re.findall(r"[a-z0-9]+", text.lower()))


def tables_of(page):
    """Rows of cells by heading, without the first two lines of each table."""
    tables, rows = {}, []
    for line in page.read_text().splitlines():
        if line.startswith("## "):
            rows = tables.setdefault(line[3:], [])
        elif line.startswith("|"):
            rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return {heading: rows[2:] for heading, rows in tables.items()}


TABLES = tables_of(ROOT / "docs/glossary.md")
ALL_TERMS = [row for rows in TABLES.values() for row in rows if len(row) == 3]
TERMS = [words_of(row[0]) for row in ALL_TERMS]
# word -> what may contain it
FORBIDDEN = {word: [words_of(part) for part in use.split(";")]
             for cell, use in TABLES["Forbidden words"] for word in re.findall("`(.+?)`", cell)}
ODD_PHRASES = [phrase for cell, _ in TABLES["Forbidden phrases"] for phrase in re.findall("`(.+?)`", cell)]
FORBIDDEN_NAMES = {name for cell, _ in TABLES["Forbidden identifiers"] for name in re.findall("`(.+?)`", cell)}


def private_words_in(text):
    words = f" {words_of(text)} "
    found = []
    for word, uses in FORBIDDEN.items():
        rest = words
        for use in uses:
            rest = rest.replace(f" {use} ", " ")
        if f" {word} " in rest:
            found.append(word)
    return found


def odd_phrases_in(text):
    text = " ".join(text.lower().split())
    return [phrase for phrase in ODD_PHRASES if re.search(rf"(?<!\w){re.escape(phrase)}(?!\w)", text)]


def literals_of(text):
    """The string literals of C++, those joined that follow one another."""
    parts = re.findall(r"""//.*|'\\?.'|"((?:\\.|[^"\\\n])*)"(\s*(?="))?""", text)
    return "".join(part if follows else f"{part}\n" for part, follows in parts).replace("\\n", "\n")


def split_source(text):
    """Code without texts, and comments, of a C++ header."""
    return re.sub(r'//.*|"(?:\\.|[^"\\])*"', "", text), " ".join(re.findall(r"//.*", text))


def option_keys():
    if "EDGED" in os.environ:
        from program import edged
        text = edged("config", "--yaml").stdout
    else:
        text = "\n".join(f"{name}:" for path in (ROOT / "src").rglob("*.cpp")
                         for name in re.findall(r'\.(?:add|group|choice)\(\s*"([\w.]+)"', path.read_text()))
    return sorted(set(re.findall(r"^ *([\w.]+):", text, re.MULTILINE)))


def keys_in(tree):
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield key
            yield from keys_in(value)
    elif isinstance(tree, list):
        for value in tree:
            yield from keys_in(value)


class Glossary(unittest.TestCase):
    def assert_public(self, names, where):
        for name in sorted(set(names)):
            with self.subTest(where=where, name=name):
                self.assertEqual(private_words_in(name), [])

    def test_each_term_stands_there_once(self):
        self.assertGreater(len(TERMS), 60)
        self.assertEqual(sorted(TERMS), sorted(set(TERMS)))

    def test_private_words_are_found_in_names_and_sentences(self):
        self.assertEqual(private_words_in("MapSight"), ["sight"])
        self.assertEqual(private_words_in("event_survival"), ["survival"])
        self.assertEqual(private_words_in("event_track_survival_rate"), [])
        self.assertEqual(private_words_in("the place was found again."), ["found again"])
        self.assertEqual(private_words_in("oversight, insights, withdrawn"), [])

    def test_odd_phrases_are_found_in_sentences(self):
        self.assertGreater(len(ODD_PHRASES), 25)
        self.assertEqual(odd_phrases_in("3 ms By its\nturning"), ["by its turning"])
        self.assertEqual(odd_phrases_in("a recommendation; it begins at the origin"), [])
        self.assertEqual(odd_phrases_in(literals_of('say("a bug "\n    "of ours");  // "mend"')), ["a bug of ours"])

    def test_messages_have_no_odd_phrases(self):
        sources = [path for folder in ("apps", "src", "toolbox", "ros", "python") for path in sorted((ROOT / folder).rglob("*.[ch]pp"))
                   if not path.name.endswith("_test.cpp") and "tests" not in path.parts]
        self.assertGreater(len(sources), 300)
        for path in sources:
            with self.subTest(where=str(path.relative_to(ROOT))):
                self.assertEqual(odd_phrases_in(literals_of(path.read_text())), [])

    def test_pages_and_scripts_have_no_odd_phrases(self):
        scripts = [path for folder in ("ros", "python") for path in (ROOT / folder).rglob("*.py*") if path.suffix in (".py", ".pyi")]
        pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "apps/report/page").iterdir()]
        for path in sorted([*pages, *scripts, ROOT / "apps/calib/template.yaml"]):
            if path.name != "glossary.md" and "tests" not in path.parts:
                with self.subTest(where=str(path.relative_to(ROOT))):
                    self.assertEqual(odd_phrases_in(path.read_text()), [])

    def test_public_headers_use_standard_terms(self):
        self.assertGreater(len(HEADERS), 9)
        for header in HEADERS:
            code, comments = split_source(header.read_text())
            self.assert_public([header.name.split(".")[0], *re.findall(r"[A-Za-z_]\w*", code)], header.name)
            with self.subTest(where=header.name, what="comments"):
                self.assertEqual(private_words_in(comments), [])
                self.assertEqual(odd_phrases_in(comments), [])

    def test_comments_of_the_library_use_standard_terms(self):
        for path in sorted((ROOT / "src").rglob("*.[ch]pp")):
            with self.subTest(where=path.name):
                self.assertEqual(private_words_in(split_source(path.read_text())[1]), [])

    def test_sources_of_the_method_have_no_forbidden_identifiers(self):
        self.assertGreater(len(FORBIDDEN_NAMES), 30)
        for path in sorted((ROOT / "src").rglob("*.[ch]pp")):
            with self.subTest(where=path.name):
                names = set(re.findall(r"[A-Za-z_]\w*", split_source(path.read_text())[0]))
                self.assertEqual(names & FORBIDDEN_NAMES, set())

    def test_public_types_are_named_by_the_glossary_or_contain_a_term(self):
        named = set(re.findall(r"\w+", " ".join(row[2] for row in ALL_TERMS)))
        count = 0
        for header in HEADERS:
            code = split_source(header.read_text())[0].split("private:")[0]
            for name in re.findall(r"^ *(?:struct|class|enum class) (\w+)(?: final)?(?: :[^;]*)? \{", code, re.MULTILINE):
                count += 1
                with self.subTest(header=header.name, type=name):
                    words = f" {words_of(name)} "
                    self.assertTrue(name in named or any(re.search(f" {term}s? ", words) for term in TERMS))
        self.assertGreater(count, 25)

    def test_the_python_module_uses_standard_terms(self):
        for path in MODULE:
            code = re.sub(r'"""(.|\n)*?"""|#.*', "", path.read_text())
            self.assert_public(re.findall(r"[A-Za-z_]\w*", code), path.name)

    def test_options_use_standard_terms(self):
        keys = option_keys()
        self.assertGreater(len(keys), 100)
        self.assert_public(keys, "options")

    @unittest.skipUnless("EDGED" in os.environ, "needs the program")
    def test_columns_and_metrics_of_a_run_use_standard_terms(self):
        from program import edged
        with tempfile.TemporaryDirectory() as folder:
            done = edged("run", "sim:room:1", "--duration", "1", "--quiet", "--out", f"{folder}/run")
            run = pathlib.Path(folder, "run")
            self.assertTrue((run / "metrics.json").exists(), done.stderr)
            for file in ("states.csv", "pace.csv", "keyframes.csv"):
                heading = next(line for line in (run / file).read_text().splitlines() if not line.startswith("#"))
                self.assert_public(heading.split(","), file)
            self.assert_public(keys_in(json.loads((run / "metrics.json").read_text())), "metrics.json")
            self.assert_public([row["stage"] for row in json.loads((run / "timing.json").read_text())["stages"]], "timing.json")


if __name__ == "__main__":
    unittest.main()
