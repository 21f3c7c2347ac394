#!/usr/bin/env python3
"""Tables, plots and comparisons of results files.

A results file is what a benchmark program wrote with --benchmark_out, or tetwarp_bench_peers.
"""
import argparse
import os
import sys

import compare
import contact_tables
import device
import figures
import peers
import rows
import warp_tables


def print_tables(arguments):
    solves = peers.read(arguments.peers, peers.parse_solves) if arguments.peers else []
    for path in arguments.files:
        results = rows.read_json(path)
        if "rows" in results:
            print(", ".join(str(results[key]) for key in ("date", "processor", "note")) + "\n")
            sections = [("Beside other programs, ms", warp_tables.beside_table(results))]
        else:
            context, by_name = rows.read_rows(path)
            found = list(by_name.values())
            print(rows.machine_of(context) + "\n")
            if rows.is_contact(found):
                sections = contact_tables.sections(found, solves)
            else:
                sections = warp_tables.sections(found)
                if arguments.gpu_peers:
                    device, times = peers.read(arguments.gpu_peers, peers.parse_samplers)
                    title = f"Beside PyTorch and CuPy on {device}"
                    sections.append((title, warp_tables.sampler_table(found, times)))
        for title, lines in sections:
            if lines:
                print(f"### {title}\n\n" + "\n".join(lines))
    return 0


def draw_plots(arguments):
    import contact_plots
    import warp_plots
    from chart import Chart

    solves = peers.read(arguments.peers, peers.parse_solves) if arguments.peers else []
    os.makedirs(arguments.folder, exist_ok=True)
    for path in arguments.files:
        context, by_name = rows.read_rows(path)
        Chart.machine = rows.machine_of(context)
        found = list(by_name.values())
        if rows.is_contact(found):
            contact_plots.draw(found, solves, arguments.folder)
        else:
            warp_plots.draw(found, arguments.folder)
    return 0


def draw_figures(arguments):
    files = []
    for path in arguments.files:
        context, by_name = rows.read_rows(path)
        files.append((context, list(by_name.values())))
    print("\n".join(figures.table(files)))
    figures.draw(files, arguments.folder)
    return 0


def self_test(_):
    for module in (rows, peers, compare, device, figures):
        module.self_test()
    print("report: all checks passed")
    return 0


def main():
    parser = argparse.ArgumentParser(prog="report", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    tables = commands.add_parser("tables", help="print Markdown tables")
    plots = commands.add_parser("plots", help="draw PNG files")
    plots.add_argument("--folder", required=True, help="where the files are written")
    for command in (tables, plots):
        command.add_argument("files", nargs="+", metavar="FILE")
        command.add_argument("--peers", metavar="LOG", help="output of peers/siconos_nsgs.py")
    tables.add_argument("--gpu-peers", metavar="LOG", help="output of peers/gpu_samplers.py")
    tables.set_defaults(run=print_tables)
    plots.set_defaults(run=draw_plots)
    paper = commands.add_parser(
        "figures", help="the paper's figures of time against size and tetrahedra, of several files")
    paper.add_argument("--folder", required=True, help="where the PNG files are written")
    paper.add_argument("files", nargs="+", metavar="FILE")
    paper.set_defaults(run=draw_figures)
    both = commands.add_parser("compare", help="mark rows as faster or slower; exit code 1 when slower")
    both.add_argument("old", metavar="OLD")
    both.add_argument("new", metavar="NEW")
    both.add_argument("--threshold", type=float, default=0.05, help="share of the old time")
    both.set_defaults(run=lambda a: compare.print_comparison(a.old, a.new, a.threshold))
    archive = commands.add_parser("device", help="print the tables of run_on_device.sh's archive")
    archive.add_argument("archive", metavar="FILE.tar.gz")
    archive.add_argument("--prefix",
                         help="also write PREFIX-resident.json, PREFIX-warp.json and so on")
    archive.set_defaults(run=device.print_archive)
    commands.add_parser("self-test", help="check the parsers").set_defaults(run=self_test)
    arguments = parser.parse_args()
    return arguments.run(arguments)


if __name__ == "__main__":
    sys.exit(main())
