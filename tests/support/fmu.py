"""An importer of FMUs on FMPy, for FMI 2.0 and 3.0 alike: variables by name, and all messages kept."""

from __future__ import annotations

import ctypes
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException

MODEL_EXCHANGE, CO_SIMULATION = "ModelExchange", "CoSimulation"

CALL_FAILED = FMICallException


class Instance:
    """An instance of an FMU.

    Attributes:
        log: Status, category and text of every message.
        fmu: The functions of FMI, from FMPy.
    """

    def __init__(self, path: Path, kind: str, name: str = "one", logging: bool = True) -> None:
        self.description = fmpy.read_model_description(str(path))
        self.is_fmi3 = self.description.fmiVersion.startswith("3")
        self._folder = tempfile.mkdtemp()
        fmpy.extract(str(path), self._folder)
        self.log: list[tuple[int, str, str]] = []
        classes = {
            (False, MODEL_EXCHANGE): fmi2.FMU2Model,
            (False, CO_SIMULATION): fmi2.FMU2Slave,
            (True, MODEL_EXCHANGE): fmi3.FMU3Model,
            (True, CO_SIMULATION): fmi3.FMU3Slave,
        }
        self.kind = kind
        self.fmu: Any = classes[self.is_fmi3, kind](
            guid=self.description.guid,
            unzipDirectory=self._folder,
            modelIdentifier=self.description.modelExchange.modelIdentifier,
            instanceName=name,
        )
        self.variables = {one.name: one for one in self.description.modelVariables}
        if self.is_fmi3:
            self.fmu.instantiate(loggingOn=logging, logMessage=self._log3())
        else:
            self.fmu.instantiate(callbacks=self._callbacks(), loggingOn=logging)

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_: object) -> None:
        self.fmu.freeInstance()
        shutil.rmtree(self._folder)

    def _log3(self) -> Any:
        def keep(_: Any, status: int, category: bytes, message: bytes) -> None:
            self.log.append((status, category.decode(), message.decode()))

        return keep

    def _callbacks(self) -> Any:
        def keep(_: Any, name: bytes, status: int, category: bytes, message: bytes) -> None:
            self.log.append((status, category.decode(), message.decode()))

        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(keep)
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
        return callbacks

    def references(self, names: Sequence[str]) -> list[int]:
        """Return the value references of variables."""
        return [self.variables[name].valueReference for name in names]

    def size(self, names: Sequence[str]) -> int:
        """Return how many numbers variables hold."""
        shapes = [self.variables[name].shape or () for name in names]
        return int(sum(np.prod(shape, dtype=int) for shape in shapes))

    def set(self, values: Mapping[str, Any]) -> None:
        """Set variables by name."""
        numbers = np.concatenate([np.ravel(value) for value in values.values()])
        references = self.references(list(values))
        (self.fmu.setFloat64 if self.is_fmi3 else self.fmu.setReal)(references, numbers)

    def get(self, names: Sequence[str]) -> np.ndarray:
        """Return the numbers of variables."""
        if self.is_fmi3:
            return np.array(self.fmu.getFloat64(self.references(names), nValues=self.size(names)))
        return np.array(self.fmu.getReal(self.references(names)))

    def initialize(
        self, values: Mapping[str, Any] | None = None, time: float = 0.0, stop: Any = None
    ) -> None:
        """Set variables and go through Initialization Mode."""
        if values:
            self.set(values)
        if self.is_fmi3:
            self.fmu.enterInitializationMode(startTime=time, stopTime=stop)
        else:
            self.fmu.setupExperiment(startTime=time, stopTime=stop)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        if self.kind == MODEL_EXCHANGE:
            (self.fmu.updateDiscreteStates if self.is_fmi3 else self.fmu.newDiscreteStates)()
            self.fmu.enterContinuousTimeMode()

    def set_states(self, states: np.ndarray) -> None:
        """Set the continuous states."""
        numbers = (ctypes.c_double * len(states))(*states)
        self.fmu.setContinuousStates(numbers, len(states))

    def rates(self) -> np.ndarray:
        """Return the derivatives of the continuous states."""
        count = len(self.description.derivatives)
        numbers = (ctypes.c_double * count)()
        call = self.fmu.getContinuousStateDerivatives if self.is_fmi3 else self.fmu.getDerivatives
        call(numbers, count)
        return np.array(numbers)

    def derivative(self, unknowns: Sequence[str], knowns: Sequence[str], seed: np.ndarray) -> np.ndarray:
        """Return the derivative of variables in a direction of others."""
        pairs = self.references(unknowns), self.references(knowns)
        if self.is_fmi3:
            return np.array(self.fmu.getDirectionalDerivative(*pairs, seed, self.size(unknowns)))
        return np.array(self.fmu.getDirectionalDerivative(*pairs, seed))

    def adjoint(self, unknowns: Sequence[str], knowns: Sequence[str], seed: np.ndarray) -> np.ndarray:
        """Return the derivative of a sum of variables by others."""
        pairs = self.references(unknowns), self.references(knowns)
        return np.array(self.fmu.getAdjointDerivative(*pairs, seed, self.size(knowns)))

    def step(self, time: float, length: float) -> None:
        """Make a communication step."""
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=length)

    def state(self) -> Any:
        """Return a stored state."""
        return self.fmu.getFMUState() if self.is_fmi3 else self.fmu.getFMUstate()
