"""The examples of docstrings run, and the names of the package are documented."""

import doctest
import importlib
import inspect
import pkgutil

import numpy
import pytest

import tetwarp

MODULES = [m.name for m in pkgutil.iter_modules(tetwarp.__path__) if m.name != "_core"]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings_run(name):
    module = importlib.import_module(f"tetwarp.{name}")

    result = doctest.testmod(module, extraglobs={"np": numpy})

    assert result.failed == 0


def test_every_public_name_has_a_docstring():
    for name in tetwarp.__all__:
        value = getattr(tetwarp, name)
        if not isinstance(value, dict):
            assert inspect.getdoc(value), name


def test_the_module_has_stubs():
    folder = tetwarp.__path__[0]
    stub = open(f"{folder}/_core.pyi", encoding="utf8").read()

    assert "class Warper" in stub
    assert open(f"{folder}/py.typed", encoding="utf8").read() == ""
