"""Lists of estimators, parameters and scenarios, and the constants of a device."""

from __future__ import annotations

import ast
import doctest
import inspect
import re
import subprocess
from pathlib import Path

import pytest

import limpid
from limpid import _limpid, cluster


def test_lists_are_those_of_the_command(host_sim):
    text = subprocess.run([host_sim, "estimators"], check=True, capture_output=True, text=True).stdout
    names = re.findall(r"^(\S+)", text, re.MULTILINE)
    assert [info.name for info in limpid.estimators()] == names
    parameters = re.findall(r"--set (\S+)\.(\S+)=", text)
    listed = [(info.name, parameter.name) for info in limpid.estimators() for parameter in info.parameters]
    assert listed == parameters
    text = subprocess.run([host_sim, "scenarios"], check=True, capture_output=True, text=True).stdout
    assert list(limpid.scenarios()) == re.findall(r"^(\S+)", text, re.MULTILINE)


def test_every_parameter_has_a_range_that_is_kept():
    checked = 0
    for info in limpid.estimators():
        values = limpid.parameters(info.name, 1000)
        assert list(values) == sorted(parameter.name for parameter in info.parameters)
        for parameter in info.parameters:
            assert parameter.lowest <= values[parameter.name] <= parameter.highest
            assert parameter.meaning
            with pytest.raises(ValueError, match=f"{info.name}.{parameter.name} = "):
                limpid.Estimator(info.name, parameters={parameter.name: 2 * parameter.highest + 1})
            checked += 1
    assert checked > 30


def test_signals_that_an_estimator_needs_are_asked_for():
    for info in limpid.estimators():
        estimator = limpid.Estimator(info.name)
        if info.needs:
            with pytest.raises(ValueError, match=f"{info.name} needs"):
                estimator.update(1)
        else:
            assert estimator.update(1) == 0


def test_device_has_defaults_and_the_given_constants(data):
    default = limpid.device()
    assert default["large"]["counts_per_rev"] == 4096
    changed = limpid.device({"large": {"inertia_kg_m2": 2e-5}})
    assert changed["large"]["inertia_kg_m2"] == 2e-5
    assert changed["small"] == default["small"]
    assert limpid.device(data / "hall-90.toml")["large"]["counts_per_rev"] == 90
    assert limpid.device(changed) == changed


def test_examples_of_docstrings_are_right():
    from limpid import _estimator, _lists

    for module in (limpid, _estimator, _lists):
        result = doctest.testmod(module, extraglobs={"limpid": limpid})
        assert result.attempted > 0 and result.failed == 0


def test_everything_public_has_a_docstring():
    for name in limpid.__all__:
        assert getattr(limpid, name).__doc__, name


def test_every_public_name_has_a_documentation():
    public = [(name, getattr(limpid, name)) for name in limpid.__all__]
    classes = [(name, value) for name, value in public if inspect.isclass(value)]
    members = [
        (f"{name}.{member}", getattr(value, member))
        for name, value in classes
        for member in dir(value)
        # The fields of a data class and of a named tuple are in the documentation of their class.
        if not member.startswith("_") and (callable(getattr(value, member)) or inspect.isdatadescriptor(getattr(value, member)))
    ]
    assert "Estimator.update" in dict(members) and "Estimator.std_dev" in dict(members)
    for name, value in [*public, *members, ("cluster.run", cluster.run)]:
        assert name == "__version__" or inspect.getdoc(value), name


def test_stub_has_the_arguments_of_the_compiled_part():
    tree = ast.parse((Path(limpid.__file__).parent / "_limpid.pyi").read_text())
    (estimator,) = (node for node in tree.body if isinstance(node, ast.ClassDef))
    functions = [(_limpid, node) for node in tree.body] + [(_limpid.Estimator, node) for node in estimator.body]
    compared = 0
    for owner, node in functions:
        if not isinstance(node, ast.FunctionDef) or node.decorator_list or node.name == "__new__":
            continue
        arguments = [argument.arg for argument in [*node.args.args, *node.args.kwonlyargs]]
        assert list(inspect.signature(getattr(owner, node.name)).parameters) == arguments, node.name
        compared += 1
    assert compared > 15
