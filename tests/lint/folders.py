#!/usr/bin/env python3
"""Checks that includes between folders point one way, from users down to what they use, and that
no folder has more source files than a reader can keep in mind.

    folders.py           fails with one line per include or folder that breaks the rules
    folders.py --dot     prints the include graph of the folders, docs/drawings/folders.dot
    folders.py --test    checks this script on small made-up trees
"""
import re
import sys
from collections import Counter, defaultdict
from pathlib import Path

# Folder -> folders that its files may include from, besides itself. A folder that is not listed may
# include nothing of the project, so a new folder needs a line here.
BASE = ["kernels/base", "kernels/base/tetwarp", "host/tetwarp"]
WARP = ["kernels/warp", "kernels/warp/sample", "kernels/warp/overlap", *BASE]
CONTACT = ["host/base", "host/exec", "kernels/contact", *BASE]
COLLIDE = ["host/base", "host/exec", "kernels/collide", *BASE]
MODEL = ["host/scene", "host/scene/shapes", "host/scene/checks", "host/base", "host/exec", "kernels/body", *BASE]
STEP = ["host/simulate/model", *MODEL]
SURFACES = ["host/simulate/step", "host/simulate/step/cpu", "host/collide", *STEP, *COLLIDE]
SOLVE = ["host/simulate/surfaces", "kernels/contact", *SURFACES]
CLI = ["io/tetwarp", "io/files", "host/base", "host/warp", "host/warp/compose", *BASE]
IO = ["io/tetwarp", "host/base", *BASE]
ALLOWED = {
    "kernels/base": ["kernels/base/tetwarp"],
    "kernels/base/tetwarp": [],
    "kernels/exec": ["kernels/base", "kernels/base/tetwarp"],
    "kernels/warp/sample": ["kernels/base", "kernels/base/tetwarp", "kernels/exec"],
    "kernels/warp": [
        "kernels/warp/sample", "kernels/base", "kernels/base/tetwarp", "kernels/exec"],
    "kernels/warp/overlap": [
        "kernels/warp", "kernels/warp/sample", "kernels/base", "kernels/base/tetwarp", "kernels/exec"],
    "kernels/warp/cuda": [
        "kernels/warp", "kernels/warp/sample", "kernels/base", "kernels/base/tetwarp", "kernels/exec"],
    "kernels/body": ["kernels/base", "kernels/base/tetwarp", "kernels/exec"],
    "kernels/contact": ["kernels/base", "kernels/base/tetwarp", "kernels/body", "kernels/exec"],
    "kernels/contact/cuda": [
        "kernels/contact", "kernels/base", "kernels/base/tetwarp", "kernels/body", "kernels/exec"],
    "kernels/collide": ["kernels/base", "kernels/base/tetwarp", "kernels/exec"],
    "host/tetwarp": ["kernels/base/tetwarp"],
    "host/base": BASE,
    "host/exec": ["host/base", *BASE],
    "host/make": ["host/base", *BASE],
    "host/warp": ["host/base", *WARP],
    "host/warp/stages": ["host/warp", "host/base", *WARP],
    "host/warp/cpu/rows": ["host/warp", "host/warp/stages", "host/base", *WARP],
    "host/warp/cpu": [
        "host/warp", "host/warp/stages", "host/warp/cpu/rows", "host/base", "host/exec", *WARP],
    "host/warp/compose": ["host/warp", "host/base", *WARP],
    "host/warp/cuda": [
        "host/warp", "host/warp/stages", "host/base", "kernels/exec", "kernels/warp/cuda", *WARP],
    "host/reference/linear": [],
    "host/reference/warp": [
        "host/reference/linear", "host/base", "host/tetwarp", "kernels/base/tetwarp"],
    "host/reference/contact": [
        "host/reference/linear", "host/base", "host/tetwarp", "kernels/base/tetwarp"],
    "host/reference/simulate": [
        "host/reference/linear", "host/base", "host/scene", "host/scene/shapes", "host/scene/checks", "host/tetwarp", "kernels/base/tetwarp"],
    "host/contact/problem": CONTACT,
    "host/contact/structure": ["host/contact/problem", *CONTACT],
    "host/contact/newton": ["host/contact/problem", *CONTACT],
    "host/contact/sweeps": ["host/contact/problem", "host/contact/structure", *CONTACT],
    "host/contact/block_jacobi": [
        "host/contact/problem", "host/contact/structure", "host/contact/sweeps", *CONTACT],
    "host/contact/cuda": [
        "kernels/contact/cuda",
        "host/contact/problem", "host/contact/block_jacobi", "host/contact/structure",
        "host/contact/sweeps", "kernels/exec", *CONTACT],
    "host/contact/tracker": ["host/contact/problem", *CONTACT],
    "host/contact/solve": [
        "host/contact/problem", "host/contact/structure", "host/contact/newton",
        "host/contact/sweeps", "host/contact/block_jacobi", "host/contact/cuda",
        "host/reference/contact", *CONTACT],
    "host/contact": [
        "host/contact/problem", "host/contact/structure", "host/contact/newton",
        "host/contact/sweeps", "host/contact/block_jacobi", "host/contact/cuda",
        "host/contact/solve", "host/reference/contact", *CONTACT],
    "host/collide": COLLIDE,
    "host/collide/cpu": ["host/collide", *COLLIDE],
    "host/collide/cuda": ["host/collide", "kernels/exec", *COLLIDE],
    "host/scene/checks": ["host/base", *BASE],
    "host/scene/shapes": ["host/scene/checks", "host/base", "host/exec", *WARP],
    "host/scene": ["host/scene/shapes", "host/scene/checks", "host/base", "host/exec", *WARP],
    "host/simulate/model": MODEL,
    "host/simulate/step": ["host/reference/simulate", *STEP],
    "host/simulate/step/cpu": ["host/simulate/step", *STEP],
    "host/simulate/surfaces": SURFACES,
    "host/simulate/start": ["host/simulate/surfaces", *SURFACES],
    "host/simulate/patches": ["host/simulate/surfaces", *SURFACES],
    "host/simulate/solve/problem": SOLVE,
    "host/simulate/solve/two_level": ["host/simulate/solve/problem", *SOLVE],
    "host/simulate/solve/condensed": ["host/simulate/solve/problem", *SOLVE],
    "host/simulate/solve": [
        "host/simulate/solve/problem", "host/simulate/solve/two_level",
        "host/simulate/solve/condensed", *SOLVE],
    "host/simulate/step/cuda": [
        "host/simulate/solve/problem", "host/simulate/solve/two_level", "kernels/contact/cuda",
        "kernels/exec", *SOLVE],
    "host/simulate/contact_step": [
        "host/simulate/patches", "host/simulate/solve", "host/simulate/solve/problem",
        "host/simulate/solve/two_level", *SOLVE],
    "host/simulate/state": [
        "host/simulate/contact_step", "host/simulate/solve", "host/simulate/solve/problem",
        "host/simulate/solve/two_level", "host/simulate/patches", *SOLVE],
    "host/simulate/run": [
        "host/simulate/state", "host/simulate/contact_step",
        "host/simulate/start", "host/simulate/patches", "host/simulate/solve",
        "host/simulate/solve/problem", "host/simulate/solve/two_level", *SOLVE],
    "io/tetwarp": ["host/tetwarp", "kernels/base/tetwarp"],
    "io/files": IO,
    "io/h5": ["io/files", *IO],
    "io/fclib": ["io/h5", "io/files", *IO],
    "io/nifti": ["io/h5", "io/files", *IO],
    "io/image": ["io/nifti", "io/files", *IO],
    "io/vtkhdf": ["io/image", "io/nifti", "io/h5", "io/files", *IO],
    "io/child": ["io/nifti", "io/files", *IO],
    "io/volume": ["io/child", "io/vtkhdf", "io/image", "io/nifti", "io/h5", "io/files", *IO],
    "io/import": ["io/child", "io/volume", "io/nifti", "io/h5", "io/files", *IO],
    "io/points": ["io/import", "io/vtkhdf", "io/h5", "io/files", *IO],
    "io/reader": ["io/child", "io/import", "io/image", "io/volume", "io/files", *IO],
    "io/scene": ["io/import", "io/files", *IO],
    "io/transforms": ["io/image", "io/nifti", "io/h5", "io/files", *IO],
    "io/picture": ["io/files", *IO],
    "host/view/devices": ["host/base", *BASE],
    "host/view/look": ["io/tetwarp", "io/files", "host/base", *BASE],
    "host/view": ["host/view/devices", "host/view/look", "io/tetwarp", "io/files", "host/base", *BASE],
    "host/view/hand": ["host/view", "host/view/devices", "host/base", *BASE],
    "host/view/screens": ["host/view", "host/view/devices", "host/view/hand", "host/view/look", "io/scene", "io/tetwarp", "host/base", *BASE],
    "host/view/link": ["host/view/screens", "host/base", *BASE],
    "host/view/window": [
        "host/view", "host/view/devices", "host/view/hand", "host/view/look", "host/view/link", "host/view/screens", "io/tetwarp", "io/files", "host/base", *BASE],
    "host/cli/certify": ["host/cli/common", "host/cli/job", *CLI],
    "host/cli/common": CLI,
    "host/cli/contact": ["host/cli/common", *CLI],
    "host/cli/job": ["host/cli/common", "io/volume", *CLI],
    "host/cli/warp/volumes": ["host/cli/common", "host/cli/job", *CLI],
    "host/cli/warp": [
        "host/cli/warp/volumes", "host/cli/common", "host/cli/job", "io/scene", *CLI],
    "host/cli/simulate": ["host/cli/common", "host/cli/job", "host/view/look", "io/vtkhdf", *CLI],
    "host/cli/view": ["host/cli/common", "host/view", *CLI],
    "host/cli/tools": ["host/cli/common", "host/cli/job", "host/cli/warp", "host/view/look", "io/fclib",
                       "io/vtkhdf", *CLI],
    "host/cli": ["host/cli/common", *CLI],
}
MOST_FILES = {"kernels": 40, "host": 40, "io": 40, "bench": 40, "tests": 60}  # of one folder
SOURCES = (".hpp", ".cpp", ".cu", ".cuh")
INCLUDE_ROOTS = ["host", "io", "kernels/base"]  # of headers named <tetwarp/...>
INCLUDE = re.compile(r'\s*#\s*include\s*[<"]([^>"]+)[>"]')


def includes(root):
    """Yields (file, included file) for all includes of project files by project files."""
    files = {}
    for top in ("kernels", "host", "io"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in SOURCES:
                files[path.relative_to(root).as_posix()] = path
    for name, path in files.items():
        for line in path.read_text(encoding="utf-8").splitlines():
            match = INCLUDE.match(line)
            if not match:
                continue
            for candidate in [match[1], *(f"{r}/{match[1]}" for r in INCLUDE_ROOTS)]:
                if candidate in files:
                    yield name, candidate
                    break


def folder_of(name):
    return name.rsplit("/", 1)[0]


def violations(root, allowed=ALLOWED):
    for name, included in includes(root):
        here, there = folder_of(name), folder_of(included)
        if here != there and there not in allowed.get(here, []):
            yield f"{name} includes {included}: {here} must not depend on {there}"


def crowded(root, most=MOST_FILES):
    for top, limit in most.items():
        counts = Counter(path.parent for path in (root / top).rglob("*") if path.suffix in SOURCES)
        for folder, count in sorted(counts.items()):
            if count > limit:
                yield f"{folder.relative_to(root).as_posix()} has {count} source files, more than {limit}"


def cycle_in(edges):
    """One cycle of a graph {folder: folders}, as a list, or None."""
    done, path = set(), []

    def visit(folder):
        if folder in path:
            return path[path.index(folder):] + [folder]
        if folder in done:
            return None
        path.append(folder)
        for other in sorted(edges.get(folder, ())):
            found = visit(other)
            if found:
                return found
        path.pop()
        done.add(folder)
        return None

    return next((c for c in map(visit, sorted(edges)) if c), None)


def graph(root):
    edges = defaultdict(set)
    for name, included in includes(root):
        if folder_of(name) != folder_of(included):
            edges[folder_of(name)].add(folder_of(included))
    return edges


COLORS = {  # of drawings, by the longest folder that contains a folder
    "kernels/base/tetwarp": "#fff6c9", "host/tetwarp": "#fff6c9", "io/tetwarp": "#fff6c9",
    "kernels/warp": "#d9e7f5", "host/warp": "#d9e7f5", "host/reference/warp": "#d9e7f5",
    "kernels/contact": "#dcefdc", "host/contact": "#dcefdc", "host/reference/contact": "#dcefdc",
    "kernels/collide": "#e6dcf2", "host/collide": "#e6dcf2",
    "kernels/body": "#fbe3d0", "host/simulate": "#fbe3d0", "host/scene": "#fbe3d0",
    "host/reference/simulate": "#fbe3d0", "host/cli": "#f3e6d4", "io": "#f3e6d4",
}


def color_of(folder):
    while folder and folder not in COLORS:
        folder = folder.rpartition("/")[0]
    return COLORS.get(folder, "white")


def without_implied(edges):
    """The edges of a graph without cycles that do not follow from others."""

    def reachable(folder):
        return set().union(*({other} | reachable(other) for other in edges.get(folder, ())))

    return {folder: {other for other in others if not any(
                other in reachable(third) for third in others)}
            for folder, others in edges.items()}


def print_dot(edges):
    print("""// Which folder includes which, without edges that follow from others: written by
// tests/lint/folders.py --dot; ./dev docs draws it.
digraph folders {
  graph [rankdir=TB, nodesep=0.15, ranksep=0.4]
  node [shape=box, style="filled,rounded", fontname="Helvetica", fontsize=11, color="#666666",
        margin="0.08,0.04"]
  edge [color="#666666", arrowsize=0.7]""")
    for folder in sorted({*edges, *(other for others in edges.values() for other in others)}):
        print(f'  "{folder}" [fillcolor="{color_of(folder)}"]')
    for folder, others in sorted(without_implied(edges).items()):
        print(f'  "{folder}" -> {{' + " ".join(f'"{other}"' for other in sorted(others)) + "}")
    print("}")


def test():
    """The rules have no cycle, and files that break them are found."""
    import tempfile

    assert cycle_in(ALLOWED) is None, cycle_in(ALLOWED)
    assert cycle_in({"a": ["b"], "b": ["c"], "c": ["b"]}) == ["b", "c", "b"]
    assert without_implied({"a": {"b", "c"}, "b": {"c"}}) == {"a": {"b"}, "b": {"c"}}
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name, text in {
            "kernels/base/view.hpp": "#include <vector>\n",
            "kernels/warp/tet.hpp": '#include "kernels/base/view.hpp"\n',
            "host/tetwarp/warp.hpp": "",
            "host/warp/run.cpp": '#include <tetwarp/warp.hpp>\n#include "kernels/warp/tet.hpp"\n',
        }.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        assert not list(violations(root))
        (root / "kernels/base/bad.hpp").write_text("# include <tetwarp/warp.hpp>\n")
        assert list(violations(root)) == [
            "kernels/base/bad.hpp includes host/tetwarp/warp.hpp: "
            "kernels/base must not depend on host/tetwarp"]
        assert not list(crowded(root, {"kernels": 2}))
        assert list(crowded(root, {"kernels": 1, "host": 1})) == [
            "kernels/base has 2 source files, more than 1"]


def main():
    root = Path(__file__).resolve().parents[2]
    if "--test" in sys.argv:
        test()
    if "--dot" in sys.argv:
        return print_dot(graph(root))
    found = [*violations(root), *crowded(root)]
    if not found and cycle_in(graph(root)):
        found = [f"cycle of folders: {' -> '.join(cycle_in(graph(root)))}"]
    print("\n".join(found) or "includes between folders point one way")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
