"""Small networks for tests, as exporters write them."""

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

ARM = ("r_arm_shx", "r_arm_elx")
"""Joints of the test policies, none of which the balance needs."""


def save(file, bias, seen=6, weight=None, recurrent=False, metadata=None):
    """Writes action = weight · obs + bias; a recurrent network adds its counter.

    ``seen`` is the number of observations; without a ``weight`` they do not matter.
    """
    m = len(bias)
    weight = np.zeros((seen, m)) if weight is None else np.asarray(weight)
    constants = {"W": weight, "b": np.reshape(bias, (1, m)), "one": np.ones((1, 1))}
    nodes = [
        helper.make_node("MatMul", ["obs", "W"], ["product"]),
        helper.make_node("Add", ["product", "b"], ["sum" if recurrent else "actions"]),
    ]
    inputs, outputs = [port("obs", len(weight))], [port("actions", m)]
    if recurrent:
        nodes += [
            helper.make_node("Add", ["h_in", "one"], ["h_out"]),
            helper.make_node("Mul", ["h_out", "small"], ["drift"]),
            helper.make_node("Add", ["sum", "drift"], ["actions"]),
        ]
        constants["small"] = np.full((1, 1), 0.01)
        inputs.append(port("h_in", 1))
        outputs.append(port("h_out", 1))
    graph = helper.make_graph(
        nodes,
        "policy",
        inputs,
        outputs,
        [
            numpy_helper.from_array(np.asarray(value, np.float32), name)
            for name, value in constants.items()
        ],
    )
    opsets = [helper.make_opsetid("", 17)]
    model = helper.make_model(graph, opset_imports=opsets, ir_version=9)
    helper.set_model_props(model, metadata or {})
    onnx.save(model, file)
    return file


def port(name, size):
    """A vector of the network, for a batch of one."""
    return helper.make_tensor_value_info(name, TensorProto.FLOAT, [1, size])


METADATA = {
    "joint_names": ",".join(ARM),
    "joint_stiffness": "600.0,400.0",
    "joint_damping": "30.0,20.0",
    "default_joint_pos": "1.2,-0.6",
    "action_scale": "0.5,0.25",
    "observation_names": "joint_pos,joint_vel,actions",
    "command_names": "",
}
"""As mjlab, Isaac Lab and holosoma write it."""
