#!/usr/bin/env python3
"""Counts the machine instructions that a voxel costs in the kernels of the warp.

Compiles bench/sass/kernels.cu for one architecture, reads `cuobjdump -sass` and prints a table:
registers, stack, spills, resident blocks, and the instructions on the longest path through

* the innermost loop that computes and stores voxels ("stored"), per store to global memory,
* the innermost loop that stores nothing ("tested"), per test of a voxel in a tetrahedron: a turn
  tests four voxels of a thread, or two rows of eight,
* the kernel from its first to its last instruction, every loop taken once ("whole").

Paths that an instruction of AVOID lies on are left out: float64 and calls serve rare voxels only.
Instructions whose predicate is false are counted, as they are issued too.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
REGISTERS, WARPS, BLOCKS = 65536, 64, 32  # of a multiprocessor of sm_90
AVOID = re.compile(r"^(D(ADD|MUL|FMA|SETP)|CALL)\b")
FLOOR = re.compile(r"^(FRND|F2I|FADD\.RM)")  # of a position: in the loop over voxels
INSTRUCTION = re.compile(r"^\s*/\*([0-9a-f]{4,})\*/\s+(?:@(!?U?P\w+)\s+)?([A-Z][\w.]*)([^;]*);")


class Kernel:
    """Instructions of a kernel: (address, predicate, operation, operands)."""

    def __init__(self, name):
        self.name = name
        self.code = []

    def voxels_tested(self):
        """Of a thread, per turn of the loop over tetrahedra: two rows of eight, or raster_depth."""
        return 16 if "cell_group_kernel" in self.name else 4

    def stores_one(self):
        """Whether a turn of the loop handles one voxel, whatever else it may store."""
        return "cell_raster_kernel" in self.name

    def blocks(self):
        """Basic blocks as lists of instruction indices, and the successors of each."""
        place = {line[0]: n for n, line in enumerate(self.code)}
        starts = {0}
        for n, (_, _, operation, operands) in enumerate(self.code):
            base = operation.split(".")[0]
            if base in ("BRA", "EXIT", "RET", "BRX", "WARPSYNC", "BREAK", "BSYNC"):
                starts.add(n + 1)
            if is_branch(operation):
                starts.add(place[target_of(operands)])
        order = sorted(s for s in starts if s < len(self.code))
        ends = order[1:] + [len(self.code)]
        blocks = [range(a, b) for a, b in zip(order, ends)]
        number = {block.start: b for b, block in enumerate(blocks)}
        successors = []
        for b, block in enumerate(blocks):
            _, predicate, operation, operands = self.code[block[-1]]
            base = operation.split(".")[0]
            targets = []
            if is_branch(operation):
                targets.append(number[place[target_of(operands)]])
            always = predicate is None and not re.search(r"\bU?P\d", operands.split("0x")[0])
            stops = (is_branch(operation) or base in ("EXIT", "RET")) and always
            if not stops and b + 1 < len(blocks):
                targets.append(b + 1)
            successors.append([t for t in targets if t != b or is_branch(operation)])
        return blocks, successors


def is_branch(operation):
    """BRA.DIV is taken only by warps that diverged before an exchange, which these kernels do not."""
    return operation.startswith("BRA") and not operation.startswith("BRA.DIV")


def target_of(operands):
    return int(re.findall(r"0x([0-9a-f]+)", operands)[-1], 16)


def reachable(successors):
    found, todo = set(), [0]
    while todo:
        b = todo.pop()
        if b not in found:
            found.add(b)
            todo += successors[b]
    return found


def dominators(successors):
    """Of the blocks that the first one leads to."""
    count = len(successors)
    before = [[] for _ in range(count)]
    for b in reachable(successors):
        for t in successors[b]:
            before[t].append(b)
    found = [set(range(count)) for _ in range(count)]
    found[0] = {0}
    changed = True
    while changed:
        changed = False
        for b in range(1, count):
            sets = [found[p] for p in before[b]]
            new = ({b} | set.intersection(*sets)) if sets else {b}
            if new != found[b]:
                found[b], changed = new, True
    return found, before


def loops_of(successors):
    """Natural loops, innermost first: (head, blocks, blocks that jump back)."""
    found, before = dominators(successors)
    loops = {}
    for b, targets in enumerate(successors):
        for head in targets:
            if head not in found[b]:
                continue
            body, todo = {head}, [b]
            while todo:
                block = todo.pop()
                if block not in body:
                    body.add(block)
                    todo += before[block]
            old = loops.get(head, (set(), set()))
            loops[head] = (old[0] | body, old[1] | {b})
    return sorted(((h, *rest) for h, rest in loops.items()), key=lambda loop: len(loop[1]))


def longest(kernel, blocks, successors, head, body, ends, stores):
    """Longest path (instructions, stores) from head to one of `ends` within body."""
    found, _ = dominators(successors)
    size = []
    for block in blocks:
        lines = [kernel.code[n] for n in block]
        writes = sum(operation.startswith("STG") for _, _, operation, _ in lines)
        size.append((len(lines), writes, any(AVOID.match(line[2]) for line in lines)))
    memo = {}

    def walk(b, has_store):
        if size[b][2]:
            return None
        has_store = has_store or size[b][1] > 0
        if (b, has_store) in memo:
            return memo[b, has_store]
        best = (0, 0) if b in ends and (has_store or not stores) else None
        for t in successors[b]:
            if t not in body or t in found[b]:
                continue
            rest = walk(t, has_store)
            if rest is not None and (best is None or rest > best):
                best = rest
        result = None if best is None else (best[0] + size[b][0], best[1] + size[b][1])
        memo[b, has_store] = result
        return result

    return walk(head, False)


def samples(code):
    """Whether instructions interpolate in float32: floor, eight loads, at least ten products."""
    names = [line[2].split(".")[0] for line in code]
    has_floor = any(FLOOR.match(line[2]) for line in code)
    return has_floor and names.count("LDG") >= 8 and names.count("FFMA") >= 10


def counts_of(kernel):
    """Instructions per stored voxel, per test and of the whole kernel, or None."""
    blocks, successors = kernel.blocks()
    stored = tested = None
    everything = set(range(len(blocks)))
    for head, body, latches in loops_of(successors):
        code = [kernel.code[n] for b in body for n in blocks[b]]
        if any(line[2].startswith("STG") for line in code):
            if not samples(code):
                continue
            path = longest(kernel, blocks, successors, head, body, latches, True)
            if stored is None and path and path[1]:
                stored = path[0] / (1 if kernel.stores_one() else path[1])
        elif sum(line[2].startswith("FFMA") for line in code) >= 12:
            path = longest(kernel, blocks, successors, head, body, latches, False)
            if tested is None and path:
                tested = path[0] / kernel.voxels_tested()
    exits = {b for b, block in enumerate(blocks) if kernel.code[block[-1]][2].startswith("EXIT")}
    whole = longest(kernel, blocks, successors, 0, everything, exits, True)
    return stored, tested, whole


def kernels_of(sass):
    kernels = []
    for line in sass.splitlines():
        if "Function :" in line:
            kernels.append(Kernel(line.split(":", 1)[1].strip()))
        found = INSTRUCTION.match(line)
        if found and kernels:
            address, predicate, operation, operands = found.groups()
            if operation.split(".")[0] != "NOP":
                kernels[-1].code.append((int(address, 16), predicate, operation, operands))
    return kernels


def short(name):
    name = re.sub(r"^void ", "", name).replace("tetwarp::", "").replace("bench::", "")
    return name[: name.rfind("(")].replace("unsigned char", "uint8").replace("short", "int16")


def resources_of(log):
    """name -> (registers, stack, spilled bytes), from ptxas' output."""
    found, name, stack, spilled = {}, "", 0, 0
    for line in log.splitlines():
        if "Compiling entry function" in line:
            name = line.split("'")[1]
        elif "bytes stack frame" in line:
            numbers = [int(n) for n in re.findall(r"\d+", line)]
            stack, spilled = numbers[0], numbers[1] + numbers[2]
        elif "Used" in line and name:
            found[name] = (int(re.search(r"Used (\d+)", line).group(1)), stack, spilled)
            name = ""
    return found


def resident_blocks(registers, threads):
    per_warp = -(-registers * 32 // 256) * 256
    warps = REGISTERS // 4 // per_warp * 4
    return min(BLOCKS, warps // (threads // 32), WARPS // (threads // 32))


def run(*command):
    result = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if result.returncode:
        sys.exit(f"{command[0]} failed:\n{result.stdout}{result.stderr}")
    return result.stdout + result.stderr


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--include", default=str(ROOT / "build/release/include"),
                         help="folder of the headers that the build writes")
    options.add_argument("--architecture", default="sm_90")
    options.add_argument("--cuobjdump", default=os.environ.get("CUOBJDUMP", "cuobjdump"))
    given = options.parse_args()
    for tool in ("nvcc", given.cuobjdump):
        if not shutil.which(tool):
            sys.exit(f"{tool} is missing: it is part of the CUDA toolkit (CUOBJDUMP=FILE names it)")
    with tempfile.TemporaryDirectory() as folder:
        cubin = f"{folder}/kernels.cubin"
        log = run("nvcc", "-std=c++20", "-O3", "-DNDEBUG", f"-arch={given.architecture}", "-cubin",
                  "-Xptxas", "-v", "-DTETWARP_STATIC_DEFINE", "-I.", "-Ihost", "-Ikernels/base",
                  f"-I{given.include}", "-o", cubin, "bench/sass/kernels.cu")
        kernels = kernels_of(run(given.cuobjdump, "-sass", cubin))
    resources = resources_of(log)
    print(f"{'stored':>7} {'tested':>7} {'whole':>6} {'stores':>6} {'regs':>5} {'stack':>6} "
          f"{'spill':>6} {'blocks':>7} {'warps':>6}  kernel")
    for kernel in sorted(kernels, key=lambda k: k.name):
        if kernel.name not in resources:
            continue
        registers, stack, spilled = resources[kernel.name]
        stored, tested, whole = counts_of(kernel)
        name = run("c++filt", kernel.name).strip()
        blocks = resident_blocks(registers, 128)
        print(f"{f'{stored:.1f}' if stored else '-':>7} {f'{tested:.1f}' if tested else '-':>7} "
              f"{whole[0] if whole else '-':>6} {whole[1] if whole else '-':>6} {registers:>5} "
              f"{stack:>6} {spilled:>6} {blocks:>7} {blocks * 4 * 100 // WARPS:>5}%  {short(name)}")


if __name__ == "__main__":
    main()
