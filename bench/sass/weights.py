#!/usr/bin/env python3
"""Operations of the basic blocks of kernels that g++ compiled for the emulated device.

Reads the disassembly of a program whose kernels call a counter from every basic block
(tests/emulator/launch_counter.hpp) and returns for each block the address to which that call
returns, and the sum of the weights of the block's instructions: how many instructions a device
needs for the same, roughly. Loads, stores and copies weigh nothing: accesses are counted where they
happen, and what lies on the stack here is in registers there. Instructions of the emulation itself
and of the standard library are left out.
"""
import bisect
import re
import subprocess

COUNTER, ACCESS = "<__sanitizer_cov_trace_pc", "<__asan_"
FREE = ("push", "pop", "ret", "nop", "jmp", "call", "endbr", "vzero", "leave", "cs", "data16",
        "xchg", "lock", "mov", "vmov", "hlt", "ud2")
INSTRUCTION = re.compile(r"^\s*([0-9a-f]+):\t(?:rep[nz]* |notrack |bnd )*(\S+)\s*([^#]*)")
WIDE = re.compile(r"%r(?:[a-d]x|[sd]i|[sb]p|\d+)$")  # registers of 64 bits


def weight_of(operation, operands):
    """Instructions of a device for one of x86-64."""
    last = operands.rsplit(",", 1)[-1]
    is_wide = WIDE.search(last) is not None
    if "%rsp" in last and "(" not in last:
        return 0
    if re.match(r"mov[sz][bwl]|clt|cwt|cqt", operation):  # to more bits; not movss, movsd
        return 0 if "(" in operands else 1
    if operation.startswith(FREE):
        return 0
    if "xor" in operation and len(set(operands.split(","))) == 1:  # a zero
        return 0
    if re.match(r"i?div", operation):
        return 60 if is_wide else 20
    if re.match(r"i?mul|mulx", operation):
        return 1 if not is_wide else 8 if "," not in operands or operation == "mulx" else 4
    if re.match(r"v(div|sqrt)", operation):
        return 20 if operation.endswith("d") else 8
    if re.match(r"v(add|sub|mul|min|max|fn?m(add|sub))\w*[sp]d$", operation):
        return 2  # float64 at half the rate
    if is_wide and not re.match(r"lea|set|cmov|popcnt|[lt]zcnt|vcvt|bsf|bsr|adc|sbb", operation):
        return 2
    return 1


def disassembly(program):
    return subprocess.run(["objdump", "-d", "--no-show-raw-insn", program], check=True,
                          capture_output=True, text=True).stdout


class Lines:
    """The file that the instruction at an address comes from, by the program's line table."""

    def __init__(self, program):
        table = subprocess.run(["objdump", "--dwarf=decodedline", "-WL", program], check=True,
                               capture_output=True, text=True).stdout
        found = {}
        for line in table.splitlines():
            parts = re.match(r"(\S+)\s+(\d+|-)\s+0x([0-9a-f]+)", line)
            if parts:
                found[int(parts[3], 16)] = parts[1] if parts[2] != "-" else ""
        self.starts = sorted(found)
        self.files = [found[start] for start in self.starts]

    def file_of(self, address):
        place = bisect.bisect(self.starts, address) - 1
        return self.files[place] if place >= 0 else ""


def weights_of(text, is_kernel):
    """Address to which a call of the counter returns -> operations: of the basic block, 1 of an
    access. text: what objdump -d prints; is_kernel(address)."""
    weights, block = {}, None
    is_start = is_access = False
    argument = 0  # weight of what sets the argument of the next call
    for line in text.splitlines():
        if line.endswith(">:"):
            block = None
        found = INSTRUCTION.match(line)
        if not found:
            continue
        address, operation, operands = int(found[1], 16), found[2], found[3].strip()
        if is_access and is_kernel(address):
            weights[address] = 1
        if is_start:
            block = address
            weights[block] = 0
        is_access = operation.startswith("call") and ACCESS in operands
        is_start = operation.startswith("call") and COUNTER in operands
        if block is None or is_start or not is_kernel(address):
            continue
        weight = weight_of(operation, operands)
        weights[block] += weight
        if operands.endswith("%rdi"):
            argument = weight
        elif is_access:
            weights[block] -= argument
            argument = 0
    return weights
