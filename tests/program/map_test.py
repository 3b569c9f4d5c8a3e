#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Maps that outlive a run: --save-map, --map and `edged map`, with what is refused.
Usage: EDGED=path/to/edged map_test.py"""
import json
import pathlib
import unittest

from program import WithFlight, edged


class Maps(WithFlight):
    SIMULATION = ("--duration", 9, "--seed", 5)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.shared = pathlib.Path(cls.flight).parent
        cls.map = cls.shared / "room.map"
        made = edged("run", cls.flight, "--mode", "frames", "--save-map", cls.map, "--out", cls.shared / "first", "--json", "--quiet")
        assert made.returncode == 0, made.stderr
        cls.first = json.loads(made.stdout)

    def run_in(self, the_map, *more):
        return edged("run", self.flight, "--mode", "frames", "--map", the_map, "--out", self.folder / "run", "--quiet", *more)

    def test_a_run_goes_on_in_the_map_of_another(self):
        self.assertEqual(self.first["map"], {"loaded": "", "localize_only": False, "found_s": None, "relocalized": 0, "saved": str(self.map)})
        later = self.folder / "later.map"
        result = self.run_in(self.map, "--start", "4", "--save-map", later, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads(result.stdout)
        self.assertLess(summary["map"]["found_s"], 2.0)
        self.assertLess(summary["ate_rmse_m"], 0.05)  # of the poses in the map's frame
        self.assertGreaterEqual(self.about(later)["keyframes"], self.about(self.map)["keyframes"])

    def test_a_run_only_localizes_in_the_map_of_another(self):
        before = self.map.read_bytes()
        result = self.run_in(self.map, "--start", "4", "--localize-only", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads(result.stdout)
        self.assertTrue(summary["map"]["localize_only"])
        self.assertLess(summary["map"]["found_s"], 2.0)
        self.assertGreaterEqual(summary["map"]["relocalized"], 1)
        self.assertLess(summary["ate_rmse_m"], 0.05)
        self.assertEqual(self.map.read_bytes(), before)
        rows = (self.folder / "run" / "states.csv").read_text().splitlines()[2:]
        statuses = [row.split(",")[1] for row in rows]
        self.assertEqual(statuses[0], "Initializing")
        self.assertEqual(statuses[-1], "Good")
        self.assertTrue(all(row.split(",")[2] == "" for row in rows if row.split(",")[1] == "Initializing"))
        poses = [line for line in (self.folder / "run" / "trajectory.tum").read_text().splitlines() if not line.startswith("#")]
        self.assertEqual(len(poses), sum(status in ("Good", "Degraded") for status in statuses))

    def test_in_another_room_a_run_that_only_localizes_has_no_poses(self):
        result = edged("run", "sim:poster:3", "--duration", "8", "--mode", "frames", "--map", self.map, "--localize-only", "--out",
                       self.folder / "run", "--quiet", "--json")
        summary = json.loads(result.stdout)
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual((summary["poses"], summary["status"], summary["map"]["found_s"]), (0, "never good", None))
        self.assertTrue(any("map: never matched" in finding for finding in map(str, summary["findings"])), summary)

    def test_a_map_that_is_only_localized_in_is_not_saved(self):
        self.assert_refused(self.run_in(self.map, "--localize-only", "--save-map", self.folder / "later.map"), "--save-map", "--localize-only")
        self.assert_refused(edged("run", self.flight, "--localize-only", "--out", self.folder / "run", "--quiet"), "--localize-only", "--map")
        self.assert_refused(edged("run", self.flight, "map.localize_only=true", "--out", self.folder / "run", "--quiet"), "--map FILE")

    def about(self, the_map):
        result = edged("map", "info", the_map, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_a_map_tells_what_is_in_it(self):
        about = self.about(self.map)
        self.assertEqual([camera["name"] for camera in about["cameras"]], ["frames"])
        self.assertGreater(about["points"], 15 * about["keyframes"])
        ply = self.folder / "room.ply"
        self.assertEqual(edged("map", "show", self.map, "--out", ply).returncode, 0)
        self.assertIn(f"element vertex {about['points']}\n", ply.read_text())

    def test_two_maps_of_one_room_become_one(self):
        other, both = self.folder / "other.map", self.folder / "both.map"
        made = edged("run", self.flight, "--mode", "frames", "--start", "1", "--save-map", other, "--out", self.folder / "run", "--quiet")
        self.assertEqual(made.returncode, 0, made.stderr)
        result = edged("map", "merge", self.map, other, "--out", both)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.about(both)["keyframes"], self.about(self.map)["keyframes"] + self.about(other)["keyframes"])
        self.assertEqual(self.run_in(both, "--start", "4").returncode, 0)

    def test_the_map_of_another_place_is_not_found(self):
        poster = self.folder / "poster.map"
        result = edged("run", "sim:poster:3", "--duration", "8", "--mode", "frames", "--map", self.map, "--save-map", poster, "--out",
                       self.folder / "run", "--quiet")
        self.assertRegex(result.stdout, "map +not relocalized")
        self.assertEqual(result.returncode, 5, result.stdout)
        self.assertRegex(result.stdout, r"error +map: never matched in ")
        self.assertIn("not written", result.stderr)
        self.assertFalse(poster.exists())

    def test_a_map_that_the_mode_cannot_match_is_refused_at_once(self):
        fused, of_events = self.folder / "fused.map", self.folder / "events.map"  # keyframes of the first are frames
        for the_map, mode in ((fused, "fused"), (of_events, "events")):
            made = edged("run", self.flight, "--mode", mode, "--save-map", the_map, "--out", self.folder / mode, "--quiet")
            self.assertEqual(made.returncode, 0, made.stdout)
        for the_map, mode, of in ((fused, "events", "frames"), (of_events, "frames", "events")):
            self.assert_refused(edged("run", self.flight, "--mode", mode, "--map", the_map, "--out", self.folder / "run", "--quiet"),
                                str(the_map), f"its keyframes are of {of}; use it in a mode")
            self.assertFalse((self.folder / "run").exists())

    def test_what_cannot_be_used_is_refused(self):
        damaged = self.folder / "damaged.map"
        damaged.write_bytes(self.map.read_bytes()[:-100])
        for of, words in ((damaged, (str(damaged), "damaged")), (self.folder / "none.map", ("none.map", "--save-map")),
                          (self.folder, (str(self.folder), "--save-map"))):
            self.assert_refused(self.run_in(of), *words)
        self.assert_refused(edged("map", "info", damaged), str(damaged))
        self.assert_refused(edged("run", self.flight, "--mode", "events", "--map", self.map, "--out", self.folder / "run", "--quiet"),
                            str(self.map), "other cameras")
        self.assert_refused(self.run_in(self.map, "map.enabled=false"), "map.enabled=false")
        nowhere = self.folder / "no" / "folder.map"
        self.assert_refused(self.run_in(self.map, "--save-map", nowhere), str(nowhere))
        bag = self.folder / "flight.bag"
        bag.write_bytes(b"#ROSBAG V2.0\n")
        self.assert_refused(self.run_in(self.map, "--save-map", bag), str(bag), "exists")
        self.assertEqual(bag.read_bytes(), b"#ROSBAG V2.0\n")
        result = edged("run", self.flight, self.flight, "--save-map", damaged, "--quiet")
        self.assertEqual(result.returncode, 2, result.stderr)


if __name__ == "__main__":
    unittest.main()
