"""Tables of what cmake/run_on_device.sh measured, from its archive."""
import io
import json
import re
import tarfile

import peers
import rows
from warp_tables import PIXELS, WORKLOAD, counter, figure, ms, sampler_table, table

FILES = ("resident", "warp", "contact", "simulate", "figures", "figures-beside")
NCU_COLUMNS = {
    "Duration": "time",
    "DRAM Throughput": "DRAM",
    "Compute (SM) Throughput": "SM",
    "Registers Per Thread": "registers",
    "Achieved Occupancy": "occupancy",
}


def read_archive(path):
    """{name of a file without folders: its text} of a .tar.gz."""
    with tarfile.open(path) as archive:
        members = [member for member in archive.getmembers() if member.isfile()]
        return {
            member.name.split("/")[-1]: archive.extractfile(member).read().decode(errors="replace")
            for member in members
        }


def measured(texts, name):
    """(context, rows) of NAME.json; ({}, []) where it is missing."""
    if f"{name}.json" not in texts:
        return {}, []
    results = json.loads(texts[f"{name}.json"])
    return results["context"], sorted(rows.parse_rows(results).values(), key=rows.place_of)


def ncu_kernels(text):
    """{kernel: {column: median figure}} of Nsight Compute's --csv output."""
    import csv

    start = text.find('"ID"')
    kernels = {}
    for line in csv.DictReader(io.StringIO(text[start:])) if start >= 0 else ():
        column = NCU_COLUMNS.get(line.get("Metric Name"))
        if column is None:
            continue
        value = re.sub(r"[^0-9.eE+-]", "", line["Metric Value"])
        unit = line["Metric Unit"]
        kernel = re.sub(r"[(<].*", "", line["Kernel Name"]).split("::")[-1]
        body = re.search(r"(\w+(?:Body|Op)\b)", line["Kernel Name"])
        name = f"{kernel} of {body[1]}" if body else kernel
        kernels.setdefault(name, {}).setdefault((column, unit), []).append(float(value or "nan"))
    return {
        name: {key: sorted(values)[len(values) // 2] for key, values in found.items()}
        for name, found in kernels.items()
    }


def ncu_table(kernels):
    lines = []
    for name, found in sorted(kernels.items()):
        figures = ", ".join(
            f"{column} {figure(value)} {unit}".rstrip() for (column, unit), value in found.items()
        )
        lines.append(f"- {name}: {figures}")
    return lines


def sections_of(texts):
    """(machine, [(title, lines)])"""
    sections, machine = [], ""
    for name in FILES:
        context, found = measured(texts, name)
        if not found:
            continue
        machine = machine or rows.machine_of(context)
        if name.startswith("figures"):
            columns = [("row", lambda row: row.name), ms("step, ms"),
                       counter("output voxels", "voxels"), counter("tetrahedra", "tets")]
        elif name == "resident":
            columns = [WORKLOAD, ms("step, ms"), counter("kernels, ms", "kernel"),
                       counter("floor, ms", "floor"), counter("step / floor", "floor_ratio"),
                       counter("step / copy", "copy_ratio")]
        elif name == "warp":
            columns = [("row", lambda row: row.name), PIXELS, ms("whole call, ms"),
                       counter("kernels, ms", "kernel"), counter("floor, ms", "floor"),
                       counter("kernels / floor", "floor_ratio")]
        elif name == "contact":
            columns = [WORKLOAD, ("method", lambda row: row.method),
                       ("numbers", lambda row: row.type), ("solve", lambda row: row.visit),
                       ms("time, ms"), counter("sweeps", "sweeps"), counter("error", "error")]
        else:
            columns = [("step", lambda row: row.name), ms("time, ms"),
                       counter("iterations", "iterations")]
        sections.append((name, table(columns, found)))
        if name == "warp" and "gpu-peers.log" in texts:
            device, times = peers.parse_samplers(texts["gpu-peers.log"])
            sections.append((f"Beside PyTorch and CuPy on {device}", sampler_table(found, times)))
    for name in sorted(texts):
        if name.startswith("ncu-"):
            lines = ncu_table(ncu_kernels(texts[name]))
            sections.append((f"Counters of kernels: {name[4:-4]}", lines))
    return machine, sections


def print_archive(arguments):
    texts = read_archive(arguments.archive)
    machine, sections = sections_of(texts)
    print(f"{machine}\n")
    for title, lines in sections:
        if lines:
            print(f"### {title}\n\n" + "\n".join(lines))
    for name in FILES if arguments.prefix else ():
        if f"{name}.json" in texts:
            path = f"{arguments.prefix}-{name}.json"
            with open(path, "w", encoding="utf-8") as file:
                file.write(texts[f"{name}.json"])
            print(f"wrote {path}")
    return 0


def self_test():
    row = {"run_name": "resident/W1_torso_700/linear/float32/cuda/iterations:1/manual_time",
           "real_time": 0.5, "time_unit": "ms", "kernel": 0.4, "floor": 0.25, "floor_ratio": 2.0,
           "copy_ratio": 3.0}
    results = {"context": {"date": "2026-01-01T00:00", "device": "X"}, "benchmarks": [row]}
    csv = ('"ID","Kernel Name","Metric Name","Metric Unit","Metric Value"\n'
           '"0","void tetwarp::each_kernel<tetwarp::TetSetupOp>(T1)","Duration","us","12.5"\n')
    machine, sections = sections_of({"resident.json": json.dumps(results), "ncu-warp.log": csv})
    assert "X" in machine, machine
    assert "| W1_torso_700 | 0.5 | 0.4 | 0.25 | 2 | 3 |" in sections[0][1], sections[0]
    assert sections[1][1] == ["- each_kernel of TetSetupOp: time 12.5 us"], sections[1]
