#!/usr/bin/env python3
"""What the Python module says of itself: every doctest runs, and the type stubs name what there is.

    documents_test.py SOURCE    (server/library/python)
"""

import ast
import doctest
import inspect
import re
import sys
from pathlib import Path

import wobble

source = Path(sys.argv[1])
faults = []


def members(thing):
    return {name: value for name, value in vars(thing).items() if not name.startswith("_") or name == "__enter__"}


# doctest's own finder passes over what is compiled.
def list_documented():
    yield "wobble", wobble
    for name in wobble.__all__:
        thing = getattr(wobble, name)
        yield name, thing
        if inspect.isclass(thing):
            yield from ((f"{name}.{member}", value) for member, value in members(thing).items())


def run_doctests():
    runner = doctest.DocTestRunner()
    for name, thing in list_documented():
        text = thing.__doc__ if not isinstance(thing, str) else ""
        runner.run(doctest.DocTestParser().get_doctest(text or "", {"wobble": wobble}, name, None, 0))
    readme = (source / "README.md").read_text()
    blocks = "\n".join(re.findall(r"```pycon\n(.*?)```", readme, re.DOTALL))
    runner.run(doctest.DocTestParser().get_doctest(blocks, {}, "README.md", None, 0))
    results = runner.summarize()
    if results.failed:
        faults.append(f"{results.failed} doctests failed")
    return results.attempted


def list_arguments(document):
    """The names of the arguments, as pybind11 puts them into the first line."""
    call = document.split("\n")[0].split(" ->")[0]
    return {name for name in re.findall(r"[(,] (?:\*, )?(\w+):", call.replace("(", "( ")) if name not in ("self", "arg0")}


def compare(name, stub, thing):
    if isinstance(stub, ast.ClassDef):
        within = {each.name: each for each in stub.body if isinstance(each, ast.FunctionDef)}
        there = members(thing)
        named = {each for each in within if not each.startswith("_") or each == "__enter__"}
        for each in sorted(set(there) ^ named):
            faults.append(f"{name}.{each} is only in the {'stubs' if each in named else 'module'}")
        for each in sorted(set(there) & named):
            compare(f"{name}.{each}", within[each], there[each])
        if "__init__" in within:
            compare(f"{name}.__init__", within["__init__"], thing.__init__)
    elif not isinstance(thing, property):
        arguments = stub.args
        stubbed = {each.arg for each in arguments.args + arguments.kwonlyargs} - {"self"}
        if stubbed != list_arguments(thing.__doc__):
            faults.append(f"{name} takes {list_arguments(thing.__doc__)}, in the stubs {stubbed}")
    elif not thing.__doc__ and name.split(".")[0] in ("World", "Body", "Recording", "Client"):
        faults.append(f"{name} has no docstring")


stubs = ast.parse((source / "__init__.pyi").read_text())
stubbed = {each.name: each for each in stubs.body if isinstance(each, (ast.ClassDef, ast.FunctionDef))}
if set(stubbed) | {"__version__"} != set(wobble.__all__):
    faults.append(f"the stubs and the module differ in {set(stubbed) ^ set(wobble.__all__)}")
for name in sorted(set(stubbed) & set(wobble.__all__)):
    compare(name, stubbed[name], getattr(wobble, name))

attempted = run_doctests()
print("\n".join(faults) if faults else f"{attempted} examples in docstrings and in README.md run; the stubs agree")
sys.exit(1 if faults or attempted < 10 else 0)
