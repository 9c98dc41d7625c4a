"""A policy's network, run by onnxruntime; it holds no state."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from atlas_drake.errors import AtlasError, ScenarioError

Memory = tuple[np.ndarray, ...]
"""What a recurrent network hands on to its next action."""


class Network:
    """A network: an observation in, an action out, and its memory through both.

    Attributes:
        metadata: Texts that the exporter has written into the file.
        observation_size: Number of elements of the observation.
        action_size: Number of elements of the action.
    """

    def __init__(self, file: Path):
        """Loads an ONNX file.

        The first input is the observation and the first output the action; the others
        are memory, in the same order.

        Raises:
            AtlasError: If onnxruntime is not installed.
            ScenarioError: If there is no file, no network in it, or one of another
                form.
        """
        try:
            import onnxruntime
        except ImportError:
            text = 'policies need `pip install "atlas-drake[policies]"`'
            raise AtlasError(text) from None
        if not file.is_file():
            raise ScenarioError("network", str(file), f"there is no file {file}")
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        options.log_severity_level = 3
        try:
            self._session = onnxruntime.InferenceSession(
                file.read_bytes(), options, providers=["CPUExecutionProvider"]
            )
        except Exception as error:
            text = str(error).splitlines()[0]
            problem = f"{file} is no network that onnxruntime reads: {text}"
            raise ScenarioError("network", str(file), problem) from None
        inputs, outputs = self._session.get_inputs(), self._session.get_outputs()
        shapes = [[_size(port) for port in ports] for ports in (inputs, outputs)]
        if shapes[0][1:] != shapes[1][1:]:
            names = [", ".join(port.name for port in p[1:]) for p in (inputs, outputs)]
            problem = (
                f"{file}: its memory does not match: inputs {names[0] or 'none'}, "
                f"outputs {names[1] or 'none'}"
            )
            raise ScenarioError("network", str(file), problem)
        self.metadata: dict[str, str] = dict(
            self._session.get_modelmeta().custom_metadata_map
        )
        self.observation_size = math.prod(shapes[0][0])
        self.action_size = math.prod(shapes[1][0])
        self._inputs = [port.name for port in inputs]
        self._shapes = shapes[0]

    def start(self) -> Memory:
        """Returns the memory before the first action."""
        return tuple(np.zeros(shape, np.float32) for shape in self._shapes[1:])

    def act(self, observation: np.ndarray, memory: Memory) -> tuple[np.ndarray, Memory]:
        """Computes an action, shape (m,), and the memory for the next one."""
        given = observation.astype(np.float32).reshape(self._shapes[0])
        feed = dict(zip(self._inputs, (given, *memory), strict=True))
        action, *kept = self._session.run(None, feed)
        return np.asarray(action, dtype=float).ravel(), tuple(kept)


def _size(port: Any) -> list[int]:
    """Returns the shape of an input or output; an open size, a batch, is 1."""
    return [size if isinstance(size, int) else 1 for size in port.shape]
