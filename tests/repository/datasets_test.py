#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""bench/datasets: its sheets, the layouts of the data sets as generated files, from files to table, and other sensors' trajectories.
Usage: EDGED=path/to/edged datasets_test.py"""
import contextlib
import importlib.machinery
import importlib.util
import io
import json
import math
import pathlib
import re
import shutil
import sys
import tempfile
import types
import unittest
import unittest.mock

import yaml

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path[:0] = [str(BENCH), str(BENCH.parent / "tests/program")]
import sensor_frames  # noqa: E402
from program import EDGED, WithFolder, edged  # noqa: E402


def script(name):
    loader = importlib.machinery.SourceFileLoader(name, str(BENCH / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


datasets = script("datasets")


def bench(*arguments, sheets=datasets.SHEETS):
    """What bench/datasets prints."""
    said = io.StringIO()
    with unittest.mock.patch.object(sys, "argv", ["datasets", *map(str, arguments)]), unittest.mock.patch.object(datasets, "SHEETS", sheets), \
            contextlib.redirect_stdout(said), contextlib.redirect_stderr(io.StringIO()):
        datasets.main()
    return said.getvalue()


def thinned(flight):
    """With few of its events: runs are of frames."""
    events = (flight / "events.txt").read_text().splitlines(keepends=True)
    (flight / "events.txt").write_text("".join(events[::200]))


def camchain(flight, topics):
    """Kalibr's, with the first camera of a flight at each topic."""
    rig = yaml.safe_load((flight / "calibration.yaml").read_text())["cameras"][0]
    R, t = [row[:3] for row in rig["T_B_C"][:3]], [row[3] for row in rig["T_B_C"][:3]]
    back = [[R[j][i] for j in range(3)] + [-sum(R[j][i] * t[j] for j in range(3))] for i in range(3)] + [[0, 0, 0, 1]]
    camera = {"camera_model": "pinhole", "intrinsics": rig["intrinsics"], "distortion_model": "radtan", "resolution": rig["resolution"],
              "distortion_coeffs": rig["coefficients"][:4], "T_cam_imu": back, "timeshift_cam_imu": rig["time_offset"]}
    return yaml.safe_dump({f"cam{i}": {**camera, "rostopic": topic} for i, topic in enumerate(topics)})


def sheet(name):
    return yaml.safe_load((datasets.SHEETS / f"{name}.yaml").read_text())


class Sheets(unittest.TestCase):
    def test_there_is_one_for_each_data_set_and_it_tells_what_a_user_must_know(self):
        self.assertEqual(datasets.NAMES, ["dsec", "ecd", "eds", "euroc", "evslam", "hku", "m3ed", "mvsec", "tum_vi", "tum_vie",
                                          "uzh_fpv", "vector"])
        for name in datasets.NAMES:
            with self.subTest(sheet=name):
                known = sheet(name)
                for key in ("name", "page", "size", "licence", "clocks"):
                    self.assertTrue(known[key].strip(), key)
                self.assertTrue(known["pitfalls"] and known["truth"]["what"] and known["truth"]["source"])
                self.assertTrue(known.get("tables") or known["no_tables"])
                self.assertTrue(known["files"] and all(file["get"] and file["lies"] for file in known["files"]))

    def test_each_published_figure_has_a_sequence_and_a_source(self):
        for name in datasets.NAMES:
            for table in sheet(name).get("tables", []):
                self.assertIn(table["metric"], datasets.FIGURES)
                self.assertIn(table["protocol"], ("P1", "P2", "P3", "P4"))
                self.assertEqual(len(table.get("lengths_s", table["sequences"])), len(table["sequences"]))
                for method in table["methods"]:
                    with self.subTest(sheet=name, table=table["title"], method=method["name"]):
                        self.assertEqual(len(method["values"]), len(table["sequences"]))
                        self.assertTrue(method["source"])
                        for value in method["values"]:
                            self.assertTrue(value is None or value == "fail" or 0 < value < 100, value)

    def test_the_page_tells_of_each(self):
        page = (BENCH.parent / "docs/datasets.md").read_text()
        for name in datasets.NAMES:
            self.assertIn(f"bench/datasets {name} ", page)
            self.assertIn(sheet(name)["page"], page)


class Guide(unittest.TestCase):
    def test_without_data_each_set_says_what_to_get_and_shows_the_published_figures_beside_none_of_ours(self):
        text = bench()
        parts = dict(zip(datasets.NAMES, re.split(r"^(?=# )", text, flags=re.MULTILINE)[1:]))
        self.assertEqual(len(parts), len(datasets.NAMES))
        for name, part in parts.items():
            known = sheet(name)
            with self.subTest(sheet=name):
                for words in (known["page"], known["size"], "- Checksums: ", f"bench/datasets {name} FOLDER --check\n"):
                    self.assertIn(words, part)
                for file in known["files"]:
                    self.assertRegex(part, rf"(?m)^\| {re.escape(file['get'])} +\| {re.escape(file['lies'])} +\|$")
                for table in known.get("tables", []):
                    self.assertIn(table["title"], part)
                    for sequence in table["sequences"]:
                        self.assertRegex(part, rf"(?m)^\| {sequence} +\|  +\| ")
        self.assertEqual(bench("ecd"), parts["ecd"].rstrip("\n") + "\n\n")

    def test_a_folder_without_recordings_is_refused_with_the_command_that_says_what_to_get(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(SystemExit, "no sequence .* bench/datasets ecd"):
            bench("ecd", folder, "--edged", EDGED)


class Layouts(WithFolder):
    """As downloaded and unpacked; what a file holds does not matter here."""
    LAYOUTS = {  # data set: {file: (name of the sequence, recording, calibration)}
        "ecd": {"boxes_6dof/events.txt": ("boxes_6dof", "boxes_6dof", "davis240c_ecd"),
                "shapes_6dof.bag": ("shapes_6dof", "shapes_6dof.bag", "davis240c_ecd"),
                "hdr_boxes.zip": ("hdr_boxes", "hdr_boxes.zip", "davis240c_ecd")},
        "uzh_fpv": {"indoor_forward_3_davis_with_gt/events.txt":
                    ("indoor_forward_3", "indoor_forward_3_davis_with_gt", "indoor_forward_calib_davis/camchain-imucam-x.yaml")},
        "tum_vie": {"mocap-desk2-events_left.h5": ("mocap-desk2", "mocap-desk2-events_left.h5", "camera-calibrationA.json"),
                    "run/mocap-6dof-events_left.h5": ("mocap-6dof", "run/mocap-6dof-events_left.h5", "tumvie_b")},
        "vector": {"a/corner-slow1.synced.left_event.hdf5": ("corner-slow", "a/corner-slow1.synced.left_event.hdf5", "vector_small"),
                   "units-dolly1.synced.left_event.hdf5": ("units-dolly", "units-dolly1.synced.left_event.hdf5", "vector_large")},
        "hku": {"hku_agg_flip.bag": ("hku_agg_flip", "hku_agg_flip.bag", "hku_stereo"),
                "vicon_hdr1.bag": ("vicon_hdr1", "vicon_hdr1.bag", "hku_mono")},
        "mvsec": {"indoor_flying/indoor_flying1_data.hdf5": ("indoor_flying1", "indoor_flying/indoor_flying1_data.hdf5", "mvsec")},
        "dsec": {"train/zurich_city_04_a/events/left/events.h5":
                 ("zurich_city_04_a", "train/zurich_city_04_a/events/left/events.h5", None)},
        "m3ed": {"car_urban_day_horse/car_urban_day_horse_data.h5":
                 ("car_urban_day_horse", "car_urban_day_horse/car_urban_day_horse_data.h5", None)},
        "eds": {"00_peanuts_dark/events.h5": ("00_peanuts_dark", "00_peanuts_dark", None)},
        "euroc": {"MH_01_easy/mav0/cam0/data.csv": ("MH_01", "MH_01_easy", None), "V1_02_medium.zip": ("V1_02", "V1_02_medium.zip", None)},
        "tum_vi": {"dataset-room1_512_16/mav0/cam0/data.csv": ("room1", "dataset-room1_512_16", None)},
        "evslam": {"rosbag/drone_8_hdr.bag": ("drone_8_hdr", "rosbag/drone_8_hdr.bag", None)},
    }
    BESIDE = {"uzh_fpv": ["indoor_forward_calib_davis/camchain-imucam-x.yaml", "outdoor_45_calib_davis/camchain-imucam-y.yaml"],
              "tum_vie": ["camera-calibrationA.json"], "mvsec": ["indoor_flying/indoor_flying1_gt.hdf5"], "evslam": ["calibration/calib.bag", "calibration_drone/calib.bag"],
              "m3ed": ["car_urban_day_horse/car_urban_day_horse_pose_gt.h5"], "uzh_fpv_none": ["indoor_forward_3_snapdragon/imu.txt"]}

    def test_each_sequence_is_found_with_its_name_and_calibration(self):
        self.assertEqual(sorted(self.LAYOUTS), datasets.NAMES)
        for name, layout in self.LAYOUTS.items():
            with self.subTest(dataset=name):
                root = self.folder / name
                for file in [*layout, *self.BESIDE.get(name, [])]:
                    (root / file).parent.mkdir(parents=True, exist_ok=True)
                    (root / file).touch()
                options = types.SimpleNamespace(folder=root, calib=None, rig=None, cache=self.folder, edged=EDGED)
                found = datasets.find_sequences(sheet(name), root)
                for sequence in found:
                    datasets.choose_calibration(options, sheet(name), sequence)
                said = sorted((s.name, str(s.path.relative_to(root)),
                               str(s.calibration.relative_to(root)) if isinstance(s.calibration, pathlib.Path) else s.calibration) for s in found)
                self.assertEqual(said, sorted(layout.values(), key=lambda known: known[0]))

    def test_the_folder_of_a_sequence_itself_and_one_that_is_there_twice(self):
        folder = self.folder / "boxes_6dof"
        folder.mkdir()
        (folder / "events.txt").touch()
        (folder / "boxes_6dof.bag").touch()
        found = datasets.find_sequences(sheet("ecd"), folder)
        self.assertEqual([(s.name, s.path) for s in found], [("boxes_6dof", folder)])


class StandIns(WithFolder):
    """One short flight in the layout of each data set, in a folder of any name, from there to the table. Bags and HDF5 files hold what
    `edged convert` writes; what the data sets write is tested beside the readers."""
    CALIBRATED = ("hku", "tum_vie", "vector", "dsec", "euroc", "tum_vi")  # by --calib: their own is of another camera

    @classmethod
    def setUpClass(cls):
        shared = pathlib.Path(tempfile.mkdtemp(prefix="edged_sets_"))
        cls.addClassCleanup(shutil.rmtree, shared)
        cls.flight, bare = shared / "flight", shared / "bare"
        edged("simulate", "--duration", 2.5, "--seed", 3, "--out", cls.flight, "--quiet")
        thinned(cls.flight)
        bare.mkdir()
        shutil.copy(cls.flight / "events.txt", bare)
        cls.h5, cls.bag, cls.events = shared / "all.h5", shared / "all.bag", shared / "events.h5"
        for source, target in ((cls.flight, cls.h5), (cls.flight, cls.bag), (bare, cls.events)):
            done = edged("convert", source, target, "--geometry", "240x180", "--quiet")
            assert done.returncode == 0, done.stderr
        rig = sensor_frames.Rig(cls.flight / "calibration.yaml")
        T_B_C, offset = rig.sensor("events")
        cls.body = shared / "body.txt"
        sensor_frames.write_of_sensor(cls.flight / "groundtruth.txt", cls.body, sensor_frames.inverted(T_B_C), offset)

    def rows(self, file, unit=1e-6, digits=0):
        """Stamps in this unit, and the rest of each line."""
        for line in file.read_text().splitlines():
            t, *rest = line.split()
            yield f"{float(t) / unit:.{digits}f}", rest

    def gyro_first(self, **stamps):
        return [[t, *v[3:], *v[:3]] for t, v in self.rows(self.flight / "imu.txt", **stamps)]

    def write(self, name, rows, heading="", separator=" "):
        self.place(name)
        (self.root / name).write_text(heading + "".join(separator.join(row) + "\n" for row in rows))

    def place(self, name, source=None):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        if source:
            (shutil.copytree if source.is_dir() else shutil.copy)(source, self.root / name)

    def images(self, folder):
        """Copies them; the stamps in seconds."""
        self.place(folder, self.flight / "images")
        return [float(t) for t, _ in self.rows(self.flight / "images.txt", 1, 6)]

    def chain(self, name, *topics):
        self.place(name)
        (self.root / name).write_text(camchain(self.flight, topics))

    def make_ecd(self):
        self.place("boxes_6dof", self.flight)
        self.place("hdr_boxes.bag", self.bag)
        return ["boxes_6dof", "hdr_boxes"]

    def make_uzh_fpv(self):
        self.place("indoor_forward_3_davis_with_gt", self.flight)
        self.place("indoor_forward_3_davis_with_gt/groundtruth.txt", self.body)
        self.chain("indoor_forward_calib_davis/x/camchain-imucam-x.yaml", "/dvs/image_raw")
        return ["indoor_forward_3"]

    def make_tum_vie(self):
        data = "mocap-6dof-vi_gt_data"
        self.place("mocap-6dof-events_left.h5", self.events)
        stamps = self.images(f"{data}/left_images")
        self.write(f"{data}/left_images/image_timestamps_left.txt", [[f"{1e6 * t:.0f}"] for t in stamps], "# timestamp [us]\n")
        self.write(f"{data}/imu_data.txt", self.gyro_first())
        self.write(f"{data}/mocap_data.txt", [[t, *rest] for t, rest in self.rows(self.body)])
        still = {"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}
        (self.root / "mocap-imu-calibrationB.json").write_text(json.dumps({"value0": {"T_imu_marker": still}}))
        return ["mocap-6dof"]

    def make_vector(self):
        begin = "corner-slow1.synced."
        self.place(f"{begin}left_event.hdf5", self.events)
        stamps = self.images(f"{begin}left_camera")
        self.write(f"{begin}left_camera/timestamp.txt", [[f"{t:.6f}"] * 2 for t in stamps])
        self.write(f"{begin}imu.txt", self.gyro_first(unit=1, digits=9))
        self.place(f"{begin}gt.txt", self.body)
        rig = yaml.safe_load(camchain(self.flight, ["/x"]))
        self.write("camera_mocap_extrinsic_results1.yaml", [], yaml.safe_dump({"cam0": {"T_cam_body": rig["cam0"]["T_cam_imu"]}}))
        return ["corner-slow"]

    def make_hku(self):
        self.place("hku_agg_flip.bag", self.bag)
        self.place("vicon_hdr1.bag", self.bag)
        return ["hku_agg_flip", "vicon_hdr1"]

    def make_mvsec(self):
        self.place("outdoor_day1_data.hdf5", self.h5)
        self.chain("camchain-imucam-outdoor_day.yaml", "/davis/left/events", "/davis/left/image_raw")
        return ["outdoor_day1"]

    def make_dsec(self):
        self.place("zurich_city_04_a/events/left/events.h5", self.events)
        self.place("zurich_city_04_a/events/left/rectify_map.h5", self.events)
        stamps = self.images("zurich_city_04_a/images/left/rectified")
        self.write("zurich_city_04_a/images/timestamps.txt", [[f"{1e6 * t:.0f}"] for t in stamps])
        self.place("lidar_imu/zurich_city_04/lidar_imu.bag", self.bag)
        self.place("zurich_city_04_a_gt.tum", self.flight / "groundtruth.txt")
        return ["zurich_city_04_a"]

    def make_m3ed(self):
        self.place("car_horse/car_horse_data.h5", self.h5)
        self.chain("car_imu_calib/x/camchain-imucam.yaml", "/prophesee/left", "/prophesee/right", "/ovc/left")
        return ["car_horse"]

    def make_eds(self):
        self.place("00_peanuts_dark/events.h5", self.h5)
        self.chain("00_calib/x/camchain-imucam.yaml", "/rgb/image_raw", "/dvs/events")
        return ["00_peanuts_dark"]

    def mav0(self, mav0, truth):
        stamps = self.images(f"{mav0}/cam0/data")
        names = sorted(path.name for path in (self.root / mav0 / "cam0/data").iterdir())
        self.write(f"{mav0}/cam0/data.csv", [[f"{1e9 * t:.0f}", name] for t, name in zip(stamps, names)], "#timestamp [ns],filename\n", ",")
        self.write(f"{mav0}/imu0/data.csv", self.gyro_first(unit=1e-9), "#timestamp [ns],gx [rad/s],gy,gz,ax [m/s^2],ay,az\n", ",")
        self.write(f"{mav0}/{truth}/data.csv", [[t, *v[:3], v[6], *v[3:6]] for t, v in self.rows(self.body, 1e-9)], "#timestamp\n", ",")

    def make_euroc(self):
        self.mav0("MH_01_easy/mav0", "state_groundtruth_estimate0")
        return ["MH_01"]

    def make_tum_vi(self):
        self.mav0("dataset-room1_512_16/mav0", "mocap0")
        return ["room1"]

    def make_evslam(self):
        self.place("rosbag/drone_8_hdr.bag", self.bag)
        self.chain("calibration/calib_results_cam.yaml", "/dvxplorer_left/events", "/camera/infra1/image_rect_raw")
        self.place("drone_8_hdr_gt.txt", self.flight / "groundtruth.txt")
        return ["drone_8_hdr"]

    def begin(self, name):
        """Makes the data set; its sequences, and the arguments of bench/datasets."""
        self.root = self.folder / f"my [{name}] (2)"
        names, sheets, known = getattr(self, f"make_{name}")(), self.folder / "sheets", sheet(name)
        for rule in known["recordings"]:
            rule.pop("topics", None)  # those that `edged convert` writes
        sheets.mkdir(exist_ok=True)
        (sheets / f"{name}.yaml").write_text(yaml.safe_dump(known))
        calib = ("--calib", self.flight / "calibration.yaml") if name in self.CALIBRATED else ()
        return names, (name, self.root, "--modes", "frames", "--cache", self.folder / name, "--edged", EDGED, "--jobs", 1, *calib), sheets

    def test_of_every_data_set_make_the_whole_table(self):
        for name in datasets.NAMES:
            with self.subTest(dataset=name):
                names, arguments, sheets = self.begin(name)
                checked = bench(*arguments, "--check", sheets=sheets)
                self.assertNotIn("  missing: ", checked)
                text = bench(*arguments, sheets=sheets)
                rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("|")]
                details = {row[0]: row for row in rows if len(row) == 11}
                for sequence in names:
                    self.assertIn(f"{sequence}: {self.root}/", checked)
                    self.assertEqual((details[sequence][1], details[sequence][-1]), ("frames", "no"), text)
                    self.assertLess(float(details[sequence][4]), 10.0, text)  # mm
                published = {datasets.key_of(known) for table in sheet(name).get("tables", []) for known in table["sequences"]}
                compared = {row[0] for row in rows if len(row) != 11}
                self.assertEqual({sequence for sequence in names if datasets.key_of(sequence) in published} - compared, set(), text)

    def test_what_is_missing_is_named(self):
        _, arguments, sheets = self.begin("tum_vie")
        (self.root / "mocap-imu-calibrationB.json").unlink()
        (self.root / "mocap-6dof-vi_gt_data/imu_data.txt").unlink()
        (self.root / "mocap-6dof-vi_gt_data/mocap_data.txt").unlink()
        text = bench(*arguments, "--check", sheets=sheets)
        for words in ("pose of the ground truth's sensor (**/mocap-imu-calibrationB.json)", "ground truth", "an IMU and a camera"):
            self.assertIn(f"  missing: {words}", text)
        self.assertIn("missing for 'ATE RMSE [cm], SE(3) on all poses (P3)': mocap-1d-trans, mocap-3d-trans, mocap-desk, ", text)
        _, arguments, sheets = self.begin("evslam")
        shutil.rmtree(self.root / "calibration")
        self.assertIn("  missing: calibration (**/calibration/calib_results_cam_imu.*, ", bench(*arguments, "--check", sheets=sheets))


class SensorFrames(WithFolder):
    QUARTER = math.sqrt(0.5)

    def test_a_transform_is_read_from_each_form_of_calibration_files(self):
        turn = [[0, -1, 0, 1.0], [1, 0, 0, 2.0], [0, 0, 1, 3.0], [0, 0, 0, 1]]
        basalt = {"px": 1, "py": 2, "pz": 3, "qx": 0, "qy": 0, "qz": self.QUARTER, "qw": self.QUARTER}
        for entry in (turn, [x for row in turn for x in row], {"rows": 4, "data": [x for row in turn for x in row]}, basalt):
            p, q = sensor_frames.of_entry(entry)
            for value, true in zip([*p, *q], [1, 2, 3, 0, 0, self.QUARTER, self.QUARTER]):
                self.assertAlmostEqual(value, true)
        file = self.folder / "mocap-imu-calibrationA.json"
        file.write_text(json.dumps({"value0": {"T_imu_marker": basalt}}))
        self.assertEqual(sensor_frames.read_entry(file, "value0.T_imu_marker")[0], [1, 2, 3])

    def test_half_turns_about_each_axis_survive_the_way_from_a_matrix(self):
        for axis in range(3):
            rows = [[(1 if i == axis else -1) if i == j else 0 for j in range(3)] + [0] for i in range(3)]
            self.assertEqual([abs(round(x, 9)) for x in sensor_frames.of_matrix(rows)[1]], [float(i == axis) for i in range(3)] + [0.0])

    def test_a_trajectory_of_the_body_becomes_that_of_the_markers(self):
        source, target = self.folder / "body.tum", self.folder / "markers.tum"
        source.write_text(f"# body\n10.0 1 0 0 0 0 {self.QUARTER} {self.QUARTER}\n")
        sensor_frames.write_of_sensor(source, target, ([0.5, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]), 0.01)
        self.assertEqual([round(float(x), 6) for x in target.read_text().split()][:4], [10.01, 1.0, 0.5, 0.0])


class Comparison(unittest.TestCase):
    GOOD = {"evaluation": {"ate_m": {"mean": 0.01}, "path_length_m": 5.0}, "first_good_s": 1.0, "status": "good", "coverage": 0.9,
            "has_truth": True, "duration_s": 59.0, "by_protocol": {("P2", "causal"): {"mpe_percent": 0.2}}}
    TABLE = {"title": "T", "protocol": "P2", "metric": "mpe_percent", "sequences": ["boxes_6dof", "hdr_boxes", "poster_6dof"],
             "lengths_s": [60, 60, 60],
             "methods": [{"name": "A", "source": "S", "values": [0.4, 0.2, 9.0]}, {"name": "B", "source": "S", "values": ["fail", 0.1, None]}]}

    def compared(self, second):
        options = types.SimpleNamespace(modes=["fused", "frames"])
        lines = datasets.compared(options, self.TABLE, {"hdr-boxes": {"fused": self.GOOD}, "boxes_6dof": {"fused": second}})
        return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if line.startswith("|")], "\n".join(lines)

    def test_rows_are_the_sequences_found_in_the_order_of_the_table(self):
        rows, text = self.compared(self.GOOD)
        self.assertEqual(rows, [["sequence", "fused, causal", "A", "B"], ["---", "---:", "---:", "---:"], ["boxes_6dof", "0.20", "0.40", "*failed*"],
                                ["hdr-boxes", "0.20", "0.20", "0.10"], ["mean", "0.20", "0.30", "--"], ["failed", "0 of 2", "0 of 2", "1 of 2"]])
        self.assertIn("1 sequences of the published table were not found", text)

    def test_a_failure_is_counted_and_leaves_no_mean(self):
        for bad, cell in (({**self.GOOD, "status": "lost"}, "*failed* (0.20)"), ({"refused": "no IMU"}, "*failed*"),
                          ({**self.GOOD, "evaluation": None, "by_protocol": {}}, "*failed*")):
            rows, _ = self.compared(bad)
            self.assertEqual((rows[2][1], rows[4][1], rows[5][1]), (cell, "--", "1 of 2"))

    def test_what_is_a_part_of_its_sequence_is_not_compared(self):
        rows, _ = self.compared({**self.GOOD, "duration_s": 11.0})
        self.assertEqual((rows[2][1], rows[4][1], rows[5][1]), ("0.20 (part)", "--", "0 of 2"))


class FromBagToTable(WithFolder):
    """EvSLAM's layout: bag, Kalibr's camchain, ground truth and reference times in files of their own."""

    def make(self):
        made, root = self.folder / "made", self.folder / "evslam"
        for part in ("rosbag", "calibration", "groundtruth"):
            (root / part).mkdir(parents=True)
        edged("simulate", "--duration", 4, "--seed", 3, "--out", made, "--quiet")
        thinned(made)
        self.assertEqual(edged("convert", made, root / "rosbag/drone_8_hdr.bag", "--quiet").returncode, 0)
        (root / "groundtruth/drone_8_hdr_gt.txt").write_text(
            "".join(line + " 0 0 0\n" for line in (made / "groundtruth.txt").read_text().splitlines()[::20]))
        (root / "drone_8_hdr_ref_time.txt").write_text("".join(f"{0.1 * k:.6f}\n" for k in range(40)))
        topics = ["/dvxplorer_left/events", "/dvxplorer_right/events", "/camera/color/image_rect_raw", "/camera/infra1/image_rect_raw"]
        (root / "calibration/calib_results_cam.yaml").write_text(camchain(made, topics))
        # Topics are those that `edged convert` writes; all else of the sheet holds.
        (self.folder / "sheets").mkdir()
        known = sheet("evslam")
        known["recordings"][0].pop("topics")
        (self.folder / "sheets/evslam.yaml").write_text(yaml.safe_dump(known))
        return root

    def bench(self, root):
        return bench("evslam", root, "--modes", "frames", "--cache", self.folder / "cache", "--format", "evslam", "--edged", EDGED, "--jobs", 1,
                     sheets=self.folder / "sheets")

    def test_a_run_is_evaluated_in_the_frame_of_its_truth_and_written_for_the_challenge(self):
        root = self.make()
        text = self.bench(root)
        row = next(line for line in text.splitlines() if line.startswith("| drone_8_hdr"))
        cells = [cell.strip() for cell in row.split("|")[1:-1]]
        self.assertEqual((cells[1], cells[3], cells[-1]), ("frames", "good", "no"), text)
        self.assertLess(float(cells[4]), 10.0)  # mm; a lever arm or a clock that is off costs more
        self.assertIn("calibration calibration/calib_results_cam.yaml", text)
        self.assertIn("No published figures: ", text)
        lines = [[float(x) for x in line.split()] for line in (self.folder / "cache/evslam/frames/drone_8_hdr.txt").read_text().splitlines()]
        self.assertEqual([round(line[0], 6) for line in lines], [round(0.1 * k, 6) for k in range(40)])
        self.assertEqual({len(line) for line in lines}, {11})
        moving = lines[20:36]
        for before, line, after in zip(moving, moving[1:], moving[2:]):
            there = sensor_frames.turned(sensor_frames.inverse(line[4:8]), [(y - x) / 0.2 for x, y in zip(before[1:4], after[1:4])])
            for velocity, difference in zip(line[8:], there):
                self.assertAlmostEqual(velocity, difference, delta=0.08)
        self.assertEqual(lines[0][8:], [0.0, 0.0, 0.0])  # before the first pose
        self.assertEqual(self.bench(root), text)  # kept


if __name__ == "__main__":
    unittest.main(verbosity=2)
