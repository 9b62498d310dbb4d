"""One instance of an FMU for co-simulation, of FMI 2.0 or 3.0, its functions called with addresses of arrays."""

from __future__ import annotations

import ctypes
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave

from ..model.errors import FmuError
from .compiling import why_not_loaded

# Types of the functions' arguments, and those of the ones that set or get values.
_ADDRESS = ctypes.c_void_p
_SIZE = ctypes.c_size_t
_DOUBLE = ctypes.c_double
_INT = ctypes.c_int
_BOOL = ctypes.c_bool
_VALUES = (_ADDRESS, _SIZE, _ADDRESS)

#: Function(address of references, their number, address of values).
Values = Callable[[int, int, int], None]


class Slave(ABC):
    """An instance whose functions make no Python objects and raise when they are refused.

    Attributes:
        set, get: values of variables that are real numbers
        step: (time [s], length [s])
        begin: (tolerance or None, start time [s], stop time [s]), into initialization mode
        initialized: out of it, into step mode
        reset: as from new
        slopes: (address of references, their number, of orders, of values) of inputs; None where the FMU holds inputs
    """

    set: Values
    get: Values
    step: Callable[[float, float], None]
    begin: Callable[[float | None, float, float], None]
    initialized: Callable[[], None]
    reset: Callable[[], None]
    slopes: Callable[[int, int, int, int], None] | None = None

    #: Type of a variable -> the function that sets it, and its numbers; whether it asks for their count twice.
    _setters: Mapping[str, tuple[str, type]]
    _counted: bool

    def __init__(self, path: Path, description: Any, folder: str) -> None:
        self._name = path.name
        self._messages: list[str] = []
        identity = {"guid": description.guid, "instanceName": description.modelName}
        place = {"unzipDirectory": folder, "modelIdentifier": description.coSimulation.modelIdentifier}
        here = Path.cwd()
        try:
            self._fmu = self._open({**identity, **place})
        except Exception as error:  # FMPy raises bare Exception, and stays in the folder of the library
            os.chdir(here)
            raise FmuError(f"{self._name} cannot be loaded: {self.said() or why_not_loaded(error, folder)}") from error
        self._bind(description)

    @abstractmethod
    def _open(self, arguments: dict[str, Any]) -> Any:
        """The instance as FMPy has it."""

    @abstractmethod
    def _bind(self, description: Any) -> None:
        """Find the functions."""

    def said(self) -> str:
        """The last messages of the FMU, which are forgotten."""
        said = " ".join(self._messages[-2:])
        self._messages.clear()
        return said

    def free(self) -> None:
        """End the instance."""
        self._fmu.freeInstance()

    def put(self, kind: str, references: np.ndarray, values: Sequence[float]) -> None:
        """Set variables of one type.

        Args:
            kind: the type
            references: value references
            values: their values
        """
        name, number = self._setters[kind]
        self._hand(name, references, np.array(values, dtype=number))

    def _hand(self, name: str, references: np.ndarray, values: np.ndarray) -> None:
        """Call a function that sets values."""
        n, more = len(references), (_SIZE,) * self._counted
        self._function(name, *_VALUES, *more)(references.ctypes.data, n, values.ctypes.data, *(n for _ in more))

    def _heard(self, status: int, message: bytes | None) -> None:
        if status > 1 and message:
            self._messages.append(message.decode("utf-8", "replace"))

    def _function(self, name: str, *types: Any) -> Any:
        raw = self._fmu.dll[name]
        raw.argtypes, raw.restype = [_ADDRESS, *types], _INT
        component = self._fmu.component

        def call(*arguments: Any) -> None:
            if raw(component, *arguments) > 1:
                raise FmuError(f"{self._name}: {self.said() or name + ' failed.'}")

        return call


class Slave2(Slave):
    """An instance of FMI 2.0."""

    _setters = MappingProxyType(
        {
            "Real": ("fmi2SetReal", np.float64),
            "Integer": ("fmi2SetInteger", np.int32),
            "Enumeration": ("fmi2SetInteger", np.int32),
        }
    )
    _counted = False

    def _open(self, arguments: dict[str, Any]) -> Any:
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(
            lambda _, __, status, ___, message: self._heard(status, message)
        )
        self._callbacks.allocateMemory = fmpy.fmi2.defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = fmpy.fmi2.defaultCallbacks.freeMemory
        fmu = FMU2Slave(**arguments)
        fmu.instantiate(callbacks=self._callbacks)
        return fmu

    def _bind(self, description: Any) -> None:
        self.set, self.get = (self._function(f"fmi2{verb}Real", *_VALUES) for verb in ("Set", "Get"))
        do_step = self._function("fmi2DoStep", _DOUBLE, _DOUBLE, _INT)
        self.step = lambda time, length: do_step(time, length, 1)
        setup = self._function("fmi2SetupExperiment", _INT, _DOUBLE, _DOUBLE, _INT, _DOUBLE)
        enter = self._function("fmi2EnterInitializationMode")

        def begin(tolerance: float | None, start: float, stop: float) -> None:
            setup(tolerance is not None, tolerance or 0.0, start, 1, stop)
            enter()

        self.begin, self.initialized = begin, self._function("fmi2ExitInitializationMode")
        self.reset = self._function("fmi2Reset")
        if description.coSimulation.canInterpolateInputs:
            self.slopes = self._function("fmi2SetRealInputDerivatives", _ADDRESS, _SIZE, _ADDRESS, _ADDRESS)


class Slave3(Slave):
    """An instance of FMI 3.0, without event mode and early return."""

    _setters = MappingProxyType(
        {
            "Float64": ("fmi3SetFloat64", np.float64),
            "Int32": ("fmi3SetInt32", np.int32),
            "Enumeration": ("fmi3SetInt64", np.int64),
        }
    )
    _counted = True

    def _open(self, arguments: dict[str, Any]) -> Any:
        fmu = FMU3Slave(**arguments)
        fmu.instantiate(logMessage=lambda _, status, __, message: self._heard(status, message))
        return fmu

    def _bind(self, description: Any) -> None:
        set_values, get_values = (self._function(f"fmi3{verb}Float64", *_VALUES, _SIZE) for verb in ("Set", "Get"))
        self.set = lambda references, n, values: set_values(references, n, values, n)
        self.get = lambda references, n, values: get_values(references, n, values, n)
        flags, reached = (ctypes.c_bool * 3)(), _DOUBLE()
        told = [*(ctypes.addressof(flags) + i for i in range(3)), ctypes.addressof(reached)]
        do_step = self._function("fmi3DoStep", _DOUBLE, _DOUBLE, _BOOL, *[_ADDRESS] * 4)

        def step(time: float, length: float) -> None:
            do_step(time, length, True, *told)
            if flags[1]:
                raise FmuError(f"{self._name}: the FMU ends the simulation at {reached.value:g} s. {self.said()}")

        self.step = step
        enter = self._function("fmi3EnterInitializationMode", _BOOL, _DOUBLE, _DOUBLE, _BOOL, _DOUBLE)
        self.begin = lambda tolerance, start, stop: enter(tolerance is not None, tolerance or 0.0, start, True, stop)
        self.initialized, self.reset = (self._function(f"fmi3{n}") for n in ("ExitInitializationMode", "Reset"))
