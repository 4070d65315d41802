"""Runs program.py by this folder's path: the package around it, and what that needs, are not imported."""

import importlib.util
import sys
from pathlib import Path

_HERE = Path(__file__).resolve().parent


def _package(name: str):
    spec = importlib.util.spec_from_file_location(name, _HERE / "__init__.py", submodule_search_locations=[str(_HERE)])
    sys.modules[name] = package = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(package)
    return importlib.import_module(f"{name}.program")


if __name__ == "__main__":
    sys.path.pop(0)  # this folder, whose modules are not to stand in for others
    sys.exit(_package("lcpbench_formats").main())
