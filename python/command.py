#!python
"""The command of the package: a program in its folder."""

import importlib.util
import os
import sys

folder = importlib.util.find_spec("tetwarp").submodule_search_locations[0]
program = os.path.join(folder, "tetwarp")
os.execv(program, [program, *sys.argv[1:]])
