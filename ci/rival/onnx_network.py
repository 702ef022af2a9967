"""Line of sight by onnxruntime on one core, with the weights of a model of `adit nlos train`.

Usage: onnx_network.py MODEL.safetensors FOLDER: FOLDER is what `network_speed` wrote (scores, windows, logits). Builds the same network as ONNX (Conv, LSTM, Gemm),
checks that its logits are ours within 1e-5, and prints responses a second, alone and in batches of 64.
"""

import json
import struct
import sys
import time

import numpy as np
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

TAPS, CHANNELS, WIDTH, STRIDE, BATCH = 80, 2, 5, 2, 64


def tensors(path):
    data = open(path, "rb").read()
    (length,) = struct.unpack("<Q", data[:8])
    header = json.loads(data[8 : 8 + length])
    body = data[8 + length :]
    of = lambda t: np.frombuffer(body[slice(*t["data_offsets"])], "<f4").reshape(t["shape"])
    return {name: of(t) for name, t in header.items() if name != "__metadata__"}


def session(t):
    conv = lambda w, channels: w.reshape(WIDTH, channels, -1).transpose(2, 1, 0)
    gates = lambda w, axis: np.concatenate([np.split(w, 4, axis)[k] for k in (0, 3, 1, 2)], axis)  # i f g o to ONNX's i o f g
    n = lambda name: t["network." + name]
    first, second, state = n("first.bias").size, n("second.bias").size, n("recurrent.weight").shape[0]
    bias = np.concatenate([gates(n("input.bias"), 0), np.zeros(4 * state, "f4")])
    constants = {
        "w1": conv(n("first.weight"), CHANNELS), "b1": n("first.bias"),
        "w2": conv(n("second.weight"), first), "b2": n("second.bias"),
        "w": gates(n("input.weight"), 1).T[None], "r": gates(n("recurrent.weight"), 1).T[None], "b": bias[None],
        "wh": n("head.weight"), "bh": n("head.bias"), "axis": np.array([0], "i8"),
    }
    node = helper.make_node
    nodes = [
        node("Transpose", ["windows"], ["x0"], perm=[0, 2, 1]),
        node("Conv", ["x0", "w1", "b1"], ["x1"], strides=[STRIDE], kernel_shape=[WIDTH]), node("Relu", ["x1"], ["x2"]),
        node("Conv", ["x2", "w2", "b2"], ["x3"], strides=[STRIDE], kernel_shape=[WIDTH]), node("Relu", ["x3"], ["x4"]),
        node("Transpose", ["x4"], ["x5"], perm=[2, 0, 1]),
        node("LSTM", ["x5", "w", "r", "b"], ["", "h"], hidden_size=state), node("Squeeze", ["h", "axis"], ["h1"]),
        node("Concat", ["h1", "scores"], ["found"], axis=1), node("Gemm", ["found", "wh", "bh"], ["logits"]),
    ]
    value = helper.make_tensor_value_info
    features = t["normal"].shape[0]
    graph = helper.make_graph(
        nodes, "nlos",
        [value("windows", TensorProto.FLOAT, [None, TAPS, CHANNELS]), value("scores", TensorProto.FLOAT, [None, features])],
        [value("logits", TensorProto.FLOAT, [None, n("head.bias").size])],
        [numpy_helper.from_array(np.ascontiguousarray(v), k) for k, v in constants.items()],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=9)
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    return onnxruntime.InferenceSession(model.SerializeToString(), options, providers=["CPUExecutionProvider"])


def main(model, folder):
    t = tensors(model)
    run = session(t)
    read = lambda name, *shape: np.fromfile(f"{folder}/{name}", "<f4").reshape(BATCH, *shape)
    windows, scores, ours = read("windows", TAPS, CHANNELS), read("scores", -1), read("logits", -1)
    ask = lambda k, n: run.run(None, {"windows": windows[k : k + n], "scores": scores[k : k + n]})[0]
    off = np.abs(ask(0, BATCH) - ours).max()
    if off > 1e-5:
        sys.exit(f"onnxruntime and adit differ by {off}, expected 1e-5 or less")
    rates = []
    for n in (1, BATCH):
        best = 0.0
        for _ in range(5):
            start, count = time.perf_counter(), 0
            while time.perf_counter() - start < 0.4:
                for k in range(0, BATCH, n):
                    ask(k, n)
                count += BATCH
            best = max(best, count / (time.perf_counter() - start))
        rates.append(best)
    print(f"{rates[0]:.0f} {rates[1]:.0f}")


main(*sys.argv[1:])
