# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Docstrings are in __init__.pyi, where editors and type checkers look; _docs.py gives them to the module.
import json as _json
import pathlib as _pathlib
import sys as _sys

import numpy as _numpy


def _how_to_build():
    """What to do where the compiled part of the module is missing."""
    here = _pathlib.Path(__file__).parent
    built = [file.name for file in here.glob("_edged*.so")]
    if built:
        return f"{here} holds {built[0]}, which is for another Python than this {_sys.version.split()[0]} ({_sys.executable})"
    root = _pathlib.Path(__file__).resolve().parents[2]
    return (f"the compiled part is not built; in {root}: `cmake --build build/release --target edged_python`, then "
            f"`export PYTHONPATH={root}/build/release/python`; or `pip install {root}` (docs/python.md)")


try:
    from ._edged import (EVENT, IMU, POSE, Calibration, Camera, CameraStep, FinalTrajectory, InputError, LoopClosure, Measurement, Odometry,
                         RecordedCamera, Recording, RecordingInfo, State, Status, Step, __version__, known_rigs, load_calibration, load_rig, open_recording, read_trajectory, simulate,
                         simulator_presets)
except ModuleNotFoundError as _error:
    if _error.name != "edged._edged":
        raise
    raise ImportError("edged: " + _how_to_build(), name=_error.name) from None
from ._edged import RunCheck as _RunCheck, append_doc as _append_doc, evaluate_to_json as _evaluate_to_json
from ._program import write_run

__all__ = [
    "EVENT", "IMU", "POSE", "Calibration", "Camera", "CameraStep", "FinalTrajectory", "InputError", "LoopClosure", "Measurement", "Odometry",
    "RecordedCamera", "Recording", "RecordingInfo", "State", "Status", "Step", "__version__", "evaluate", "known_rigs", "load_calibration", "load_rig", "make_events", "make_imu", "make_poses",
    "open_recording", "read_trajectory", "run", "simulate", "simulator_presets", "trajectory", "write_run"
]

for _class in (Calibration, Camera, CameraStep, FinalTrajectory, InputError, LoopClosure, Measurement, Odometry, RecordedCamera, Recording, RecordingInfo, State, Status, Step):
    _class.__module__ = __name__


def _column(name, values, field, rows):
    """The values of a field for that many rows, None: for one. Nothing is cut, wrapped or repeated."""
    values = _numpy.asarray(values)
    wanted = (*(() if rows is None else (rows,)), *field.shape)
    if values.shape != wanted:
        raise ValueError(f"{name}: its shape is {values.shape}; give {wanted}, as t has {'one stamp' if rows is None else f'{rows} stamps'}")
    if field.base.kind == "u" and values.size:
        bounds = _numpy.iinfo(field.base)
        if not _numpy.issubdtype(values.dtype, _numpy.integer):
            raise TypeError(f"{name}: dtype is {values.dtype}; give whole pixels: round or cast them first")
        if values.min() < 0 or values.max() > bounds.max:
            raise ValueError(f"{name}: holds {values.min() if values.min() < 0 else values.max()}; pixels are from 0 to {bounds.max}")
    return values


def _rows(dtype, t, **columns):
    """An array of that dtype from a column a field; a field that is not given is zero."""
    t = _numpy.asarray(t)
    if not _numpy.issubdtype(t.dtype, _numpy.integer):
        raise TypeError(f"t: dtype is {t.dtype}; give whole nanoseconds, as a float holds today's stamps to 256 ns")
    rows = _numpy.zeros(t.size, dtype)
    rows["t"] = _column("t", t, dtype["t"], t.size if t.ndim else None)
    for name, column in columns.items():
        rows[name] = _column(name, column, dtype[name], t.size if t.ndim else None)
    return rows


def make_events(t, x, y, p):
    return _rows(EVENT, t=t, x=x, y=y, p=_numpy.asarray(p) > 0)


def make_imu(t, gyro, accel):
    return _rows(IMU, t=t, gyro=gyro, accel=accel)


def make_poses(t, position, quaternion):
    return _rows(POSE, t=t, position=position, quaternion=quaternion)


def trajectory(steps, frame="body"):
    return _numpy.concatenate([_numpy.empty(0, POSE), *(step.pose_of(frame) for step in steps if step.is_tracking)])


def run(recording, mode="auto", options=None):
    odometry = recording.odometry(mode, options or {})
    check = _RunCheck(recording, odometry)
    for measurement in recording:
        check.add(measurement)
        odometry.add(measurement)
        yield from odometry
    odometry.finish()
    yield from odometry
    check.finish()


def evaluate(estimate, truth, protocol="P3", max_gap_s=0.2, deltas_s=(1.0, 10.0)):
    for name, poses in (("estimate", estimate), ("truth", truth)):
        if not isinstance(poses, _numpy.ndarray):
            raise TypeError(f"{name}: is a {type(poses).__name__}; give an array of edged.POSE, as edged.trajectory(steps) returns")
    return _json.loads(_evaluate_to_json(estimate, truth, protocol, max_gap_s, list(deltas_s)))


def _add_docs():
    from . import _docs
    _docs.add_docs(globals(), _pathlib.Path(__file__).with_name("__init__.pyi"), _append_doc)


_add_docs()
