#!/usr/bin/env python3
"""Makes of a file what doxygen reads: of the header's plain comments documentation, of a page's links references.

    doxygen_filter.py FILE         prints the file

Header: a comment with an underlined title opens a group; Out, In and Returns become parameters and results; indented lines stay as
they are; "_LENGTH" after "FIXPAIR_ERROR_NULL" is written out, so that it becomes a link. Page: headings get names, links to headings and
pages become references, links to other files their text.
"""

import re
import sys
import textwrap
from pathlib import Path

TITLE = re.compile(r"/\*\n \* (?P<title>[^\n]+)\n \* =+\n \*/\n")
COMMENT = re.compile(r"^(?P<indent> *)/\* ?(?P<text>.*?) ?\*/$", re.S | re.M)
LABEL = re.compile(r"(?P<label>Out|In|In/Out|In/out|Returns|Cost): *(?P<rest>.*)")
DIRECTION = {"Out": "out", "In": "in", "In/Out": "in,out", "In/out": "in,out"}
ENTRY = re.compile(r"(?P<names>\w+(?:, \w+)*)(?:  +(?P<what>.*))?$")
SHORT = re.compile(r"FIXPAIR_[A-Z0-9_]+|(?<![\w.])_[A-Z][A-Z0-9_]*\b")


def slug(text):
    """The name that GitHub gives a heading."""
    return re.sub(r"[^\w -]", "", text.lower()).replace(" ", "-")


def escape(line):
    """Characters that doxygen or Markdown would take for commands."""
    return re.sub(r"([\\@<>*#%&~])", r"\\\1", line)


class Header:
    """The header, comment by comment."""

    def __init__(self, text):
        self.text = text
        self.defines = set(re.findall(r"^#define (FIXPAIR_\w+)", text, re.M))
        functions = re.findall(r"^(?:[\w ]+[ *])?(fixpair_\w+)\(", text, re.M)
        self.linked = self.defines.union(functions)

    def write_out(self, line):
        """"FIXPAIR_ERROR_NULL, _LENGTH" in full."""
        prefix = "FIXPAIR_ERROR"

        def full(match):
            nonlocal prefix
            name = match.group(0)
            if not name.startswith("_"):
                prefix = name.rsplit("_", 1)[0]
                return name
            while prefix != "FIXPAIR":
                if prefix + name in self.defines:
                    return prefix + name
                prefix = prefix.rsplit("_", 1)[0]
            prefix = "FIXPAIR_ERROR"
            return prefix + name if prefix + name in self.defines else name

        return SHORT.sub(full, line)

    def prose(self, line):
        """A line of text: names in full, constants and functions as links, no sentence that ends at "Eq."."""
        line = re.sub(r"\b(Eq|al)\. ", r"\1.\\ ", escape(self.write_out(line)))
        return re.sub(r"\b(?:FIXPAIR|fixpair)_\w+\b(?!\()", lambda name: "#" * (name[0] in self.linked) + name[0], line)

    def plain(self, lines):
        """Paragraphs, with what is indented kept as it stands."""
        result, kept = [], []

        def flush():
            if kept:
                result.extend(["@verbatim", *textwrap.dedent("\n".join(kept)).rstrip("\n").split("\n"), "@endverbatim"])
                kept.clear()

        for line in lines:
            item = re.match(r" {1,2}(\d+)\. +(.*)", line)
            self.in_list = bool(item) or self.in_list and (not line or line.startswith("   "))
            if line.startswith("   ") and not self.in_list or kept and not line.strip():
                kept.append(line)
                continue
            flush()
            result.append(f"{item[1]}. {self.prose(item[2])}" if item else self.prose(line.rstrip()))
        flush()
        return result

    def entry(self, direction, text, names):
        """One argument, or several."""
        match = ENTRY.match(text)
        if match and all(name in names for name in match["names"].split(", ")):
            listed = match["names"].replace(", ", ",")
            return f"@param[{direction}] {listed} {self.prose(match['what'] or '')}"
        return f"@par\n@b {direction}: {self.prose(text)}"

    def block(self, text, names):
        """A comment without its stars."""
        lines = text.split("\n")
        first = next((i for i, line in enumerate(lines) if LABEL.match(line)), len(lines))
        self.in_list = False
        result, label, column = self.plain(lines[:first]), None, 0
        for line in lines[first:]:
            match = LABEL.match(line)
            rest = match["rest"] if match else line.strip()
            if match:
                label, column = match["label"], match.start("rest")
                if label == "Returns":
                    result.append(f"@return {self.prose(rest)}")
                    continue
                if label == "Cost":
                    result.append(f"@par Cost\n{self.prose(rest)}")
                    continue
            starts = match or (label in DIRECTION and len(line) - len(line.lstrip()) <= column and line.strip())
            if starts and label in DIRECTION:
                result.append(self.entry(DIRECTION[label], rest, names))
            else:
                result.append(self.prose(rest) if rest else "")
        return "\n".join(result)

    def arguments(self, end):
        """Names of the arguments of the function that follows a comment."""
        match = re.match(r"\s*[\w ]+[ *](fixpair_\w+)\(([^;{]*)\);", self.text[end:])
        return set(re.findall(r"(\w+)(?:\)\([^)]*\))?(?=,|$)", match[2])) if match else set()

    def comment(self, match):
        indent = match["indent"]
        text = re.sub(r"^ *\* ?", "", match["text"].strip("\n "), flags=re.M)
        head = "@file\n" if text.startswith("fixpair.h: ") else ""
        block = head + self.block(text, self.arguments(match.end()))
        return f"{indent}/**\n{block}\n{indent}*/"

    def documented(self):
        """Everything, in groups: constants, structures, and a group for each title."""
        marks, text = [], self.text
        first_define = re.search(r"^/\*(?:(?!\*/).)*\*/\n#define (?!FIXPAIR_H)", text, re.S | re.M)
        first_type = re.search(r"^(?:#if [^\n]*\n)?/\*(?:(?!\*/).)*\*/\ntypedef ", text, re.S | re.M)
        marks.append((first_define.start(), "constants", "Constants"))
        marks.append((first_type.start(), "structures", "Structures"))
        marks += [(match.start(), slug(match["title"]).replace("-", "_"), match["title"]) for match in TITLE.finditer(text)]
        pieces, last = [], 0
        for number, (start, name, title) in enumerate(marks):
            pieces.append((last, start, "" if number == 0 else "/** @} */\n"))
            pieces.append((start, start, f"/** @defgroup {name} {title}\n * @{{ */\n"))
            last = start
        end = text.rindex("#ifdef __cplusplus")
        pieces += [(last, end, "/** @} */\n"), (end, len(text), "")]
        return "".join(self.piece(start, stop) + after for start, stop, after in pieces)

    def piece(self, start, stop):
        result, position = [], start
        for match in COMMENT.finditer(self.text, start, stop):
            result.append(self.text[position:match.start()])
            result.append("" if TITLE.match(match.group(0) + "\n") else self.comment(match))
            position = match.end()
        return "".join(result) + self.text[position:stop]


def page(path):
    """A page of docs/."""
    name, result, fenced, seen = path.stem, [], False, {}

    def link(match):
        text, target = match["text"], match["target"]
        file, _, anchor = target.partition("#")
        if "://" in target:
            return match.group(0)
        if file.endswith("fixpair.h"):
            return "[fixpair.h](@ref fixpair.h)"
        if file and ("/" in file or not file.endswith(".md")):
            return text
        stem = Path(file).stem if file else name
        return f"[{text}](@ref {stem}-{anchor})" if anchor else f"[{text}](@ref {stem})"

    for line in path.read_text().split("\n"):
        if line.startswith("```"):
            fenced = not fenced
            line = line.replace("```text", "```").replace("```sh", "```").replace("```rust", "```").replace("```cpp", "```cpp")
        elif not fenced:
            heading = re.match(r"(#+) (.*)", line)
            if heading:
                again = seen[slug(heading[2])] = seen.get(slug(heading[2]), -1) + 1
                anchor = name if len(heading[1]) == 1 else f"{name}-{slug(heading[2])}" + (f"-{again}" if again else "")
                line = f"{line} {{#{anchor}}}"
            parts = re.split(r"(`[^`]*`)", re.sub(r"(?<!!)\[(?P<text>[^]]*)\]\((?P<target>[^)\s]*)\)", link, line))
            line = "".join(part if part.startswith("`") or line.startswith("    ") else re.sub(r"(?<!\\)([<>])", r"\\\1", part) for part in parts)
        result.append(line)
    return "\n".join(result)


def main():
    path = Path(sys.argv[1])
    sys.stdout.write(page(path) if path.suffix == ".md" else Header(path.read_text()).documented())


if __name__ == "__main__":
    main()
