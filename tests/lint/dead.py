#!/usr/bin/env python3
"""Lists functions of kernels, host and io that only tests reach.

    dead.py BUILD --programs FILE...   fails with one line per function that is compiled in BUILD and
                                       in none of these programs, from which the linker has removed
                                       what they do not reach (--gc-sections)
    dead.py --test                     checks this script on made-up names

A template counts as reached if any of its instances is. Functions that a public header declares
need no caller, nor do constructors, destructors and operators other than calls.
"""
import argparse
import re
import subprocess
import sys
from pathlib import Path

SOURCE_SUFFIXES = (".hpp", ".cpp", ".cu", ".cuh")
PUBLIC = ("host/tetwarp", "io/tetwarp", "kernels/base/tetwarp")
# Functions that only tests reach and that stay, each with its reason.
ALLOWED = {}


def without_brackets(name, opening, closing):
    """The name without what stands between brackets, `operator` names excepted."""
    depth, kept = 0, []
    for character in name:
        if character == opening:
            depth += 1
        elif character == closing and depth:
            depth -= 1
        elif depth == 0:
            kept.append(character)
    return "".join(kept)


def plain_name(symbol):
    """`tetwarp::A::f` of a demangled function of the project, or None."""
    symbol = symbol.replace("(anonymous namespace)::", "").replace("operator()", "operator_call")
    symbol = re.sub(r"\[abi:\w+\]", "", symbol)
    if re.search(r"operator[^\w]|\{lambda|~|^(guard|vtable|typeinfo|VTT|non-virtual) ", symbol):
        return None
    name = without_brackets(without_brackets(symbol, "<", ">"), "(", ")").split(" const")[0]
    name = name.split(" [clone")[0].split()[-1] if name.split() else ""
    parts = name.split("::")
    if parts[0] != "tetwarp" or len(parts) < 2:
        return None
    if len(parts) > 2 and parts[-1] == parts[-2]:
        return None  # a constructor
    return name


def functions_in(files):
    """Plain names of the functions that object files, archives or programs define."""
    names = set()
    for first in range(0, len(files), 100):
        listing = subprocess.run(
            ["nm", "-C", "--defined-only", *files[first:first + 100]], capture_output=True, text=True,
            check=True).stdout
        for line in listing.splitlines():
            match = re.match(r"[0-9a-f]+ [tTwWuV] (.*)", line)
            name = plain_name(match[1]) if match else None
            if name:
                names.add(name)
    return names


def words_of(root, folders):
    words = set()
    for folder in folders:
        for path in (root / folder).rglob("*"):
            if path.suffix in SOURCE_SUFFIXES:
                words |= set(re.findall(r"\w+", path.read_text(encoding="utf-8")))
    return words


def unreached(compiled, reached, own, public):
    """Names of compiled functions that are not reached, of the project's own and not public ones."""
    def last(name):
        parts = name.split("::")
        return parts[-2] if parts[-1] == "operator_call" else parts[-1]
    return sorted(
        name for name in compiled - reached
        if last(name) in own and last(name) not in public and name not in ALLOWED)


def test():
    assert plain_name("tetwarp::View<int const>::size() const") == "tetwarp::View::size"
    assert plain_name("void tetwarp::(anonymous namespace)::f<int>(int)") == "tetwarp::f"
    assert plain_name("tetwarp::AddOp::operator()(long) const") == "tetwarp::AddOp::operator_call"
    assert plain_name("tetwarp::Volume::Volume(int)") is None
    assert plain_name("std::vector<tetwarp::Volume>::size() const") is None
    compiled = {"tetwarp::f", "tetwarp::g", "tetwarp::h", "tetwarp::helper_of_test"}
    assert unreached(compiled, {"tetwarp::f"}, {"f", "g", "h"}, {"h"}) == ["tetwarp::g"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", nargs="?")
    parser.add_argument("--programs", nargs="+", default=[])
    parser.add_argument("--test", action="store_true")
    arguments = parser.parse_args()
    if arguments.test:
        test()
        return 0
    root = Path(__file__).resolve().parents[2]
    objects = [str(path) for path in Path(arguments.build).rglob("*.o")]
    found = unreached(functions_in(objects), functions_in(arguments.programs),
                      words_of(root, ("kernels", "host", "io")), words_of(root, PUBLIC))
    for name in found:
        print(f"only tests reach {name}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
