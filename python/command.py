#!python
"""The command of the package: a program in its folder."""

import importlib.util
import os
import sys

folder = importlib.util.find_spec("tetwarp").submodule_search_locations[0]
program = os.path.join(folder, "tetwarp")
os.environ.setdefault("LD_ORIGIN_PATH", folder)  # where no /proc tells the linker this folder
os.execv(program, [program, *sys.argv[1:]])
