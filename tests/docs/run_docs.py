#!/usr/bin/env python3
"""Runs what the documentation shows: README.md, the other pages at the root and docs/*.md.

    run_docs.py extract ROOT FILE    writes the C++ blocks of all pages as one program
    run_docs.py run ROOT --command FILE --blocks PROGRAM [--mpirun FILE] [--has gmsh] [--has view] [--has vtk] [--has gdcm]
                [--python FILE --package FOLDER]

Blocks of a page run in order in one empty folder, which holds head.nii.gz and labels.nii.gz; blocks
of C++ are functions of PROGRAM, blocks of Python a program that grows from block to block. Checked
as well: links, paths and options in inline code, sizes of pictures, that every option of the
command is explained, and that docs/formats.md names every field of the reports that its commands
write.
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from pages import read_pages
from small_images import write_images

MOST_NOT_RUN = 10
LARGEST_PICTURE = 150 * 1024  # bytes
LIBRARIES = ("gdcm", "gmsh", "view", "vtk")  # that a build may be without
SECONDS = 60  # that a block may take
SOURCE_FOLDERS = ("bench", "cmake", "docs", "examples", "host", "io", "kernels", "python", "tests")


def key_of(page, block):
    """What a block of C++ is called in the program."""
    return f"{page.name}:{block.line}"


# ---- extract: one program of all blocks of C++ --------------------------------------------------


def function_of(page, block, name):
    """A block as a function `name` in a namespace; its includes apart."""
    includes = [line for line in block.lines if line.startswith("#include")]
    body = ["" if line.startswith("#include") else line for line in block.lines]
    text = "\n".join(body)
    if re.search(r"^int main\(", text, re.M):
        text = re.sub(r"^int main\(\)", "int run()", text, flags=re.M)
    else:
        text = "int run() {\n" + f'#line {block.line} "{page.name}"\n' + text + "\nreturn 0;\n}"
    line = f'#line {block.line} "{page.name}"\n'
    return includes, f"namespace {name} {{\n{line}{text}\n}}\n"


def extract(root, output):
    includes, functions, table = [], [], []
    for page in read_pages(root):
        for block in page.blocks:
            if block.language != "cpp" or block.not_run:
                continue
            name = f"block_{len(table)}"
            some_includes, function = function_of(page, block, name)
            includes += [line for line in some_includes if line not in includes]
            functions.append(function)
            table.append(f'    {{"{key_of(page, block)}", {name}::run}},\n')
    output.write_text(
        "// Written by tests/docs/run_docs.py.\n"
        + "\n".join(includes + ["#include <cstdio>", "#include <exception>", "#include <string>"])
        + "\n\n"
        + "\n".join(functions)
        + "\nint main(int, char** words) try {\n"
        + "  const struct { std::string name; int (*run)(); } blocks[] = {\n"
        + "".join(table)
        + "  };\n  for (const auto& block : blocks) {\n"
        + "    if (block.name == words[1]) return block.run();\n  }\n"
        + '  std::fprintf(stderr, "no block %s\\n", words[1]);\n  return 2;\n'
        + "} catch (const std::exception& error) {\n"
        + '  std::fprintf(stderr, "%s\\n", error.what());\n  return 1;\n}\n',
        encoding="utf8",
    )


# ---- run ----------------------------------------------------------------------------------------


def environment_of(arguments):
    bin_folder = arguments.command.resolve().parent
    return os.environ | {
        "PATH": os.pathsep.join([str(bin_folder), os.environ.get("PATH", "")]),
        "OMP_WAIT_POLICY": "passive",
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
    }


def run_block(words, folder, environment, tries):
    """What went wrong, or nothing. Open MPI 4.1 hangs now and then: such blocks are tried again."""
    for _ in range(tries):
        try:
            done = subprocess.run(
                words, cwd=folder, env=environment, timeout=SECONDS / tries, text=True,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            )
        except subprocess.TimeoutExpired:
            continue
        return f"exit status {done.returncode}\n{done.stdout}" if done.returncode else ""
    return f"more than {SECONDS / tries:.0f} s"


def shortened(block):
    """The text of a block with the number of steps of its simulations in a test; 0: they only print their scenes,
    after their options have been checked."""
    if not block.steps:
        return block.text
    limit = "--print" if block.steps == "0" else f"--steps {block.steps}"
    return re.sub(r" --steps \d+", "", block.text).replace("tetwarp simulate", f"tetwarp simulate {limit}")


def imports(python, name, environment):
    """Whether an interpreter can import a module."""
    words = [python, "-c", f"import {name}"]
    return subprocess.run(words, env=environment, capture_output=True).returncode == 0


class Runner:
    def __init__(self, arguments, scratch):
        self.arguments = arguments
        self.scratch = scratch
        self.environment = environment_of(arguments)
        self.errors = []
        self.not_run = []
        self.counts = {}
        self.with_package = self.environment | {"PYTHONPATH": str(arguments.package)}
        self.has_package = bool(arguments.python) and imports(
            arguments.python, "tetwarp", self.with_package)

    def has(self, name):
        """Whether this build or, for other names, the python3 of the blocks has it."""
        if name == "mpirun":
            return bool(self.arguments.mpirun)
        if name in LIBRARIES:
            return name in self.arguments.has
        return imports("python3", name, self.environment)

    def folder_of(self, page):
        return self.scratch / page.name.replace("/", "_")

    def run_page(self, page):
        folder = self.folder_of(page)
        folder.mkdir()
        write_images(folder)
        program = ""  # all blocks of Python so far
        self.errors += [f"{page.name}:{error}" for error in page.errors]
        for block in page.blocks:
            where = f"{page.name}:{block.line}"
            if block.language == "text":
                continue
            if block.not_run:
                self.not_run.append(f"{where}: {block.not_run}")
                continue
            missing = [name for name in block.needs.split(",") if name and not self.has(name)]
            if missing:
                print(f"left out: {where}: there is no {', '.join(missing)}")
                continue
            if block.language == "python":
                if not self.has_package:
                    print(f"left out: {where}: there is no Python package, or no NumPy")
                    continue
                program += block.text
                block.lines = program.splitlines()
            problem = self.run_one(page, block, folder)
            if problem:
                self.errors.append(f"{where}: {problem}")
            self.counts[block.language] = self.counts.get(block.language, 0) + 1

    def run_one(self, page, block, folder):
        if block.language == "sh":
            words = ["bash", "-euo", "pipefail", "-c", shortened(block)]
            if block.needs == "mpirun":  # Open MPI has leaks
                environment = self.environment | {"ASAN_OPTIONS": "detect_leaks=0"}
                with tempfile.TemporaryDirectory(prefix="tetwarp-mpi-") as sockets:
                    environment["OMPI_MCA_orte_tmpdir_base"] = sockets
                    return run_block(words, folder, environment, 3)
            return run_block(words, folder, self.environment, 1)
        if block.language == "cpp":
            words = [str(self.arguments.blocks.resolve()), key_of(page, block)]
            return run_block(words, folder, self.environment, 1)
        if block.language == "python":
            words = [self.arguments.python, "-c", block.text]
            return run_block(words, folder, self.with_package, 1)
        if block.language == "json":
            try:
                json.loads(block.text)
            except ValueError as error:
                return str(error)
            return ""
        return "is of a language that this test cannot run; say why in <!-- not run: reason -->"


# ---- checks of what is not a block --------------------------------------------------------------


def link_errors(root, pages):
    anchors = {page.name: page.anchors for page in pages}
    for page in pages:
        for line, target in page.links:
            if re.match(r"https?://\S+\.\S+", target):
                continue
            path, _, anchor = target.partition("#")
            file = ((root / page.name).parent / path).resolve() if path else root / page.name
            name = os.path.relpath(file, root)
            if not file.exists():
                yield f"{page.name}:{line}: no file {target}"
            elif anchor and anchor not in anchors.get(name, ()):
                yield f"{page.name}:{line}: no heading {target}"
            elif file.suffix == ".png" and file.stat().st_size > LARGEST_PICTURE:
                yield f"{page.name}:{line}: {target} has more than {LARGEST_PICTURE} bytes"


def help_of(environment, *words):
    return subprocess.run([*words], env=environment, capture_output=True, text=True).stdout


def options_in(text):
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text))


def command_options(environment):
    """Every --option of the command."""
    names = re.findall(r"^  ([a-z]+) {2}", help_of(environment, "tetwarp", "--help"), re.M)
    texts = (help_of(environment, "tetwarp", name, "--help") for name in names)
    return set().union(*map(options_in, texts))


def option_errors(root, pages, environment):
    """Options that do not exist, and options of the command that no page explains."""
    known = command_options(environment)
    of_dev = options_in(help_of(environment, str(root / "dev"), "help"))
    for page in pages:
        for line, span in page.spans:
            if re.match(r"(tetwarp |\./dev |--[a-z])", span):
                for option in sorted(options_in(span) - known - of_dev - {"--help", "--version"}):
                    yield f"{page.name}:{line}: no option {option}"
    explained = set().union(
        *(options_in(span) for page in pages for _, span in page.spans),
        *(options_in(block.text) for page in pages for block in page.blocks),
    )
    for option in sorted(known - explained - {"--help", "--output"}):
        yield f"no page explains the option {option}"


def path_errors(root, pages):
    """Paths of sources that do not exist."""
    for page in pages:
        for line, span in page.spans:
            is_path = re.fullmatch(rf"({'|'.join(SOURCE_FOLDERS)})/[\w./-]*", span)
            is_pattern = re.search("NAME|ITEM", span)  # a name to choose
            if is_path and not is_pattern and not (root / span).exists():
                yield f"{page.name}:{line}: no file {span}"


def keys_of(value):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield key
            yield from keys_of(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from keys_of(inner)


def field_errors(pages, runner):
    """Fields of the reports that docs/formats.md does not name."""
    for page in (page for page in pages if page.name == "docs/formats.md"):
        named = {span for _, span in page.spans}
        reports = sorted(runner.folder_of(page).glob("*report.json"))
        if not reports:
            yield f"{page.name}: no command writes a file named *report.json"
        for report in reports:
            for key in sorted(set(keys_of(json.loads(report.read_text()))) - named):
                yield f"{page.name}: field '{key}' of {report.name} is missing"


def run(arguments):
    root = arguments.root.resolve()
    pages = read_pages(root)
    with tempfile.TemporaryDirectory(prefix="tetwarp-docs-") as scratch:
        runner = Runner(arguments, Path(scratch))
        for page in pages:
            runner.run_page(page)
        errors = runner.errors
        errors += field_errors(pages, runner)
    errors += link_errors(root, pages)
    errors += option_errors(root, pages, runner.environment)
    errors += path_errors(root, pages)
    for reason in runner.not_run:
        print(f"not run: {reason}")
    counts = ", ".join(f"{count} of {language}" for language, count in runner.counts.items())
    links = sum(len(page.links) for page in pages)
    print(f"{len(pages)} pages, {links} links; blocks run: {counts}")
    print(f"not run: {len(runner.not_run)} of at most {MOST_NOT_RUN}")
    if len(runner.not_run) > MOST_NOT_RUN:
        errors.append(f"{len(runner.not_run)} blocks are not run, more than {MOST_NOT_RUN}")
    for error in errors:
        print(f"error: {error}", file=sys.stderr)
    return 1 if errors else 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("action", choices=("extract", "run"))
    parser.add_argument("root", type=Path)
    parser.add_argument("output", type=Path, nargs="?")
    parser.add_argument("--command", type=Path)
    parser.add_argument("--blocks", type=Path)
    parser.add_argument("--mpirun", default="")
    parser.add_argument("--python", default="")
    parser.add_argument("--package", type=Path)
    parser.add_argument("--has", action="append", default=[], choices=("", *LIBRARIES))
    arguments = parser.parse_args()
    if arguments.action == "extract":
        return extract(arguments.root.resolve(), arguments.output)
    return run(arguments)


if __name__ == "__main__":
    sys.exit(main())
