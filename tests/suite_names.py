#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that the name of each test suite belongs to something that exists, so that no suite keeps the name of a class
that is gone. Without "Test", a name is one of these: an identifier of the product or of tests/support and tests/scenes;
one that begins with two words that are such an identifier; one that begins with its file's name. Suites of programs
begin with Programs, those of the Falcon with Falcon. Run: tests/suite_names.py"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SUITE = re.compile(r"^(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+)", re.MULTILINE)
ENDINGS = {".cpp", ".hpp", ".h", ".js"}


def read_identifiers():
    """Returns all identifiers of the product, in lower case and without lines. A member (`name_`) names nothing."""
    found = set()
    for folder in ("common", "server", "client", "tests/support", "tests/scenes"):
        for file in (ROOT / folder).rglob("*"):
            if file.suffix in ENDINGS:
                words = re.findall(r"\b[A-Za-z_]\w*(?<!_)\b", file.read_text(encoding="utf-8"))
                found.update(word.lower().replace("_", "") for word in words)
    return found


def belongs(suite, file, identifiers):
    name = re.sub(r"Test$", "", suite)
    lower = name.lower()
    stem = file.stem.removesuffix("_test").replace("_", "")
    words = re.findall(r"[A-Z][a-z0-9]*", name)
    beginnings = (stem, file.parent.name + stem, "programs", "falcon")
    return (lower in identifiers or lower.rstrip("s") in identifiers or lower.startswith(beginnings)
            or stem.startswith(lower) or (len(words) > 2 and "".join(words[:2]).lower() in identifiers))


def main():
    identifiers = read_identifiers()
    suites = {(suite, file) for file in (ROOT / "tests").rglob("*.cpp") if "build" not in file.parts
              for suite in SUITE.findall(file.read_text(encoding="utf-8"))}
    if len(suites) < 100 or len(identifiers) < 1000:
        sys.exit(f"only {len(suites)} suites and {len(identifiers)} identifiers below {ROOT}: wrong folder?")
    strangers = sorted(f"{file.relative_to(ROOT)}: {suite}" for suite, file in suites
                       if not belongs(suite, file, identifiers))
    if strangers:
        sys.exit("these suites have names of nothing that exists; begin them with their file's name:\n" +
                 "\n".join(strangers))
    print(f"{len(suites)} suites have names of things that exist")


if __name__ == "__main__":
    main()
