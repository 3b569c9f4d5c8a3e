# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
import enum
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
__all__: list[str]

EVENT: np.dtype[np.void]
"""t [ns], x, y [px], p (brighter): the library's own 16 bytes."""
IMU: np.dtype[np.void]
"""t [ns], gyro [rad/s], accel [m/s^2], interpolated (interpolated where the recording has a gap)."""
POSE: np.dtype[np.void]
"""t [ns], position [m], quaternion x, y, z, w."""

Option = bool | int | float | str
Mode = Literal["events", "frames", "fused"]
Path = str | os.PathLike[str]


class InputError(ValueError):
    """An error that the user can correct, in one line: file, line or key, and the remedy."""


class Status(enum.Enum):
    INITIALIZING = 0
    GOOD = 1
    DEGRADED = 2
    LOST = 3


class Camera:
    @property
    def name(self) -> str: ...
    @property
    def modality(self) -> Literal["events", "frames"]: ...
    @property
    def size(self) -> tuple[int, int]:
        """Width, height [px]."""
    @property
    def pinhole(self) -> tuple[float, float, float, float]:
        """fx, fy, cx, cy [px]; of the undistorted event frame, too."""
    @property
    def T_B_C(self) -> NDArray[np.float64]: ...
    @property
    def time_offset(self) -> int:
        """t_imu = t_cam + time_offset [ns]."""


class Calibration:
    @property
    def rig(self) -> dict[str, Camera]: ...
    @property
    def has_extrinsics(self) -> bool: ...
    @property
    def warnings(self) -> list[str]: ...
    def to_yaml(self) -> str:
        """As a file for `edged run --calib` and rig=."""


class _BodyState:
    """Of the body at t, on the IMU's clock."""
    @property
    def t(self) -> int: ...
    @property
    def T_W_B(self) -> NDArray[np.float64]: ...
    @property
    def position(self) -> NDArray[np.float64]: ...
    @property
    def quaternion(self) -> NDArray[np.float64]:
        """x, y, z, w."""
    @property
    def velocity(self) -> NDArray[np.float64]:
        """In W [m/s]."""
    @property
    def bias_gyro(self) -> NDArray[np.float64]: ...
    @property
    def bias_accel(self) -> NDArray[np.float64]: ...


class State(_BodyState): ...


class CameraStep:
    """One camera of the run, at one packet."""
    @property
    def name(self) -> str: ...
    @property
    def modality(self) -> Literal["events", "frames"]: ...
    @property
    def image(self) -> NDArray[np.uint8] | None:
        """The event frame, motion-compensated and undistorted, or the frame as it came; None in packets without."""
    @property
    def tracks(self) -> NDArray[np.void]:
        """id, pixel, point, previous_pixel, age, first_seen; pixels of image."""
    @property
    def survival_rate(self) -> float:
        """Running mean of the share of tracks that survive an image, 0 to 1."""
    @property
    def events(self) -> NDArray[np.void]:
        """Of the packet, oldest first, on the IMU's clock; some were in the one before."""
    @property
    def rendered(self) -> int:
        """How many of them, the newest, image shows."""
    @property
    def event_rate_hz(self) -> float: ...


class LoopClosure:
    """The body is at a place that was mapped long before: the drift since then is corrected, and the pose jumps."""
    @property
    def keyframe(self) -> int:
        """Stamp of the keyframe that shows the place [ns], IMU clock."""
    @property
    def position_m(self) -> float:
        """Size of the correction."""
    @property
    def rotation_rad(self) -> float: ...


class Step(_BodyState):
    """What one packet of measurements brought. The state means nothing while status is INITIALIZING. Arrays are the step's own
    memory, read-only, and keep it alive."""
    @property
    def status(self) -> Status: ...
    @property
    def is_tracking(self) -> bool:
        """Whether there is a pose: GOOD or DEGRADED."""
    def pose_of(self, frame: str) -> NDArray[np.void]:
        """One POSE: of "body" or a camera, on its own clock, by the calibration estimated by then."""
    @property
    def position_covariance(self) -> NDArray[np.float64] | None:
        """In W [m^2], relative to the first start."""
    @property
    def rotation_covariance(self) -> NDArray[np.float64] | None:
        """In B [rad^2], of phi in R_true = R Exp(phi)."""
    @property
    def velocity_covariance(self) -> NDArray[np.float64] | None:
        """In W [m^2/s^2]."""
    @property
    def attitude(self) -> NDArray[np.float64] | None:
        """R_W_B as x, y, z, w, while INITIALIZING: by gyro and accelerometer, the heading since the first measurement."""
    @property
    def keyframe(self) -> bool: ...
    @property
    def relocalized(self) -> bool:
        """After a loss, or in a loaded map: the pose has jumped to its place in the map."""
    @property
    def loop_closure(self) -> LoopClosure | None:
        """By this packet."""
    @property
    def waiting_for(self) -> str: ...
    @property
    def started(self) -> str: ...
    @property
    def lost_because(self) -> str: ...
    @property
    def degraded_because(self) -> str: ...
    @property
    def contradicted(self) -> bool:
        """While lost: the cameras contradicted the IMU, so the last poses before are wrong."""
    @property
    def cameras(self) -> dict[str, CameraStep]:
        """By name: those of the run, event cameras first. What follows is of the first of its kind."""
    @property
    def event_tracks(self) -> NDArray[np.void]:
        """id, pixel, point, previous_pixel, age, first_seen; pixels of the event frame."""
    @property
    def frame_tracks(self) -> NDArray[np.void]: ...
    @property
    def event_track_survival_rate(self) -> float | None:
        """Running mean of the share of tracks that survive an image, 0 to 1; None without that camera."""
    @property
    def frame_track_survival_rate(self) -> float | None: ...
    @property
    def landmarks(self) -> NDArray[np.void]:
        """id (of the corner), p_W [m]; only where the window was solved."""
    @property
    def event_frame(self) -> NDArray[np.uint8] | None:
        """Motion-compensated, undistorted; None when there were too few events."""
    @property
    def frame(self) -> NDArray[np.uint8] | None:
        """That came at t."""
    @property
    def events(self) -> NDArray[np.void]:
        """Of the packet, oldest first, on the IMU's clock; some were in the one before."""
    @property
    def rendered(self) -> int:
        """How many of them, the newest, event_frame shows."""
    @property
    def event_rate_hz(self) -> float: ...
    @property
    def scene_depth(self) -> float: ...


class Measurement:
    @property
    def kind(self) -> Literal["events", "frame", "imu", "height", "velocity"]: ...
    @property
    def camera(self) -> str | None: ...
    @property
    def t(self) -> int:
        """The first stamp."""
    @property
    def data(self) -> NDArray[Any]:
        """An array of EVENT, an image, or an array of IMU of one row; read-only, without a copy. Of height and velocity
        two rows, values and sigmas."""


class FinalTrajectory:
    """Not causal: later measurements contribute."""
    @property
    def poses(self) -> NDArray[np.void]:
        """POSE, one a Good or Degraded step."""
    @property
    def keyframes(self) -> NDArray[np.void]:
        """POSE, those that the map has kept; negative stamps: of a map that was loaded."""
    @property
    def points(self) -> NDArray[np.float64]:
        """Of the map, one row a point, in W [m]."""


class Odometry:
    """One rig, one mode, from the first measurement to the last. Without the GIL while it works."""
    def __init__(self, calibration: Calibration | Path, mode: Mode = "fused", options: Mapping[str, Option] = {},
                 in_order: bool = False, delays: Mapping[str, float] = {}) -> None:
        """calibration: also a rig's name, or a file. in_order: measurements come as a recording gives them, nothing is waited
        for. delays: by how much "events", "frames", "imu" and "external" (height, velocity) may lag behind the newest of all [s]."""
    def add_events(self, camera: str, events: NDArray[np.void]) -> None:
        """An array of EVENT in any portions, those of one camera in order. Raises InputError for a camera that the
        calibration does not have."""
    def add_frame(self, camera: str, t: int, image: NDArray[np.uint8]) -> None:
        """A grey image, stamped [ns] at the middle of its exposure. Raises InputError as add_events does."""
    def add_imu(self, samples: NDArray[np.void]) -> None:
        """An array of IMU, in order."""
    def add_height(self, t: int, height: float, sigma: float = 0.0) -> None:
        """[m], up, from any zero. sigma: 0 for the option's."""
    def add_velocity(self, t: int, velocity: Sequence[float] | NDArray[np.float64],
                     sigma: float | Sequence[float] | NDArray[np.float64] = 0.0) -> None:
        """[m/s] in the axes of the sensor. sigma: one, or one an axis; 0 for the option's, inf for an axis not measured."""
    def add(self, measurement: Measurement) -> None:
        """A measurement of a Recording."""
    def finish(self) -> None:
        """Marks the end of the measurements: next() returns the remaining steps."""
    def next(self) -> Step | None:
        """None: add more. Does not block."""
    def __iter__(self) -> Iterator[Step]:
        """The steps that there are by now; again after more was added."""
    def __next__(self) -> Step: ...
    def newest_state(self) -> State | None:
        """At the newest IMU sample; any thread."""
    def state_at(self, t: int) -> State | None:
        """Propagated by the IMU to t [ns]; None where there is no state; any thread."""
    def load_map(self, map: bytes) -> None:
        """Bytes of save_map of another run, before the first measurement. Poses are in its frame once relocalized."""
    def save_map(self) -> bytes | None:
        """The map; None while awaiting_relocalization."""
    @property
    def awaiting_relocalization(self) -> bool:
        """A map was loaded, and the body has not been relocalized in it yet."""
    def final_trajectory(self) -> FinalTrajectory:
        """Trajectory and map, from all measurements so far."""
    @property
    def rig(self) -> dict[str, Camera]:
        """The cameras of the mode with their online calibration."""
    @property
    def counters(self) -> dict[str, int]:
        """Packets, and dropped measurements."""
    @property
    def timings(self) -> dict[str, float]:
        """Seconds spent by stage."""


class RecordedCamera:
    @property
    def name(self) -> str: ...
    @property
    def kind(self) -> Literal["events", "frames"]: ...
    @property
    def stream(self) -> str:
        """Its topic, stream or file; "" where there is only one."""
    @property
    def sensor(self) -> tuple[int, int]:
        """Of an event camera; (0, 0) where it is not known."""


class RecordingInfo:
    @property
    def name(self) -> str: ...
    @property
    def format(self) -> str: ...
    @property
    def pose_frame(self) -> str: ...
    @property
    def begin(self) -> int | None: ...
    @property
    def end(self) -> int | None: ...
    @property
    def has_events(self) -> bool: ...
    @property
    def has_frames(self) -> bool: ...
    @property
    def has_imu(self) -> bool: ...
    @property
    def external(self) -> list[str]:
        """Names of its other sensors: "height", "velocity"."""
    @property
    def event_camera(self) -> str: ...
    @property
    def frame_camera(self) -> str: ...
    @property
    def event_sensor(self) -> tuple[int, int]: ...
    @property
    def cameras(self) -> list[RecordedCamera]:
        """All that are read, of each kind the first first."""


class Recording:
    """Measurements in the order of their stamps, once."""
    @property
    def info(self) -> RecordingInfo: ...
    @property
    def calibration(self) -> Calibration | None: ...
    @property
    def ground_truth(self) -> tuple[str, NDArray[np.void]] | None:
        """Whose poses they are ("body" or a camera), and an array of POSE on that sensor's clock."""
    @property
    def repairs(self) -> dict[str, int]: ...
    def odometry(self, mode: Mode | Literal["auto"] = "auto", options: Mapping[str, Option] = {}) -> Odometry:
        """Made for this recording: its calibration, cameras under its names, in order."""
    def __iter__(self) -> Iterator[Measurement]: ...
    def __next__(self) -> Measurement: ...


def known_rigs() -> list[str]:
    """The names of the calibrations that ship."""
def load_rig(name: Path) -> Calibration:
    """A calibration that ships, by its name, or a file."""
def load_calibration(path: Path) -> Calibration:
    """A calibration file or folder of any format (docs/calibration.md)."""
def open_recording(path: Path, rig: Calibration | Path | None = None, topics: Mapping[str, str] = {},
                   geometry: tuple[int, int] | None = None, time_unit: Literal["s", "ms", "us", "ns"] | None = None,
                   begin_s: float | None = None, end_s: float | None = None,
                   cameras: Sequence[str] | Literal["all", "first"] | None = None, *, imu: Path | None = None,
                   height: Path | None = None, velocity: Path | None = None) -> Recording:
    """A file, a folder, or tcp://HOST:PORT. rig: a calibration, its name or file. topics: of bags and AEDAT4, role or camera
    to topic. geometry: width and height of the event sensor [px], where the file does not tell. cameras: those to read; None: as
    `edged run`, two of a kind where their views overlap, else the first; "first": of each kind. imu, height, velocity: csv or txt
    files of such samples, the IMU's instead of its own."""
def simulate(preset: str = "room", seed: int = 1, duration_s: float | None = None, options: Mapping[str, Option] = {},
             begin_s: float | None = None, end_s: float | None = None,
             baseline_m: float | None = None) -> Recording:
    """A simulated flight. options: those of `edged simulate --list`. baseline_m: of a second camera of each kind [m]."""
def simulator_presets() -> list[str]:
    """The names of the simulated flights."""
def read_trajectory(file: Path) -> NDArray[np.void]:
    """An array of POSE from a file of TUM, EuRoC or other formats that `edged eval` reads."""
def make_events(t: ArrayLike, x: ArrayLike, y: ArrayLike, p: ArrayLike) -> NDArray[np.void]: ...
def make_imu(t: ArrayLike, gyro: ArrayLike, accel: ArrayLike) -> NDArray[np.void]: ...
def make_poses(t: ArrayLike, position: ArrayLike, quaternion: ArrayLike) -> NDArray[np.void]: ...
def write_run(recording: Path, out: Path | None = None, options: Mapping[str, Option] | None = None, **flags: Any) -> dict[str, Any]: ...
def trajectory(steps: Iterable[Step], frame: str = "body") -> NDArray[np.void]: ...
def run(recording: Recording, mode: Mode | Literal["auto"] = "auto", options: Mapping[str, Option] | None = None) -> Iterator[Step]: ...
def evaluate(estimate: NDArray[np.void], truth: NDArray[np.void], protocol: Literal["P1", "P2", "P3", "P4"] = "P3",
             max_gap_s: float = 0.2, deltas_s: Sequence[float] = (1.0, 10.0)) -> dict[str, Any]: ...
