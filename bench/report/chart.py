"""One picture of the report."""
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter


class Chart:
    """A figure that is saved at the end of its with block, if something was drawn."""

    machine = ""  # printed below each picture

    def __init__(self, folder, name, title, x, y, columns=1):
        self.path = os.path.join(folder, name + ".png")
        self.figure, axes = plt.subplots(
            1, columns, figsize=(6.4 * columns, 4.6), sharey=True, squeeze=False
        )
        self.axes = list(axes[0])
        self.figure.suptitle(title)
        self.legend = {}
        for axis, label in zip(self.axes, x if isinstance(x, tuple) else (x,)):
            axis.set_xlabel(label)
            axis.grid(True, which="both", alpha=0.25)
        self.axes[0].set_ylabel(y)

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if kind is None and any(axis.has_data() for axis in self.axes):
            self.axes[-1].legend(fontsize="small", **self.legend)
            self.figure.text(0.01, 0.005, Chart.machine, fontsize=5, color="gray")
            self.figure.tight_layout(rect=(0, 0.02, 1, 1))
            self.figure.savefig(self.path, dpi=120)
            print(self.path)
        plt.close(self.figure)


def use_logarithms(axis):
    """On both axes, ticks at 1, 2, 5 in plain numbers."""
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())


def bars(chart, names):
    axis = chart.axes[0]
    chart.figure.set_figheight(max(4.6, 0.22 * len(names)))
    chart.legend = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)}
    axis.set_yticks(range(len(names)))
    axis.set_yticklabels(names, fontsize=7)
    axis.invert_yaxis()
    axis.grid(False, axis="y")
