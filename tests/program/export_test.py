#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""`edged run --export` and `--occupancy`: COLMAP models by a reader of its own, written from the published format, nerfstudio's transforms.json and the
points. Usage: EDGED=path/to/edged export_test.py"""
import json
import math
import statistics
import struct
import unittest

from program import WithFlight, edged


class Bytes:
    def __init__(self, file):
        self.data, self.at = file.read_bytes(), 0

    def take(self, layout):
        values = struct.unpack_from("<" + layout, self.data, self.at)
        self.at += struct.calcsize("<" + layout)
        return values if len(values) > 1 else values[0]

    def text(self):
        end = self.data.index(b"\0", self.at)
        text, self.at = self.data[self.at:end].decode(), end + 1
        return text


def read_binary(folder):
    """(cameras, images, points) by number."""
    file = Bytes(folder / "cameras.bin")
    cameras, images, points = {}, {}, {}
    for _ in range(file.take("Q")):
        number, model = file.take("Ii")
        assert model == 1, "not PINHOLE"
        cameras[number] = (*file.take("QQ"), *file.take("4d"))
    assert file.at == len(file.data)
    file = Bytes(folder / "images.bin")
    for _ in range(file.take("Q")):
        number, *pose = file.take("I7d")
        camera, name = file.take("I"), file.text()
        images[number] = (pose, camera, name, [file.take("ddq") for _ in range(file.take("Q"))])
    assert file.at == len(file.data)
    file = Bytes(folder / "points3D.bin")
    for _ in range(file.take("Q")):
        number, *values = file.take("Q3d3Bd")
        points[number] = (values[:3], values[3:6], values[6], [file.take("II") for _ in range(file.take("Q"))])
    assert file.at == len(file.data)
    return cameras, images, points


def rows(file):
    return [line.split() for line in file.read_text().split("\n")[:-1] if not line.startswith("#")]


def read_text(folder):
    cameras = {int(row[0]): (int(row[2]), int(row[3]), *map(float, row[4:])) for row in rows(folder / "cameras.txt") if row[1] == "PINHOLE"}
    images, lines = {}, rows(folder / "images.txt")
    for head, seen in zip(lines[::2], lines[1::2]):
        images[int(head[0])] = ([float(x) for x in head[1:8]], int(head[8]), head[9],
                                [(float(x), float(y), int(p)) for x, y, p in zip(seen[::3], seen[1::3], seen[2::3])])
    points = {}
    for row in rows(folder / "points3D.txt"):
        track = [int(x) for x in row[8:]]
        points[int(row[0])] = ([float(x) for x in row[1:4]], [int(x) for x in row[4:7]], float(row[7]), list(zip(track[::2], track[1::2])))
    return cameras, images, points


def rotated(q, p):
    w, x, y, z = q
    t = [2 * (y * p[2] - z * p[1]), 2 * (z * p[0] - x * p[2]), 2 * (x * p[1] - y * p[0])]
    return [p[0] + w * t[0] + y * t[2] - z * t[1], p[1] + w * t[1] + z * t[0] - x * t[2], p[2] + w * t[2] + x * t[1] - y * t[0]]


class Export(WithFlight):
    SIMULATION = ("--duration", 6, "--seed", 5)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.flight.parent / "export"
        cls.made = edged("run", cls.flight, "--out", cls.flight.parent / "run", "--export", cls.out, "--quiet", "--json")
        assert cls.made.returncode == 0, cls.made.stderr
        cls.model = read_binary(cls.out / "sparse" / "0")

    def test_text_and_binary_models_are_the_same(self):
        cameras, images, points = read_text(self.out / "sparse_text" / "0")
        self.assertEqual((cameras, points), (self.model[0], self.model[2]))
        self.assertEqual(images.keys(), self.model[1].keys())
        for number, image in images.items():
            self.assertEqual(image, (self.model[1][number][0], *self.model[1][number][1:]))

    def test_observations_lie_where_the_points_project(self):
        cameras, images, points = self.model
        self.assertGreater(len(images), 10)
        self.assertGreater(len(points), 100)
        errors = []
        for number, (p, _, error, track) in points.items():
            of_point = []
            for image, index in track:
                pose, camera, _, seen = images[image]
                x, y, point = seen[index]
                self.assertEqual(point, number)
                _, _, fx, fy, cx, cy = cameras[camera]
                p_C = [a + b for a, b in zip(rotated(pose[:4], p), pose[4:])]
                self.assertGreater(p_C[2], 0.0)
                of_point.append(math.hypot(fx * p_C[0] / p_C[2] + cx - x, fy * p_C[1] / p_C[2] + cy - y))
            self.assertGreaterEqual(len(of_point), 2)
            self.assertAlmostEqual(statistics.mean(of_point), error, places=6)
            errors += of_point
        print(f"{len(points)} points, {len(errors)} observations, mean error {statistics.mean(errors):.3f} px")
        self.assertLess(statistics.mean(errors), 1.0)
        self.assertEqual(sum(point > 0 for _, _, _, seen in images.values() for _, _, point in seen), len(errors))

    def test_images_are_there_undistorted_and_nerfstudio_has_their_poses(self):
        cameras, images, _ = self.model
        transforms = json.loads((self.out / "transforms.json").read_text())
        self.assertEqual([frame["file_path"] for frame in transforms["frames"]], [f"images/{name}" for _, _, name, _ in images.values()])
        for frame, (pose, camera, name, _) in zip(transforms["frames"], images.values()):
            header = (self.out / "images" / name).read_bytes()[:24]
            self.assertEqual(struct.unpack(">II", header[16:24]), cameras[camera][:2])
            self.assertEqual((frame["fl_x"], frame["fl_y"], frame["cx"], frame["cy"]), cameras[camera][2:])
            T = frame["transform_matrix"]
            centre = [row[3] for row in T]
            ahead = [c - 2.0 * row[2] for c, row in zip(centre, T)]  # 2 m along the axis, which is -z of OpenGL
            for point, expected in ((centre, (0, 0, 0)), (ahead, (0, 0, 2))):
                p_C = [a + b for a, b in zip(rotated(pose[:4], point), pose[4:])]
                for a, b in zip(p_C, expected):
                    self.assertAlmostEqual(a, b, places=9)

    def test_the_points_have_colour_normals_and_covariance(self):
        lines = (self.out / "points.ply").read_text().splitlines()
        names = [line.split()[2] for line in lines if line.startswith("property")]
        self.assertEqual(names, "x y z nx ny nz red green blue p_xx p_xy p_xz p_yy p_yz p_zz".split())
        points = [[float(x) for x in line.split()] for line in lines[lines.index("end_header") + 1:]]
        self.assertEqual(len(points), len(self.model[2]))
        for x, *_ in points:
            self.assertTrue(math.isfinite(x))
        for values in points:
            self.assertAlmostEqual(math.hypot(*values[3:6]), 1.0, places=3)
            self.assertTrue(all(values[i] > 0.0 for i in (9, 12, 14)))

    def test_dense_points_are_the_same_in_every_run(self):
        clouds = []
        for name in ("first", "second"):
            run = self.folder / name
            made = edged("run", self.flight, "--mode", "frames", "--out", run, "--dense", "--quiet", "--json")
            self.assertEqual(made.returncode, 0, made.stderr)
            clouds.append((run / "dense.ply").read_bytes())
        dense = json.loads(made.stdout)["dense"]
        self.assertGreater(dense["with_depth"], 1000)
        self.assertGreaterEqual(dense["edge_pixels"], dense["with_depth"])
        self.assertEqual(dense["dropped"], 0)
        header, points = clouds[0].split(b"end_header\n", 1)
        self.assertEqual(len(points), 19 * int(header.split(b"element vertex ")[1].split()[0]))
        self.assertEqual(*clouds)

    def test_images_come_at_a_rate(self):
        out = self.folder / "rate"
        result = edged("run", self.flight, "--mode", "frames", "--out", self.folder / "run", "--export", out, "--export-hz", 4, "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        states = (self.folder / "run" / "trajectory.tum").read_text().splitlines()
        times = [float(line.split()[0]) for line in states if not line.startswith("#")]
        self.assertAlmostEqual(len(read_binary(out / "sparse" / "0")[1]), 4 * (times[-1] - times[0]), delta=2)

    def test_what_cannot_be_exported_is_refused(self):
        run = ("run", self.flight, "--out", self.folder / "run", "--quiet")
        self.assert_refused(edged(*run, "--export", self.out), "--export", str(self.out), "--force")
        self.assert_refused(edged(*run, "--mode", "events", "--export", self.folder / "x"), "--export", "events")
        self.assertFalse((self.folder / "x").exists())
        (self.folder / "file").write_text("")
        self.assert_refused(edged(*run, "--export", self.folder / "file" / "x"), str(self.folder / "file" / "x"))
        self.assertNotEqual(edged(*run, "--export-hz", 4).returncode, 0)


class Occupancy(WithFlight):
    SIMULATION = ("--duration", 5, "--seed", 5)

    def run_with(self, *options):
        return edged("run", self.flight, "--out", self.folder / "run", "--quiet", *options)

    def test_files_for_planners_are_there_in_every_mode(self):
        for mode in ("fused", "frames", "events"):
            out = self.folder / mode
            made = self.run_with("--mode", mode, "--occupancy", out, "--occupancy-voxel", 0.1)
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertEqual(sorted(file.name for file in out.iterdir()), ["map.pgm", "map.yaml", "occupancy.bt", "occupancy.ot"])
            self.assertTrue((out / "occupancy.bt").read_bytes().startswith(b"# Octomap OcTree binary file"))
            self.assertTrue((out / "occupancy.ot").read_bytes().startswith(b"# Octomap OcTree file"))
            self.assertIn("resolution: 0.1\n", (out / "map.yaml").read_text())
            self.assertTrue((out / "map.pgm").read_bytes().startswith(b"P5"))

    def test_what_cannot_be_mapped_is_refused(self):
        self.assert_refused(self.run_with("--occupancy", self.flight), "--occupancy", str(self.flight), "--force")
        (self.folder / "file").write_text("")
        self.assert_refused(self.run_with("--occupancy", self.folder / "file" / "x"), str(self.folder / "file" / "x"))
        out = self.folder / "x"
        self.assert_refused(self.run_with("--occupancy", out, "--occupancy-heights", 1, 0.5), "--occupancy-heights 1 0.5")
        for options in (("--occupancy", out, "--occupancy-voxel", 0), ("--occupancy-voxel", 0.1), ("--occupancy-heights", 0, 1)):
            result = self.run_with(*options)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn("--occupancy", result.stderr)
        self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
