"""The examples in the docstrings of ibl_toolkit run and give what they print."""

import doctest
import importlib
import pkgutil

import pytest

from expanded_panoramas import ibl_toolkit

MODULES = [m.name for m in pkgutil.walk_packages(ibl_toolkit.__path__, ibl_toolkit.__name__ + ".")]


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    failed, _ = doctest.testmod(importlib.import_module(name))
    assert failed == 0
