"""The documentation's pages as data: blocks of code, links, headings, inline code."""
import re
from dataclasses import dataclass, field
from pathlib import Path

# text: formulas and output, never executed
LANGUAGES = ("sh", "cpp", "python", "cmake", "json", "text")


@dataclass
class Block:
    """A fenced block of code."""

    language: str
    line: int  # of its first line, counted from 1
    lines: list = field(default_factory=list)
    not_run: str = ""  # the reason in a comment `<!-- not run: reason -->` above it
    needs: str = ""  # programs or modules in a comment `<!-- needs: name,name -->` above it
    steps: str = ""  # of its simulations in a test, in a comment `<!-- steps: 2 -->` above it

    @property
    def text(self):
        return "\n".join(self.lines) + "\n"


@dataclass
class Page:
    """One Markdown file."""

    name: str  # path from the root, e.g. docs/guide.md
    blocks: list = field(default_factory=list)
    links: list = field(default_factory=list)  # (line, target)
    spans: list = field(default_factory=list)  # (line, inline code)
    anchors: set = field(default_factory=set)
    errors: list = field(default_factory=list)


def page_paths(root):
    """All pages: those at the root, then those of docs/."""
    return sorted(root.glob("*.md")) + sorted((root / "docs").glob("*.md"))


def slug_of(heading):
    """The anchor of a heading, as GitHub and MkDocs name it."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def read_page(root, path):
    page = Page(str(path.relative_to(root)))
    block, comment, was_blank = None, "", True
    for number, line in enumerate(path.read_text(encoding="utf8").splitlines(), 1):
        fence = re.match(r"```(\w*)\s*$", line)
        if block is not None:
            if fence:
                block = None
            else:
                block.lines.append(line)
            continue
        if fence:
            block = Block(fence[1], number + 1)
            if block.language not in LANGUAGES:
                languages = ", ".join(LANGUAGES)
                page.errors.append(f"{number}: a block of '{fence[1]}', expected {languages}")
            block.not_run = (re.match(r"<!-- not run: (.*\S) -->$", comment) or ["", ""])[1]
            block.needs = (re.match(r"<!-- needs: (\S+) -->$", comment) or ["", ""])[1]
            block.steps = (re.match(r"<!-- steps: (\d+) -->$", comment) or ["", ""])[1]
            page.blocks.append(block)
        elif was_blank and line.startswith("    ") and line.strip()[:1] not in "-*0123456789":
            page.errors.append(f"{number}: an indented block; fence it and name its language")
        if re.match(r"#+ ", line):
            page.anchors.add(slug_of(line.lstrip("#")))
        page.spans += [(number, span) for span in re.findall(r"`([^`]+)`", line)]
        prose = re.sub(r"`[^`]*`", "``", line)
        page.links += [(number, target) for target in re.findall(r"\]\(([^)\s]+)\)", prose)]
        if line.strip():
            comment = line.strip()
        was_blank = not line.strip()
    if block is not None:
        page.errors.append(f"{block.line}: a block that does not end")
    return page


def read_pages(root):
    return [read_page(root, path) for path in page_paths(Path(root))]
