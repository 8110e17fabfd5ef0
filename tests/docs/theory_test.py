# SPDX-License-Identifier: Apache-2.0
"""Whether the pages of docs/ name what exists.

All pages: citations resolve in references.bib (and every entry there is cited), relative links lead somewhere.
Pages of docs/theory: what stands in backticks exists: files, tests `Suite.Name`, functions `name()`, other identifiers.
An argument names another copy of the repository to check.
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
root = root if len(sys.argv) > 1 else root.parents[2]
failures = []
counts = {}

SOURCES = {".hpp", ".cpp", ".cu", ".cuh"}
CITATION = re.compile(r"\[([A-Z][A-Za-z]+\d{4}[a-z]?)\]")
PATH = re.compile(r"(?:src|tests|include|docs|tools)(?:/[\w.-]+)+")
TEST = re.compile(r"[A-Z]\w*\.[A-Z]\w*")
FUNCTION = re.compile(r"(?:\w+::)*(\w+)\(\)")
IDENTIFIER = re.compile(r"[A-Za-z_]\w+(?:::\w+)*")


def files_of(*folders):
    return [f for folder in folders for f in sorted((root / folder).rglob("*")) if f.is_file()]


def text_of(files):
    return "\n".join(f.read_text() for f in files)


def fail(page, message):
    failures.append(f"{page.relative_to(root)}: {message}")


def check(kind, page, good, message):
    counts[kind] = counts.get(kind, 0) + 1
    if not good:
        fail(page, message)


pages = [f for f in files_of("docs") if f.suffix == ".md"]
code = text_of(f for f in files_of("src", "include") if f.suffix in SOURCES)
words = set(re.findall(r"\w+", code))
macro = r"^\s*(?:TEST|TEST_F|TEST_P|TYPED_TEST|TYPED_TEST_P)\(\s*(\w+)\s*,\s*(\w+)\s*\)"
tests = {".".join(names) for names in re.findall(macro, text_of(f for f in files_of("tests") if f.suffix == ".cpp"), re.M)}
bib = root / "docs/references.bib"
entries = re.findall(r"^@\w+\{(\w+),", bib.read_text(), re.M)


def is_function(name):
    """A call or definition, template arguments or not."""
    return re.search(rf"\b{name}\s*(?:<[^;(){{}}]*>)?\s*\(", code) is not None


def check_links(page, prose):
    for link in re.findall(r"\]\(([^)\s]+)\)", prose):
        target = link.split("#")[0]
        if "://" not in link and target:
            check("links", page, (page.parent / target).exists(), f"link to {link}, which is not there")


def check_name(page, span):
    """One thing in backticks on a page of docs/theory."""
    if PATH.fullmatch(span):
        check("paths", page, (root / span).exists(), f"`{span}` does not exist")
    elif TEST.fullmatch(span):
        check("tests", page, span in tests, f"`{span}` is no test")
    elif FUNCTION.fullmatch(span):
        check("functions", page, is_function(FUNCTION.fullmatch(span)[1]), f"`{span}` is not in src/ or include/")
    elif IDENTIFIER.fullmatch(span) and ("_" in span or not span.islower()):
        check("identifiers", page, all(part in words for part in span.split("::")), f"`{span}` is not in src/ or include/")


cited = set(CITATION.findall(code))
for page in pages:
    prose = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    keys = CITATION.findall(prose)
    cited.update(keys)
    for key in keys:
        check("citations", page, key in entries, f"citation [{key}] is not in references.bib")
    check_links(page, prose)
    if page.parent == root / "docs/theory":
        for span in re.findall(r"`([^`\n]+)`", prose):
            check_name(page, span)

for key in entries:
    check("entries", bib, key in cited, f"{key} is cited nowhere")
    check("entries", bib, entries.count(key) == 1, f"{key} is there twice")

index = root / "docs/theory/README.md"
for page in sorted((root / "docs/theory").glob("*.md")):
    if page != index:
        check("pages", index, f"]({page.name})" in index.read_text(), f"no link to {page.name}")
for kind in ("citations", "links", "paths", "tests", "functions", "identifiers", "entries", "pages"):
    if not counts.get(kind):
        failures.append(f"no {kind} were found: the check does not see the pages")

print("\n".join(sorted(set(failures))) or "theory: " + ", ".join(f"{n} {kind}" for kind, n in counts.items()) + " are fine")
sys.exit(bool(failures))
