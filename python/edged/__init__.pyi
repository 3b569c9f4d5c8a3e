# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Edged USLAM: visual-inertial odometry from events, frames and an IMU. Measurements go in as numpy arrays, steps
come out:

    odometry = edged.Odometry("davis240c_ecd")
    odometry.add_imu(edged.make_imu(t, gyro, accel))
    odometry.add_events("events", edged.make_events(t, x, y, p))
    for step in odometry:
        print(step.t, step.status, step.position)

Stamps are whole nanoseconds, of each sensor's own clock as recorded; lengths are metres, angles radians. Frames: W is
the world, z up; B the body, with the axes of the IMU; C a camera, x right, y down, z forward. T_W_B maps points of B to
W. Quaternions are x, y, z, w. Images are height x width. Arrays that the module returns are read-only where they share
the library's memory. InputError is what you can correct; a misfit of arrays or arguments is a ValueError or TypeError.
"""
# Each text is here once: edged/_docs.py gives the module the same.
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
"""The version of the library, as `edged --version` has it."""

EVENT: np.dtype[np.void]
"""dtype of an event, the library's own 16 bytes: t [ns], column x and row y [px] of the distorted image, p
(brighter)."""
IMU: np.dtype[np.void]
"""dtype of an IMU sample in the axes of B: t [ns], gyro [rad/s] (3), accel (3): specific force [m/s^2], upwards at
rest; interpolated (where the recording has a gap)."""
POSE: np.dtype[np.void]
"""dtype of a pose T_W_X, X the body or a camera: t [ns], position of X in W [m] (3), quaternion x, y, z, w of its axes
in W (4)."""

_Option = bool | int | float | str
_Mode = Literal["events", "frames", "fused"]
_Path = str | os.PathLike[str]


class InputError(ValueError):
    """An error that the user can correct, in one line: file, line or key, and the remedy."""


class Status:
    """The quality of the present pose. Status(1) is GOOD. Not an enum.Enum: compare the values with ==."""
    INITIALIZING: ClassVar[Status]
    """No estimate yet; step.waiting_for says why."""
    GOOD: ClassVar[Status]
    """The pose is to be trusted."""
    DEGRADED: ClassVar[Status]
    """A pose with less support; step.degraded_because says why."""
    LOST: ClassVar[Status]
    """No pose; step.lost_because says why. The estimator starts again by itself."""
    __members__: ClassVar[dict[str, Status]]
    """The statuses by name, in this order."""
    def __init__(self, value: int) -> None:
        """The status of that number, 0 to 3."""
    @property
    def name(self) -> str:
        """"INITIALIZING", "GOOD", "DEGRADED" or "LOST"."""
    @property
    def value(self) -> int:
        """0 to 3, in this order."""
    def __int__(self) -> int:
        """Its value."""
    def __index__(self) -> int:
        """Its value."""


class Camera:
    """A camera of a rig: lens, pose and clock."""
    @property
    def name(self) -> str:
        """Its name, as add_events and add_frame take it."""
    @property
    def modality(self) -> Literal["events", "frames"]:
        """What it delivers. A sensor that gives both is two cameras."""
    @property
    def size(self) -> tuple[int, int]:
        """Width, height [px]."""
    @property
    def pinhole(self) -> tuple[float, float, float, float]:
        """fx, fy, cx, cy [px]; of the undistorted event frame, too. The centre of the top left pixel is (0, 0)."""
    @property
    def T_B_C(self) -> NDArray[np.float64]:
        """Pose in the body, 4 x 4 [m]: p_B = T_B_C p_C."""
    @property
    def time_offset(self) -> int:
        """t_imu = t_cam + time_offset [ns]."""


class Calibration:
    """Cameras around the IMU, and the noise of the IMU. print() shows all of it. From load_rig, load_calibration or a
    Recording."""
    @property
    def rig(self) -> dict[str, Camera]:
        """Its cameras by name."""
    @property
    def has_extrinsics(self) -> bool:
        """False: the file has intrinsics only, each T_B_C and time_offset is a placeholder, and Odometry refuses it."""
    @property
    def warnings(self) -> list[str]:
        """What seems wrong, each one line."""
    def to_yaml(self) -> str:
        """As a file for `edged run --calib` and rig=."""


class _BodyState:
    """The body at t."""
    @property
    def t(self) -> int:
        """Stamp [ns] on the IMU's clock."""
    @property
    def T_W_B(self) -> NDArray[np.float64]:
        """Pose in the world, 4 x 4 [m]: p_W = T_W_B p_B."""
    @property
    def position(self) -> NDArray[np.float64]:
        """B in W [m], shape (3,)."""
    @property
    def quaternion(self) -> NDArray[np.float64]:
        """Rotation from B to W: x, y, z, w, shape (4,)."""
    @property
    def velocity(self) -> NDArray[np.float64]:
        """B in W [m/s], shape (3,)."""
    @property
    def bias_gyro(self) -> NDArray[np.float64]:
        """In B [rad/s], shape (3,): measured = true + bias."""
    @property
    def bias_accel(self) -> NDArray[np.float64]:
        """In B [m/s^2], shape (3,): measured = true + bias."""


class State(_BodyState):
    """The body at t, predicted by the IMU from the newest step."""


class CameraStep:
    """One camera of the run, at one packet. Arrays are read-only and keep the step alive."""
    @property
    def name(self) -> str:
        """The camera, as in Odometry.rig."""
    @property
    def modality(self) -> Literal["events", "frames"]:
        """What it delivers."""
    @property
    def image(self) -> NDArray[np.uint8] | None:
        """Height x width: the event frame, motion-compensated and undistorted, or the frame as it came; None in packets
        without."""
    @property
    def tracks(self) -> NDArray[np.void]:
        """One row a feature: id, pixel (2) and previous_pixel (2) [px] of image, point (2) on the plane z = 1 of the
        camera, age [images], first_seen [ns]. Where image is None: pixels of the last one."""
    @property
    def survival_rate(self) -> float:
        """Running mean of the share of tracks that survive an image, 0 to 1."""
    @property
    def events(self) -> NDArray[np.void]:
        """An array of EVENT: those of the packet, oldest first, on the IMU's clock; some were in the one before."""
    @property
    def rendered(self) -> int:
        """How many of them, the newest, image shows."""
    @property
    def event_rate_hz(self) -> float:
        """Events a second in this packet; 0 for frames."""


class LoopClosure:
    """The body is at a place that was mapped long before: the drift since then is corrected, and the pose jumps."""
    @property
    def keyframe(self) -> int:
        """Stamp of the keyframe that shows the place [ns], IMU clock."""
    @property
    def position_m(self) -> float:
        """Size of the correction [m]."""
    @property
    def rotation_rad(self) -> float:
        """Angle of the correction [rad]."""


class Step(_BodyState):
    """What one packet of measurements brought. The state means nothing while status is INITIALIZING. Arrays of tracks,
    landmarks, events and images are the step's own memory, read-only, and keep it alive."""
    @property
    def status(self) -> Status:
        """Whether the pose is to be trusted."""
    @property
    def is_tracking(self) -> bool:
        """Whether there is a pose: GOOD or DEGRADED."""
    def pose_of(self, frame: str) -> NDArray[np.void]:
        """One POSE, shape (1,): of "body" or a camera, on its own clock, by the calibration estimated by then. Raises
        InputError for another name."""
    @property
    def position_covariance(self) -> NDArray[np.float64] | None:
        """3 x 3, in W [m^2], relative to the first start; None without an estimate."""
    @property
    def rotation_covariance(self) -> NDArray[np.float64] | None:
        """3 x 3, in B [rad^2], of phi in R_true = R Exp(phi); None without an estimate."""
    @property
    def velocity_covariance(self) -> NDArray[np.float64] | None:
        """3 x 3, in W [m^2/s^2]; None without an estimate."""
    @property
    def attitude(self) -> NDArray[np.float64] | None:
        """R_W_B as x, y, z, w, while INITIALIZING: by gyro and accelerometer, the heading since the first
        measurement."""
    @property
    def keyframe(self) -> bool:
        """Whether this packet became a keyframe."""
    @property
    def relocalized(self) -> bool:
        """After a loss, or in a loaded map: the pose has jumped to its place in the map."""
    @property
    def loop_closure(self) -> LoopClosure | None:
        """The one that this packet brought."""
    @property
    def waiting_for(self) -> str:
        """While INITIALIZING: why there is no estimate yet, with numbers."""
    @property
    def started(self) -> str:
        """How the estimator was initialized, with numbers, if that was with this packet; else ""."""
    @property
    def lost_because(self) -> str:
        """While LOST: what ended the last estimate, with numbers."""
    @property
    def degraded_because(self) -> str:
        """While DEGRADED: why the pose is not GOOD, with numbers."""
    @property
    def contradicted(self) -> bool:
        """While lost: the cameras contradicted the IMU, so the last poses before are wrong."""
    @property
    def cameras(self) -> dict[str, CameraStep]:
        """By name: those of the run, event cameras first. What follows is of the first of its kind."""
    @property
    def event_tracks(self) -> NDArray[np.void]:
        """Rows as in CameraStep.tracks, in pixels of the event frame."""
    @property
    def frame_tracks(self) -> NDArray[np.void]:
        """Rows as in CameraStep.tracks, in pixels of the frame as it came."""
    @property
    def event_track_survival_rate(self) -> float | None:
        """Running mean of the share of tracks that survive an image, 0 to 1; None without that camera."""
    @property
    def frame_track_survival_rate(self) -> float | None:
        """As event_track_survival_rate, of the frame camera."""
    @property
    def landmarks(self) -> NDArray[np.void]:
        """One row a landmark: id (of the corner), p_W (3) [m]; only where the window was solved."""
    @property
    def event_frame(self) -> NDArray[np.uint8] | None:
        """Height x width, motion-compensated, undistorted; None when there were too few events."""
    @property
    def frame(self) -> NDArray[np.uint8] | None:
        """The frame that came at t, height x width, distorted; None in packets without."""
    @property
    def events(self) -> NDArray[np.void]:
        """An array of EVENT: those of the packet, oldest first, on the IMU's clock; some were in the one before."""
    @property
    def rendered(self) -> int:
        """How many of them, the newest, event_frame shows."""
    @property
    def event_rate_hz(self) -> float:
        """Events a second in this packet."""
    @property
    def scene_depth(self) -> float:
        """Depth along z of the camera [m] by which events are motion-compensated."""


class Measurement:
    """One measurement of a Recording, for Odometry.add."""
    @property
    def kind(self) -> Literal["events", "frame", "imu", "height", "velocity"]:
        """The sensor's kind, which says what data holds."""
    @property
    def camera(self) -> str | None:
        """The camera of events and of a frame; else None."""
    @property
    def t(self) -> int:
        """The first stamp [ns], on the sensor's clock."""
    @property
    def data(self) -> NDArray[Any]:
        """An array of EVENT, an image (uint8, height x width), or an array of IMU of one row; read-only, without a
        copy. Of height [m] and velocity [m/s] two rows, values and sigmas."""


class FinalTrajectory:
    """Poses and map by all measurements. Not causal: later measurements contribute."""
    @property
    def poses(self) -> NDArray[np.void]:
        """POSE of the body, one a Good or Degraded step."""
    @property
    def keyframes(self) -> NDArray[np.void]:
        """POSE of the body, those that the map has kept; negative stamps: of a map that was loaded."""
    @property
    def points(self) -> NDArray[np.float64]:
        """Points of the map in W [m], N x 3."""


class Odometry:
    """One rig, one mode, from the first measurement to the last. Without the GIL while it works. Any thread may call
    add_*, finish, newest_state and state_at; calls of the other functions wait for each other."""
    def __init__(self, calibration: Calibration | _Path, mode: _Mode = "fused", options: Mapping[str, _Option] = {},
                 in_order: bool = False, delays: Mapping[str, float] = {}) -> None:
        """calibration: also a rig's name, or a file. options: those of `edged config`. in_order: measurements come as a
        recording gives them, nothing is waited for. delays: by how much "events", "frames", "imu" and "external"
        (height, velocity) may lag behind the newest of all [s]. Raises InputError for a rig that is not found or lacks
        a camera of the mode, and for what is no option or out of its range."""
    def add_events(self, camera: str, events: NDArray[np.void]) -> None:
        """An array of EVENT in any portions, those of one camera in order. Raises InputError for a camera that the
        calibration does not have; TypeError for another dtype, ValueError for another shape or gaps in memory."""
    def add_frame(self, camera: str, t: int, image: NDArray[np.uint8]) -> None:
        """A grey image, height x width of the camera, stamped [ns] at the middle of its exposure. Raises as add_events
        does."""
    def add_imu(self, samples: NDArray[np.void]) -> None:
        """An array of IMU, in order. Raises TypeError for another dtype, ValueError for another shape or gaps in
        memory."""
    def add_height(self, t: int, height: float, sigma: float = 0.0) -> None:
        """[m], up, from any zero; t [ns] on the IMU's clock. sigma [m]: 0 for the option's."""
    def add_velocity(self, t: int, velocity: Sequence[float] | NDArray[np.float64],
                     sigma: float | Sequence[float] | NDArray[np.float64] = 0.0) -> None:
        """Three numbers [m/s] in the axes of the sensor; t [ns] on the IMU's clock. sigma [m/s]: one, or one an axis; 0
        for the option's, inf for an axis not measured. Raises InputError for another number of them."""
    def add(self, measurement: Measurement) -> None:
        """A measurement of a Recording. As with all add_*: data that is late or unusable is counted in counters, not
        raised."""
    def finish(self) -> None:
        """Marks the end of the measurements: next() returns the remaining steps."""
    def next(self) -> Step | None:
        """The next step; None: add more. Does not block."""
    def __iter__(self) -> Iterator[Step]:
        """The steps that there are by now; again after more was added."""
    def __next__(self) -> Step:
        """As next(), with StopIteration in place of None."""
    def newest_state(self) -> State | None:
        """At the newest IMU sample, predicted from the newest step; None without an estimate, or a second after it. Any
        thread."""
    def state_at(self, t: int) -> State | None:
        """Propagated by the IMU to t [ns] since the newest step; None where there is no state. Any thread."""
    def load_map(self, map: bytes) -> None:
        """Bytes of save_map of another run, before the first measurement. Poses are in its frame once relocalized.
        Raises InputError for other bytes, another camera, or after a measurement."""
    def save_map(self) -> bytes | None:
        """The map; None while awaiting_relocalization."""
    @property
    def awaiting_relocalization(self) -> bool:
        """A map was loaded, and the body has not been relocalized in it yet."""
    def final_trajectory(self) -> FinalTrajectory:
        """Trajectory and map, from all measurements so far, by one optimization: about a second for a minute of
        flight."""
    @property
    def rig(self) -> dict[str, Camera]:
        """The cameras of the mode with their online calibration."""
    @property
    def counters(self) -> dict[str, int]:
        """Packets, and dropped measurements by reason."""
    @property
    def timings(self) -> dict[str, float]:
        """Seconds spent by stage."""


class RecordedCamera:
    """A camera that a Recording reads."""
    @property
    def name(self) -> str:
        """Its name in measurements."""
    @property
    def kind(self) -> Literal["events", "frames"]:
        """What it delivers."""
    @property
    def stream(self) -> str:
        """Its topic, stream or file; "" where there is only one."""
    @property
    def sensor(self) -> tuple[int, int]:
        """Width, height [px] of an event camera; (0, 0) where it is not known."""


class RecordingInfo:
    """What is known of a recording before it is read through."""
    @property
    def name(self) -> str:
        """The file or folder, or the simulator's preset."""
    @property
    def format(self) -> str:
        """"ecd", "euroc", "simulator" and so on (docs/formats.md)."""
    @property
    def pose_frame(self) -> str:
        """Whose poses the ground truth has: "body" (also without one) or a camera."""
    @property
    def begin(self) -> int | None:
        """First stamp of any sensor [ns]; None where only reading through would tell."""
    @property
    def end(self) -> int | None:
        """Last stamp of any sensor [ns]; None where only reading through would tell."""
    @property
    def has_events(self) -> bool:
        """Whether there is an event camera."""
    @property
    def has_frames(self) -> bool:
        """Whether there is a frame camera."""
    @property
    def has_imu(self) -> bool:
        """Whether there is an IMU."""
    @property
    def external(self) -> list[str]:
        """Names of its other sensors: "height", "velocity"."""
    @property
    def event_camera(self) -> str:
        """Name of the first event camera."""
    @property
    def frame_camera(self) -> str:
        """Name of the first frame camera."""
    @property
    def event_sensor(self) -> tuple[int, int]:
        """Width, height [px] of the first event camera; (0, 0) where it is not known."""
    @property
    def cameras(self) -> list[RecordedCamera]:
        """All that are read, of each kind the first first."""


class Recording:
    """Measurements in the order of their stamps, once: `for measurement in recording`. From open_recording or
    simulate."""
    @property
    def info(self) -> RecordingInfo:
        """Its sensors, names and time span."""
    @property
    def calibration(self) -> Calibration | None:
        """The one it was opened with, else its own; None where it has none."""
    @property
    def ground_truth(self) -> tuple[str, NDArray[np.void]] | None:
        """Whose poses they are ("body" or a camera), and an array of POSE on that sensor's clock; None where it has
        none."""
    @property
    def repairs(self) -> dict[str, int]:
        """Repairs made so far, by kind, with counts."""
    def odometry(self, mode: _Mode | Literal["auto"] = "auto", options: Mapping[str, _Option] = {}) -> Odometry:
        """Made for this recording: its calibration, cameras under its names, in order. Raises InputError where it has
        no calibration, or lacks a sensor of the mode."""
    def __iter__(self) -> Iterator[Measurement]:
        """The measurements that have not been read yet."""
    def __next__(self) -> Measurement:
        """The next measurement. Raises InputError for damage that cannot be repaired."""


def known_rigs() -> list[str]:
    """The names of the calibrations that ship."""
def load_rig(name: _Path) -> Calibration:
    """A calibration that ships, by its name, or a file. Raises InputError that lists the names."""
def load_calibration(path: _Path) -> Calibration:
    """A calibration file or folder of any format (docs/calibration.md). Raises InputError for what is none."""
def open_recording(path: _Path, rig: Calibration | _Path | None = None, topics: Mapping[str, str] = {},
                   geometry: tuple[int, int] | None = None, time_unit: Literal["s", "ms", "us", "ns"] | None = None,
                   begin_s: float | None = None, end_s: float | None = None,
                   cameras: Sequence[str] | Literal["all", "first"] | None = None,
                   imu_time_offset: float | Literal["auto"] | None = None, *, imu: _Path | None = None,
                   height: _Path | None = None, velocity: _Path | None = None) -> Recording:
    """A file, a folder, or tcp://HOST:PORT. rig: a calibration, its name or file. topics: of bags and AEDAT4, role or
    camera to topic. geometry: width and height of the event sensor [px], where the file does not tell. time_unit: of
    stamps in plain event files. begin_s, end_s: the piece to read, since the first stamp [s]. cameras: those to read;
    None: as `edged run`, two of a kind where their views overlap, else the first; "first": of each kind. imu, height,
    velocity: csv or txt files of such samples, the IMU's instead of its own. imu_time_offset: seconds to add to the
    stamps of an IMU with an epoch of its own, or "auto". Raises InputError that lists what was looked for."""
def simulate(preset: str = "room", seed: int = 1, duration_s: float | None = None, options: Mapping[str, _Option] = {},
             begin_s: float | None = None, end_s: float | None = None,
             baseline_m: float | None = None) -> Recording:
    """A simulated flight. duration_s: of the whole flight [s]; begin_s, end_s: the piece of it to read. options: those
    of `edged simulate --list`. baseline_m: of a second camera of each kind [m]. Raises InputError for an unknown preset
    or option."""
def simulator_presets() -> list[str]:
    """The names of the simulated flights."""
def read_trajectory(file: _Path) -> NDArray[np.void]:
    """An array of POSE from a file of TUM, EuRoC or other formats that `edged eval` reads. Raises InputError for
    another."""
def make_events(t: ArrayLike, x: ArrayLike, y: ArrayLike, p: ArrayLike) -> NDArray[np.void]:
    """An array of EVENT from columns of one length: stamps [ns], columns and rows of pixels (whole numbers within 16
    bits), and whether it became brighter (p > 0). Raises ValueError or TypeError where a column does not fit: nothing
    is cut, wrapped or repeated."""
def make_imu(t: ArrayLike, gyro: ArrayLike, accel: ArrayLike) -> NDArray[np.void]:
    """An array of IMU from stamps [ns], rates [rad/s] and specific forces [m/s^2] in the axes of B, N x 3 each; or one
    of each. Raises as make_events does."""
def make_poses(t: ArrayLike, position: ArrayLike, quaternion: ArrayLike) -> NDArray[np.void]:
    """An array of POSE from stamps [ns], positions [m] N x 3 and quaternions (x, y, z, w) N x 4; or one of each. Raises
    as make_events does."""
def write_run(recording: _Path, out: _Path | None = None, options: Mapping[str, _Option] | None = None,
              **flags: Any) -> dict[str, Any]:
    """Writes the run folder of a recording with trajectories, metrics.json and report.html, as `edged run` does (in a
    process of its own), and returns its metrics.json: "folder", "verdict", "trusted", "ate_rmse_m" and so on.
    recording: a path, or "sim:room:3". out: the folder; None: runs/NAME-MODE. flags: those of `edged run --help`, such
    as rig="davis240c_ecd", mode="events", imu="imu.csv", force=True. Ctrl-C ends the run with complete files. Raises
    InputError with the program's message."""
def trajectory(steps: Iterable[Step], frame: str = "body") -> NDArray[np.void]:
    """An array of POSE: those of the steps that have one (status GOOD or DEGRADED), of the body on the IMU's clock, or
    of a camera on its own. Raises InputError for an unknown camera."""
def run(recording: Recording, mode: _Mode | Literal["auto"] = "auto",
        options: Mapping[str, _Option] | None = None) -> Iterator[Step]:
    """The steps of the odometry over a recording, as it goes; "auto": from all sensors that there are. As `edged run`
    it checks recording and calibration against each other, and logs what it finds (logger "edged"). Raises as
    Recording.odometry does."""
def evaluate(estimate: NDArray[np.void], truth: NDArray[np.void], protocol: Literal["P1", "P2", "P3", "P4"] = "P3",
             max_gap_s: float = 0.2, deltas_s: Sequence[float] = (1.0, 10.0)) -> dict[str, Any]:
    """How far the estimate is from the truth, both arrays of POSE of the same sensor on the same clock, in time order:
    the dictionary that `edged eval --json` prints. P1: SE(3) on seconds 3 to 8; P2: SE(3) on the first 5 s; P3: SE(3)
    on all; P4: Sim(3) on all. max_gap_s: poses further apart are not interpolated [s]; deltas_s: spans of the relative
    error [s]. Raises InputError where no stamps meet, ValueError for a quaternion that is no rotation."""
