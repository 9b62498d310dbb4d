"""Rates and Jacobian of an FMU in model exchange, called through ctypes on arrays that are made once."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Model


class Exchange:
    """An instance in continuous-time mode whose functions are those of its binary.

    Args:
        model: the instance, initialized
        description: of the FMU
    """

    def __init__(self, model: FMU2Model, description: fmpy.model_description.ModelDescription) -> None:
        self._model = model
        self._references = {v.name: v.valueReference for v in description.modelVariables}
        self.states = [d.variable.derivative.name for d in description.derivatives]
        n = self._n = len(self.states)
        self._x, self._rate, self._slope = np.zeros(n), np.zeros(n), np.zeros((n, n))
        places = (ctypes.c_uint * n)(*(self._references[name] for name in self.states))
        rates = (ctypes.c_uint * n)(*(d.variable.valueReference for d in description.derivatives))
        one, handle = ctypes.c_double(1.0), ctypes.c_void_p(model.component)
        self._set, self._get, self._directional = (
            model.dll[name]
            for name in ("fmi2SetContinuousStates", "fmi2GetDerivatives", "fmi2GetDirectionalDerivative")
        )
        self._setting = (handle, ctypes.c_void_p(self._x.ctypes.data), ctypes.c_size_t(n))
        self._getting = (handle, ctypes.c_void_p(self._rate.ctypes.data), ctypes.c_size_t(n))
        self._columns = [
            (
                handle,
                rates,
                ctypes.c_size_t(n),
                ctypes.byref(places, k * ctypes.sizeof(ctypes.c_uint)),
                ctypes.c_size_t(1),
                ctypes.byref(one),
                ctypes.c_void_p(self._slope[k].ctypes.data),
            )
            for k in range(n)
        ]

    def give(self, values: Mapping[str, float]) -> None:
        """Set inputs, as at an event."""
        self._model.enterEventMode()
        self._model.setReal([self._references[name] for name in values], list(values.values()))
        self._model.newDiscreteStates()
        self._model.enterContinuousTimeMode()

    def rates(self, _: float, x: np.ndarray) -> np.ndarray:
        """Time derivatives of the states (n)."""
        self._x[:] = x
        if self._set(*self._setting) > 1 or self._get(*self._getting) > 1:
            self._rate[:] = np.nan
        return self._rate.copy()

    def slopes(self, _: float, x: np.ndarray) -> np.ndarray:
        """Jacobian of the rates (n, n)."""
        self._x[:] = x
        self._set(*self._setting)
        for column in self._columns:
            self._directional(*column)
        return self._slope.T.copy()


@contextmanager
def exchanged(fmu: Path, folder: Path) -> Iterator[Exchange]:
    """An FMU at its start values, unpacked to a folder."""
    description = fmpy.read_model_description(str(fmu))
    place = fmpy.extract(str(fmu), str(folder))
    identifier = description.modelExchange.modelIdentifier
    model = FMU2Model(guid=description.guid, unzipDirectory=place, modelIdentifier=identifier, instanceName="exchange")
    model.instantiate()
    model.setupExperiment(startTime=0.0)
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.newDiscreteStates()
    model.enterContinuousTimeMode()
    try:
        yield Exchange(model, description)
    finally:
        model.terminate()
        model.freeInstance()
