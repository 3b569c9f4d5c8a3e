#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What the pages promise: commands on any page have flags that exist, messages in docs/faq.md are
those of the source, options that messages name exist, each design decision has a page with links that exist,
ARCHITECTURE.md stays a map.
Usage: EDGED=path/to/edged docs_test.py. Decisions and Architecture never start it."""
import functools
import pathlib
import re
import shlex
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/program"))
from program import edged  # noqa: E402

DECISIONS = ROOT / "docs/decisions"


def commands_of(page):
    """Command lines of the program on a page: lines of its shell listings, and inline code."""
    text = page.read_text()
    fences = re.findall(r"^```bash\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    lines = [line for fence in fences for line in fence.replace("\\\n", " ").splitlines()]
    lines += re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE))
    for line in lines:
        for part in re.split(r"&&|;|\s\|\s", line.split(" #")[0]):
            part = re.sub(r"^\S*build/release/bin/edged ", "edged ", part.strip())
            if re.match(r"edged \S", part):
                yield part


@functools.lru_cache(None)
def flags_of(command):
    return set(re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", edged(command, "--help").stdout))


@functools.lru_cache(None)
def options_of(command):
    """Keys that --set takes."""
    listing = {"simulate": ("simulate", "--list"), "ros2": ("ros2", "--print-config")}
    text = edged(*listing.get(command, ("config", "--yaml"))).stdout
    keys, groups = set(), []
    for line in text.splitlines():
        found = re.match(r"( *)([\w.]+):", line)
        if found:
            groups = groups[:len(found.group(1)) // 2] + [found.group(2)]
            keys.add(".".join(groups))
    return keys


class Commands(unittest.TestCase):
    def test_commands_on_all_pages_have_flags_and_options_that_there_are(self):
        known = set(re.findall(r"^  ([a-z0-9]+) ", edged("--help").stdout, re.MULTILINE)) | {"manual"}
        count = 0
        for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
            for line in commands_of(page):
                with self.subTest(page=page.name, line=line):
                    words = shlex.split(line)
                    if words[1].startswith("-") or words[1].isupper():  # edged --version, edged COMMAND
                        continue
                    count += 1
                    self.assertIn(words[1], known)
                    for word in words[2:]:
                        if word.startswith("--"):
                            self.assertIn(word.split("=")[0], flags_of(words[1]))
                    for flag, value in zip(words, words[1:]):
                        if flag == "--set" and not value.isupper():
                            self.assertIn(value.split("=")[0], options_of(words[1]))
        self.assertGreater(count, 100)


class Messages(unittest.TestCase):
    LITERALS = re.compile(r'"(?:\\.|[^"\\\n])*"(?:\s*"(?:\\.|[^"\\\n])*")*')

    @classmethod
    def said(cls, source):
        """The string literals of a file, those joined that follow one another."""
        return ["".join(re.findall(r'"((?:\\.|[^"\\\n])*)"', text)) for text in cls.LITERALS.findall(source.read_text())]

    SOURCES = [path for folder in ("apps", "src", "toolbox") for path in sorted((ROOT / folder).rglob("*.[ch]pp"))
               if not path.name.endswith("_test.cpp")]

    def test_options_that_messages_name_exist(self):
        options = set(re.findall(r"^(\S+) = ", edged("config", ".").stdout, re.MULTILINE))
        self.assertGreater(len(options), 100)
        groups = "|".join(sorted({option.partition(".")[0] for option in options}))
        for source in self.SOURCES:
            named = re.findall(rf"(?<![\w./])((?:{groups})(?:\.\w+)+)", "\n".join(self.said(source)))
            for name in (name for name in named if not name.endswith((".csv", ".hpp", ".pgm", ".ply", ".yaml"))):
                with self.subTest(source=str(source.relative_to(ROOT)), name=name):
                    self.assertTrue(any(option.removeprefix("expert.") == name.removeprefix("expert.") or
                                        option.startswith(f"{name}.") for option in options))

    def test_messages_in_the_faq_are_those_of_the_source(self):
        everything = "\n".join(text for source in self.SOURCES for text in self.said(source))
        headings = re.findall(r"^### `(.+)`$", (ROOT / "docs/faq.md").read_text(), re.MULTILINE)
        self.assertGreater(len(headings), 20)
        for heading in headings:
            with self.subTest(heading=heading):
                parts = [re.escape(part) for part in heading.split("...")]
                self.assertTrue(re.search(r"[^\n]*".join(parts), everything))


def missing_links(page):
    targets = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text())
    return [target for target in targets if "://" not in target and not (page.parent / target).exists()]


class Decisions(unittest.TestCase):
    PAGES = sorted(DECISIONS.glob("*/[0-9]*.md"), key=lambda page: page.name)

    def test_each_states_context_decision_evidence_and_consequences_in_short(self):
        self.assertGreater(len(self.PAGES), 24)
        for number, page in enumerate(self.PAGES, 1):
            with self.subTest(page=page.name):
                text = page.read_text()
                self.assertTrue(page.name.startswith(f"{number:03}-"), "numbers have no holes")
                self.assertRegex(text, rf"^# {number:03}\. \S")
                self.assertEqual(re.findall(r"^## (.*)$", text, re.MULTILINE),
                                 ["Context", "Decision", "Evidence", "Consequences"])
                self.assertLessEqual(len(text.splitlines()), 40)

    def test_the_index_has_each_page_once_by_its_title(self):
        rows = re.findall(r"^- (\d+) \[(.*)\]\((.*)\)$", (DECISIONS / "README.md").read_text(), re.MULTILINE)
        self.assertEqual(sorted(rows), [(page.name[:3], page.read_text().splitlines()[0].split(". ", 1)[1],
                                         str(page.relative_to(DECISIONS))) for page in self.PAGES])

    def test_links_lead_to_files_that_exist(self):
        for page in [*DECISIONS.rglob("*.md"), ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md"]:
            with self.subTest(page=page.name):
                self.assertEqual(missing_links(page), [])


class Architecture(unittest.TestCase):
    def test_is_a_map_of_160_lines_without_commits(self):
        text = (ROOT / "ARCHITECTURE.md").read_text()
        self.assertLessEqual(len(text.splitlines()), 160)
        self.assertNotRegex(text, r"\b(?=[a-f]*\d)[0-9a-f]{7,40}\b")


if __name__ == "__main__":
    unittest.main(verbosity=2)
