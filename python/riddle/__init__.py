"""Riddle: particle-process engineering. One module a header: dem, bridge, screen, blocking, granulation, classifier,
filtration.

Functions and structures have the names of the headers without their prefix: blocking_fit is blocking.fit. What only C
looks into is a class: granulation_sim_run(&sim, steps) is sim.run(steps) of a granulation.Sim. Lengths of arrays are
not given; answers are returned; a status other than ok is a riddle.Error with the status text and what looks wrong.
help() has the headers' comments. Units are SI.
"""
import sys as _sys
import types as _types_module

from . import _core
from ._core import Error, Handle, Result, Structure

for _lower in _core.api["headers"]:
    if _lower != "dem":
        _module = _types_module.ModuleType(f"riddle.{_lower}", f"{_core.api['headers'][_lower]['file']} in Python.")
        _core.fill(_module, _lower)
        _sys.modules[f"riddle.{_lower}"] = _module
        globals()[_lower] = _module
from . import _fits, dem, script

__version__ = _core.api["version"]
__all__ = ["Error", "Handle", "Result", "Structure", "script", *_core.api["headers"], "__version__"]


def __dir__():
    return __all__
