"""Writes what was learned as an ONNX file that ``--policy`` runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from atlas_drake.clients.policies.description import PolicyDescription
from atlas_drake.clients.policies.observation import Term
from atlas_drake.clients.policies.reading import terms_of
from atlas_drake.errors import AtlasError, ScenarioError

OPSET, IR_VERSION = 17, 9
"""Of ONNX; runtimes of the last years read them."""
Layer = tuple[np.ndarray, np.ndarray]
"""Weights, shape (inputs, outputs), and biases, shape (outputs,)."""


def save_policy(
    file: str | Path,
    layers: Sequence[Layer],
    description: PolicyDescription,
    terms: Mapping[str, Term] | None = None,
) -> None:
    """Writes a network of full layers, with tanh between them, and its metadata.

    Args:
        file: Path of the ONNX file.
        layers: Of the network: the first takes the observation, the last gives the
            action.
        description: Of the environment in which it was learned. The scales of the
            observation go into the first layer, for metadata have none.
        terms: Terms of your own in it, by name.

    Raises:
        ScenarioError: If the layers do not fit each other or the joints.
        AtlasError: If onnx is not installed.
    """
    try:
        from onnx import TensorProto, helper, numpy_helper, save
    except ImportError:
        raise AtlasError('export needs `pip install "atlas-drake[gym]"`') from None
    scale = _scale(description, terms)
    sizes = [np.shape(weights) for weights, _ in layers]
    ends = [len(scale), *(inner[1] for inner in sizes)]
    begins = [*(inner[0] for inner in sizes), len(description.joints)]
    if ends != begins:
        problem = f"of sizes {sizes} do not fit observation, joints and each other"
        raise ScenarioError("layers", sizes, problem)
    first, *others = layers
    layers = [(scale[:, None] * first[0], first[1]), *others]
    nodes, constants, name = [], [], "obs"
    for index, (weights, biases) in enumerate(layers):
        is_last = index == len(layers) - 1
        values = {f"W{index}": weights, f"b{index}": np.reshape(biases, (1, -1))}
        constants += [
            numpy_helper.from_array(np.asarray(value, np.float32), key)
            for key, value in values.items()
        ]
        out = "actions" if is_last else f"sum{index}"
        nodes.append(helper.make_node("MatMul", [name, f"W{index}"], [f"m{index}"]))
        nodes.append(helper.make_node("Add", [f"m{index}", f"b{index}"], [out]))
        if not is_last:
            name = f"y{index}"
            nodes.append(helper.make_node("Tanh", [out], [name]))

    def port(name: str, size: int) -> Any:
        return helper.make_tensor_value_info(name, TensorProto.FLOAT, [1, size])

    graph = helper.make_graph(
        nodes,
        "policy",
        [port("obs", sizes[0][0])],
        [port("actions", sizes[-1][1])],
        constants,
    )
    opsets = [helper.make_opsetid("", OPSET)]
    model = helper.make_model(graph, opset_imports=opsets, ir_version=IR_VERSION)
    helper.set_model_props(model, metadata_of(description))
    save(model, str(file))


def _scale(
    description: PolicyDescription, terms: Mapping[str, Term] | None
) -> np.ndarray:
    """Returns the factor of each number of the observation."""
    _, sizes = terms_of(description, terms)
    return np.concatenate(
        [
            np.tile(np.resize(term.scale, size // term.history), term.history)
            for term, size in zip(description.observation, sizes, strict=True)
        ]
    )


def metadata_of(description: PolicyDescription) -> dict[str, str]:
    """Returns a description as exporters write it: texts, separated by commas."""

    def text(values: Sequence[object]) -> str:
        return ",".join(map(str, values))

    terms = description.observation
    return {
        "joint_names": text(description.joints),
        "joint_stiffness": text(description.kp),
        "joint_damping": text(description.kd),
        "default_joint_pos": text(description.position),
        "action_scale": text(description.action_scale),
        "observation_names": text([term.name for term in terms]),
        "observation_history_lengths": text([term.history for term in terms]),
        "command_names": "",
    }
