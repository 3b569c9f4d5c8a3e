#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Tables of the benchmarks as one html file that needs nothing else: a click on the head of a column sorts by it. Of Markdown it
knows what our pages use: headings, paragraphs, lists, tables, fences, and code, stress and links within a line.

Usage: bench/page.py docs/results.md [--out results.html]; the page lies beside the file unless told otherwise.
"""
import argparse
import html
import pathlib
import re
import sys

STYLE = """
:root { color-scheme: light dark }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; padding: 0 1em; max-width: 75em }
table { border-collapse: collapse; margin: 1em 0; font-variant-numeric: tabular-nums; display: block; overflow-x: auto }
th, td { padding: .25em .6em; border-bottom: 1px solid #8884; text-align: left; white-space: nowrap }
th { cursor: pointer; border-bottom-width: 2px }
th[aria-sort=ascending]::after { content: " \\2191" }
th[aria-sort=descending]::after { content: " \\2193" }
.right { text-align: right }
tbody tr:hover { background: #8881 }
"""
# By the first number of a cell where the column is one of numbers; cells without one come last, whichever way.
SCRIPT = """
for (const head of document.querySelectorAll("th")) head.addEventListener("click", () => {
  const up = head.ariaSort === "ascending" ? -1 : 1, body = head.closest("table").tBodies[0];
  for (const other of head.parentNode.cells) other.ariaSort = null;
  head.ariaSort = up > 0 ? "ascending" : "descending";
  const text = (row) => row.cells[head.cellIndex].textContent;
  const number = (row) => Number(text(row).match(/-?\\d+(\\.\\d+)?/)?.[0]);
  const compare = head.classList.contains("right")
    ? (a, b) => Number.isNaN(number(a)) - Number.isNaN(number(b)) || up * (number(a) - number(b)) || 0
    : (a, b) => up * text(a).localeCompare(text(b));
  body.append(...[...body.rows].sort(compare));
});
"""


def inline(text):
    """One line; what stands in code is not looked at."""
    def styled(piece):
        piece = html.escape(piece, quote=False)
        piece = re.sub(r"!?\[([^\]]*)\]\(([^)\s]+)\)", r'<a href="\2">\1</a>', piece)
        piece = re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", piece)
        return re.sub(r"\*(\S.*?)\*", r"<i>\1</i>", piece)
    return "".join(f"<code>{html.escape(piece)}</code>" if i % 2 else styled(piece) for i, piece in enumerate(text.split("`")))


def table(lines):
    rows = [[cell.strip() for cell in line.strip()[1:-1].split("|")] for line in lines]
    side = [' class="right"' if cell.endswith(":") else "" for cell in rows[1]]
    drawn = [[f"<{tag}{right}>{inline(cell)}</{tag}>" for cell, right in zip(row, side)]
             for tag, row in zip(["th"] + ["td"] * len(rows), [rows[0], *rows[2:]])]
    head, *body = ("<tr>" + "".join(cells) + "</tr>" for cells in drawn)
    return "\n".join(["<table>", f"<thead>{head}</thead>", "<tbody>", *body, "</tbody>", "</table>"])


def block(text):
    """A piece between empty lines."""
    lines = text.splitlines()
    heading = re.fullmatch(r"(#+) (.*)", lines[0])
    if heading:
        level = len(heading.group(1))
        return f"<h{level}>{inline(heading.group(2))}</h{level}>" + ("\n" + block("\n".join(lines[1:])) if lines[1:] else "")
    if lines[0].startswith("|") and len(lines) > 1 and re.fullmatch(r"[|\s:-]+", lines[1]):
        return table(lines)
    if lines[0].startswith("- "):
        items = re.split(r"^- ", text, flags=re.MULTILINE)[1:]
        return "\n".join(["<ul>", *(f"<li>{inline(item.strip())}</li>" for item in items), "</ul>"])
    return f"<p>{inline(text)}</p>"


def page(markdown):
    """The whole file."""
    title = re.search(r"^# (.*)", markdown, flags=re.MULTILINE)
    parts = []
    for i, piece in enumerate(re.split(r"^```\w*\n(.*?)^```$", re.sub(r"<!--.*?-->", "", markdown), flags=re.MULTILINE | re.DOTALL)):
        parts += [f"<pre>{html.escape(piece)}</pre>"] if i % 2 else map(block, re.split(r"\n\s*\n", piece.strip())) if piece.strip() else []
    name = html.escape(title.group(1)) if title else "Edged USLAM"
    return "\n".join(["<!doctype html>", '<meta charset="utf-8">', '<meta name="viewport" content="width=device-width">',
                      f"<title>{name}</title>", f"<style>{STYLE}</style>", *parts, f"<script>{SCRIPT}</script>", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=pathlib.Path, help="Markdown")
    parser.add_argument("--out", type=pathlib.Path, help="[FILE.html]")
    options = parser.parse_args()
    (options.out or options.file.with_suffix(".html")).write_text(page(options.file.read_text()))


if __name__ == "__main__":
    sys.exit(main())
