#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The program as a user meets it: exit codes, error lines, and what needs no recording. Usage: EDGED=path/to/edged cli_test.py"""
import json
import os
import pathlib
import shutil
import subprocess
import unittest

from program import WithFolder, edged


class CommandLine(WithFolder):
    def test_help_teaches_with_examples_and_exit_codes(self):
        text = edged("--help").stdout
        for word in ("simulate", "run", "eval", "config", "Exit codes", "edged run"):
            self.assertIn(word, text)
        for command in ("run", "info", "doctor", "calib", "convert", "simulate", "eval", "depth"):
            self.assertIn("Example", edged(command, "--help").stdout)

    def test_every_help_fits_a_terminal_and_names_values_as_they_are_written(self):
        commands = [word for word in edged("--help").stdout.split("Subcommands:")[1].split("\n\n")[0].split("\n") if word.startswith("  ")]
        names = {line.split()[0] for line in commands if not line.startswith("   ")}
        self.assertLessEqual({"run", "simulate", "show", "map", "play"}, names)
        for words in (*((name,) for name in names), ("map", "info"), ("map", "show"), ("map", "merge"), ("manual",)):
            text = edged(*words, "--help").stdout
            self.assertNotIn("ENUM", text, words)
            self.assertNotIn("->", text, words)
            self.assertNotIn("--dim-frames", text, "for experiments")
            self.assertNotIn("First steps", text, words)
            described = [line for line in text.split("\n\nExample")[0].splitlines() if line.startswith(" " * 30)]
            self.assertLessEqual(max([len(line) for line in described if " " in line.strip()], default=0), 80, words)

    def test_alone_and_by_help_it_says_what_it_can_do(self):
        commands = edged("--help").stdout
        self.assertEqual((edged().stdout, edged("help").stdout, edged("help").returncode), (commands, commands, 0))
        self.assertEqual(edged("help", "map", "info").stdout, edged("map", "info", "--help").stdout)
        self.assertLessEqual(max(map(len, commands.split("\n\nFirst steps")[0].splitlines())), 80)

    def test_every_preset_is_described(self):
        help_text = edged("simulate", "--help").stdout
        names = edged("simulate", "--preset", "nothing").stderr.split("{")[1].split("}")[0].split(",")
        self.assertGreater(len(names), 20)
        for name in names:
            self.assertRegex(help_text, rf"(?m)^  {name} +\w.{{20,}}$")

    def test_a_wrong_command_line_is_code_2(self):
        for args in ([], ["fly"], ["run"], ["run", "x", "--mode", "sonar"], ["eval", "a"], ["config", "--what"]):
            self.assertEqual(edged(*args).returncode, 2, args)

    def test_a_mistyped_command_or_flag_is_told_the_nearest_in_one_line(self):
        self.assert_refused(edged("rnu", "x"), "unknown command 'rnu'", "did you mean 'run'?", "`edged --help`", code=2)
        self.assert_refused(edged("run", "x", "--mdoe", "fused"), "unknown flag '--mdoe'", "'--mode'", "`edged run --help`", code=2)
        self.assert_refused(edged("run", "x", "--mdoe=fused"), "unknown flag '--mdoe'", "'--mode'", code=2)
        self.assert_refused(edged("calibrate"), "did you mean 'calib'?", code=2)
        self.assert_refused(edged("slam"), "did you mean 'run'?", code=2)
        self.assertNotIn("did you mean", edged("hover").stderr)
        self.assertNotIn("did you mean", edged("config", "--what").stderr)

    def test_a_topic_without_its_flag_is_shown_as_it_is_written(self):
        if "Cyclone DDS was missing" in edged("--help").stdout:
            self.skipTest("EDGED_ROS2 is off")
        for command in ("ros2", "play"):
            self.assert_refused(edged(command, "rec", "events:=/x"), "write `-r events:=/x`", f"`edged {command} --help`", code=2)

    def test_with_json_an_error_is_json_too(self):
        for args, code, kind in ((("run", self.folder / "nothing", "--json"), 3, "input"),
                                 (("run", "x", "--mdoe", "--json"), 2, "usage"), (("config", "sonar", "--json"), 3, "input")):
            result = edged(*args)
            error = json.loads(result.stdout)["error"]
            self.assertEqual((result.returncode, error["exit_code"], error["kind"]), (code, code, kind))
            self.assert_refused(result, error["message"], code=code)
        self.assertEqual(edged("run", self.folder / "nothing").stdout, "")

    def test_what_the_system_refuses_is_no_bug(self):
        self.assert_refused(edged("run", "x" * 5000), "File name too long")
        self.assert_refused(edged("run", "sim:room", "--out", "/tmp/" + "x" * 300), "File name too long", "--out")
        self.assert_refused(edged("run", "sim:room", "--out", "/dev/null/run"), "Not a directory")
        self.assert_refused(edged("run", "sim:room", "--config", self.folder), str(self.folder))
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run([os.environ["EDGED"], "config"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(done.returncode, 3)
        self.assertIn("No space left", done.stderr)

    @unittest.skipIf(os.geteuid() == 0, "root may read everything")
    def test_a_folder_that_may_not_be_read_is_no_bug(self):
        closed = self.folder / "closed"
        closed.mkdir(0)
        self.addCleanup(closed.chmod, 0o700)
        for args in (("run", closed), ("info", closed), ("run", closed / "x"), ("run", "sim:room", "--out", closed / "run"),
                     ("simulate", "--duration", 0.1, "--out", closed / "x"), ("calib", closed)):
            self.assert_refused(edged(*args), str(closed))

    def test_version_names_the_program(self):
        version = edged("--version").stdout
        self.assertRegex(version, r"^edged \d+\.\d+\.\d+")
        citation = pathlib.Path(__file__).parents[2] / "CITATION.cff"
        self.assertIn(f"\nversion: {version.split()[1]}\n", citation.read_text())


class BadInput(WithFolder):
    def test_a_missing_recording(self):
        self.assert_refused(edged("run", self.folder / "nothing"), "nothing")

    def test_an_empty_folder(self):
        self.assert_refused(edged("run", self.folder), str(self.folder))

    def test_an_unknown_rig_lists_those_there_are(self):
        self.assert_refused(edged("run", self.folder, "--rig", "davis999"), "davis999", "davis240c_ecd")

    def test_an_unknown_option_suggests_the_nearest(self):
        self.assert_refused(edged("run", "sim:room", "--set", "packets.max_intervall_s=1"), "'packets.max_interval_s'")

    def test_an_option_of_the_simulator_is_looked_for_where_it_is_listed(self):
        self.assert_refused(edged("simulate", "--set", "sede=3"), "unknown option 'sede'", "'seed'", "`edged simulate --list`")
        self.assert_refused(edged("run", "sim:room:3:motoin.rest_s=1"), "'motion.rest_s'", "`edged simulate --list`")

    def test_a_text_that_is_no_events_is_refused_with_line_and_column(self):
        text = self.folder / "events.txt"
        for line, why in (("0.1 5", "2 columns where an event of this file has 4: t x y p"),
                          ("0.1 5 abc 1", "column 3 ('abc') must be a pixel, whole and from 0 on"),
                          ("0.1 5 6 7", "column 4 ('7') must be a polarity: 0 or 1, -1 or 1, or True or False"),
                          ("0.1 -5 6 0", "column 2 ('-5') must be a pixel")):
            text.write_text(f"{line}\n" * 3000)
            self.assert_refused(edged("info", text, "--geometry", "240x180", "--quiet"), f"{text}:1: {why}")
        shutil.copy(text, self.folder / "good.txt")
        (self.folder / "good.txt").write_text("".join(f"0.{i:04} 5 6 {'x' if i == 7 else 1}\n" for i in range(100)))
        self.assertIn("good.txt:8: column 4 ('x') must be a polarity", edged("info", self.folder / "good.txt", "--geometry", "240x180").stderr)

    def test_an_option_out_of_range_names_the_range(self):
        self.assert_refused(edged("run", "sim:room", "packets.max_interval_s=-1"), "packets.max_interval_s", "0.001")

    def test_a_bad_config_file_names_file_line_and_key(self):
        file = self.folder / "bad.yaml"
        file.write_text("packets:\n  max_interval_s: soon\n")
        self.assert_refused(edged("run", "sim:room", "--config", file), f"{file}:2", "packets.max_interval_s", "soon")

    def test_an_unknown_preset_or_seed(self):
        self.assert_refused(edged("run", "sim:moon"), "moon", "room")
        self.assert_refused(edged("run", "sim:room:x"), "seed")

    def test_a_folder_that_is_no_run_is_not_overwritten(self):
        (self.folder / "thesis.tex").write_text("years of work")
        self.assert_refused(edged("run", "sim:room", "--out", self.folder), str(self.folder), "--out")
        self.assertEqual((self.folder / "thesis.tex").read_text(), "years of work")

    def test_a_trajectory_that_is_none(self):
        file = self.folder / "notes.txt"
        file.write_text("hello\n")
        self.assert_refused(edged("eval", file, file), str(file))
        self.assert_refused(edged("eval", self.folder / "none.txt", file), "none.txt")


class Manual(WithFolder):
    def complete(self, *words):
        """What bash offers for the last word."""
        script = self.folder / "edged.bash"
        script.write_text(edged("manual", "bash").stdout)
        call = ('program=$1; shift; source "$0"; compopt() { :; }; COMP_WORDS=("$program" "$@"); COMP_CWORD=$#; _edged; '
                'echo "${COMPREPLY[*]}"')
        done = subprocess.run(["bash", "-c", call, script, os.environ["EDGED"], *words], capture_output=True, text=True,
                              check=True)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_the_man_page_tells_what_help_tells(self):
        page = edged("manual", "man").stdout.replace("\\-", "-")
        for command in self.complete(""):
            if not command.startswith("-"):
                self.assertIn(f".SS edged {command}\n", page)
        for option in self.complete("run", "--"):
            self.assertIn(option, page)
        self.assertIn("Exit codes", page)
        self.assertNotIn("edged manual", page)

    def test_bash_completes_commands_options_and_what_they_take(self):
        self.assertEqual(self.complete("d"), ["doctor", "depth"])
        self.assertEqual(self.complete("run", "sim:room", "--mo"), ["--mode"])
        self.assertEqual(self.complete("run", "--mode", "f"), ["frames", "fused"])
        self.assertEqual(self.complete("run", "--mode", "=", "f"), ["frames", "fused"])
        self.assertEqual(self.complete("run", "--rig", "davis2"), ["davis240c_ecd"])
        self.assertIn("packets.max_interval_s=", self.complete("run", "--set", "packets."))
        self.assertEqual(self.complete("simulate", "--set", "disturbance.ki"), ["disturbance.kind="])

    OFFERS = ((("d",), ["doctor", "depth"]), (("run", "sim:room", "--mo"), ["--mode"]), (("run", "--mode", "f"), ["frames", "fused"]),
              (("run", "--rig", "davis2"), ["davis240c_ecd"]), (("simulate", "--set", "disturbance.ki"), ["disturbance.kind="]))

    @unittest.skipUnless(shutil.which("zsh"), "no zsh")
    def test_zsh_completes_the_same(self):
        script = self.folder / "_edged"
        script.write_text(edged("manual", "zsh").stdout)
        # What zsh's completion system offers to its functions.
        call = ("program=$1; shift; words=($program \"$@\"); CURRENT=$#words; PREFIX=$words[CURRENT]; _files() { print FILES }; "
                "compset() { PREFIX=${PREFIX#--*=} }; "
                "compadd() { while [[ $1 != -- ]] shift; shift; for w in $@; [[ $w == $PREFIX* ]] && print -r -- $w; true }; "
                f"source {script}")
        def offered(*words):
            done = subprocess.run(["zsh", "-fc", call, "zsh", os.environ["EDGED"], *words], capture_output=True, text=True, check=True)
            self.assertEqual(done.stderr, "")
            return done.stdout.split()
        for words, expected in (*self.OFFERS, (("run", "--mode=f"), ["frames", "fused"])):
            self.assertEqual(sorted(offered(*words)), sorted(expected))
        self.assertEqual(offered("run", ""), ["FILES"])
        self.assertEqual(offered("run", "--calib", ""), ["FILES"])

    @unittest.skipUnless(shutil.which("fish"), "no fish")
    def test_fish_completes_the_same(self):
        script = self.folder / "edged.fish"
        script.write_text(edged("manual", "fish").stdout)
        path = f"{pathlib.Path(os.environ['EDGED']).parent}:{os.environ['PATH']}"
        for words, expected in self.OFFERS:
            call = f"source {script}; complete -C 'edged {' '.join(words)}'"
            done = subprocess.run(["fish", "-c", call], capture_output=True, text=True, check=True, cwd=self.folder,
                                  env={**os.environ, "HOME": str(self.folder), "PATH": path})
            self.assertEqual(sorted(line.split("\t")[0] for line in done.stdout.splitlines()), sorted(expected))

    def test_bash_offers_files_where_one_may_stand(self):
        self.assertEqual(self.complete("run", ""), [])
        self.assertEqual(self.complete("run", "--calib", ""), [])


class Eval(WithFolder):
    def setUp(self):
        super().setUp()
        self.truth = self.folder / "truth.txt"
        self.truth.write_text("".join(f"{100 + 0.1 * i:.1f} {i * 0.1} {(i % 7) * 0.1} {(i % 3) * 0.2} 0 0 0 1\n"
                                      for i in range(200)))

    def test_a_trajectory_equals_itself(self):
        result = json.loads(edged("eval", self.truth, self.truth, "--json").stdout)
        self.assertLess(result["ate_rmse_m"], 1e-9)
        # Ten poses a second are too few for windows of 1 s.
        self.assertEqual([(local["window_s"], local["windows"]) for local in result["local_error"]],
                         [(1.0, 0), (3.0, 18), (10.0, 3)])
        self.assertIsNone(result["local_error"][0]["rmse_m"])
        self.assertLess(result["local_error"][1]["rmse_m"], 1e-9)
        self.assertAlmostEqual(result["scale"], 1.0)
        self.assertEqual(result["pairs"], 200)

    def test_protocols_and_windows_are_applied(self):
        self.assertEqual(json.loads(edged("eval", self.truth, self.truth, "--protocol", "p1", "--json").stdout)["window_s"],
                         [3.0, 8.0])
        custom = edged("eval", self.truth, self.truth, "--align", "Yaw", "--first", "5", "--json")
        self.assertEqual(json.loads(custom.stdout)["alignment"], "position+yaw")
        table = edged("eval", self.truth, self.truth).stdout
        self.assertRegex(table, r"ATE position +0\.0000 .* mm\n")
        self.assertIn("0.00 mm over 3 s, 0.00 mm over 10 s (18, 3 windows)", table)

    def test_small_errors_are_in_millimetres_and_large_ones_in_metres(self):
        for shift, row in (("0.04", r"ATE position +40\.0000 .* mm\n"), ("4", r"ATE position +4\.0000 .* m\n")):
            shifted = self.folder / "shifted.txt"
            rows = [line.split() for line in self.truth.read_text().splitlines()]
            shifted.write_text("".join(f"{t} {x} {y} {float(z) + float(shift)} {' '.join(q)}\n" for t, x, y, z, *q in rows))
            self.assertRegex(edged("eval", self.truth, shifted, "--align", "none").stdout, row)

    def test_steps_separated_by_a_comma_are_refused_with_what_to_write(self):
        self.assert_refused(edged("eval", self.truth, self.truth, "--delta", "1,5"), "'1,5'", "blanks", code=2)
        self.assertEqual(len(json.loads(edged("eval", self.truth, self.truth, "--delta", 1, 5, "--json").stdout)["rpe"]), 2)

    def test_kitti_is_compared_pose_by_pose_and_no_times_are_made_up(self):
        kitti = self.folder / "poses.kitti"
        rows = [line.split() for line in self.truth.read_text().splitlines()]
        kitti.write_text("".join(f"1 0 0 {x} 0 1 0 {y} 0 0 1 {z}\n" for _, x, y, z, *_ in rows))
        result = json.loads(edged("eval", kitti, kitti, "--json").stdout)
        self.assertEqual((result["pairs"], result["duration_s"], result["start_scale"]), (200, None, None))
        self.assertNotIn("rpe", result)
        self.assertNotIn("local_error", result)
        self.assertNotIn(" s", edged("eval", kitti, kitti).stdout.splitlines()[0].split(";")[0])
        self.assertLess(json.loads(edged("eval", self.truth, kitti, "--json").stdout)["ate_rmse_m"], 1e-9)
        for seconds in (("--delta", 1), ("--first", 5), ("--protocol", "P1")):
            self.assert_refused(edged("eval", kitti, kitti, *seconds), seconds[0], "KITTI")
        self.assertEqual(edged("eval", kitti, kitti, "--protocol", "P4").returncode, 0)
        short = self.folder / "short.kitti"
        short.write_text("".join(kitti.read_text().splitlines(keepends=True)[:100]))
        self.assert_refused(edged("eval", kitti, short), "200 poses", "100", "TUM")

    def test_a_folder_is_refused_with_the_trajectory_in_it(self):
        run = self.folder / "run"
        run.mkdir()
        self.assert_refused(edged("eval", self.truth, run), f"{run}: is a folder; give the file of a trajectory")
        (run / "trajectory.tum").write_text("0 0 0 0 0 0 0 1\n")
        self.assert_refused(edged("eval", self.truth, run), f"{run}: is a folder; give {run}/trajectory.tum")

    def test_other_clocks_are_refused(self):
        later = self.folder / "later.txt"
        later.write_text("".join(f"{5000 + i} 0 0 {i} 0 0 0 1\n" for i in range(9)))
        self.assert_refused(edged("eval", self.truth, later), "clock")


class Calib(WithFolder):
    KALIBR = """cam0:
  T_cam_imu: [[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, -0.1], [0, 0, 0, 1]]
  camera_model: pinhole
  distortion_model: none
  intrinsics: [173.0, 173.0, 172.5, 129.5]
  resolution: [346, 260]
  timeshift_cam_imu: -0.003
"""

    def setUp(self):
        super().setUp()
        self.chain = self.folder / "camchain.yaml"
        self.chain.write_text(self.KALIBR)

    def test_a_rig_is_shown_with_both_directions_and_its_field_of_view(self):
        text = edged("calib", "davis240c_ecd").stdout
        for word in ("T_B_C", "T_C_B", "field of view", "t_imu = t_cam +2.400 ms", "gyro noise"):
            self.assertIn(word, text)
        shown = json.loads(edged("calib", "davis240c_ecd", "--json").stdout)
        self.assertEqual([camera["name"] for camera in shown["cameras"]], ["events", "frames"])
        self.assertEqual(shown["warnings"], [])

    def test_any_format_becomes_a_rig(self):
        self.assert_refused(edged("calib", self.chain), "cam0", "--camera cam0=events")
        rig = self.folder / "head.yaml"
        shown = edged("calib", self.chain, "--camera", "cam0=both", "--out", rig, "--json")
        self.assertAlmostEqual(json.loads(shown.stdout)["cameras"][0]["field_of_view_deg"]["horizontal"], 89.8, 1)
        again = json.loads(edged("calib", rig, "--json").stdout)
        self.assertEqual(again["name"], "head")
        self.assertEqual([camera["name"] for camera in again["cameras"]], ["events", "frames"])
        self.assertAlmostEqual(again["cameras"][0]["T_B_C"][0][3], 0.1)
        self.assertAlmostEqual(again["cameras"][0]["time_offset_s"], -0.003)
        self.assert_refused(edged("calib", self.chain, "--camera", "cam0=both", "--out", rig), "exists")

    def test_a_rig_that_is_written_again_is_the_same_to_the_last_bit(self):
        self.chain.write_text(self.KALIBR.replace("[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, -0.1]",
                                                  "[0.36, 0.48, -0.8, 0], [-0.8, 0.6, 0, 0], [0.48, 0.64, 0.6, -0.1]"))
        texts, source = [], [self.chain, "--camera", "cam0=events"]
        for number in range(4):
            rig = self.folder / f"head{number}.yaml"
            self.assertEqual(edged("calib", *source, "--out", rig).returncode, 0)
            texts.append(rig.read_text().replace(rig.stem, "head"))
            source = [rig]
        self.assertEqual(set(texts), {texts[0]})
        rig.write_text(rig.read_text().replace("q_B_C: [", "q_B_C: [0.5, 0.5, 0.5, 0.5]  # ["))
        shown = json.loads(edged("calib", rig, "--json").stdout)
        self.assertAlmostEqual(shown["cameras"][0]["T_B_C"][0][0], 0.36, 12, "T_B_C counts")

    def test_a_template_is_refused_until_it_is_filled_in(self):
        numbers = {"coefficients": "[0, 0, 0, 0]", "gyro_saturation": "34.8",
                   "accel_saturation": "78"}
        for camera, names, imu, middle in (("davis346", ["events", "frames"], "MPU-6500", "172, 129"),
                                           ("dvxplorer", ["events"], "BMI160", "319, 239"),
                                           ("evk4", ["events"], "--imu", "639, 359")):
            numbers["intrinsics"] = f"[800, 800, {middle}]"
            head = self.folder / f"{camera}.yaml"
            self.assertEqual(edged("calib", "--new", camera, "--out", head).returncode, 0)
            self.assertEqual(edged("calib", "--new", camera).stdout, head.read_text())
            self.assertIn(imu, head.read_text())
            wanted = [i for i, line in enumerate(head.read_text().splitlines(), 1) if "FILL_IN" in line.split("#")[0]]
            self.assert_refused(edged("calib", head), f"{head}:{wanted[0]}: {len(wanted)} lines read FILL_IN: {', '.join(map(str, wanted))};")
            rows = iter(("[1, 0, 0, 0.01]", "[0, 1, 0, 0]", "[0, 0, 1, 0.03]"))
            filled = []
            for line in head.read_text().splitlines():
                key, colon, rest = line.partition(":")
                if "FILL_IN" in line and line.startswith("      - "):
                    line = "      - " + next(rows)
                elif "FILL_IN" in rest:
                    line = f"{key}{colon} {numbers[key.strip()]}"
                filled.append(line)
            head.write_text("\n".join(filled) + "\n")
            shown = json.loads(edged("calib", head, "--json").stdout)
            self.assertEqual([c["name"] for c in shown["cameras"]], names)
            self.assertEqual(shown["warnings"], [])
        self.assert_refused(edged("calib", "--new", "evk4", "--out", head), "exists")
        self.assert_refused(edged("calib"), "FILE, --new, --check, --refine or --print-target", code=2)

    def test_cameras_are_renamed_with_what_they_see(self):
        rig = self.folder / "rig.yaml"
        self.assertEqual(edged("calib", "davis240c_ecd", "--out", rig).returncode, 0)
        out = self.folder / "renamed.yaml"
        shown = edged("calib", rig, "--camera", "events=events:dvs", "--camera", "frames=frames:events", "--out", out, "--json")
        self.assertEqual([(c["name"], c["modality"]) for c in json.loads(shown.stdout)["cameras"]], [("dvs", "events"), ("events", "frames")])
        self.assertEqual([c["name"] for c in json.loads(edged("calib", out, "--json").stdout)["cameras"]], ["dvs", "events"])
        self.assert_refused(edged("calib", rig, "--camera", "events=events:frames"), "two cameras would be called frames")
        for wrong in ("events=events:", "events=both:dvs"):
            self.assert_refused(edged("calib", rig, "--camera", wrong), f"--camera {wrong}: write NAME=events")

    def test_what_looks_wrong_is_said(self):
        self.chain.write_text(self.KALIBR.replace("-0.1]", "-100]"))
        result = edged("calib", self.chain, "--camera", "cam0=events")
        self.assertEqual(result.returncode, 0)
        self.assertIn("millimetres", result.stderr)
        self.chain.write_text(self.KALIBR.replace("[0, -1, 0, 0]", "[0, 1, 0, 0]"))
        self.assert_refused(edged("calib", self.chain, "--camera", "cam0=events"), "camchain.yaml:2", "mirrored")


class Depth(WithFolder):
    def test_a_network_is_shown_with_its_cost(self):
        for model in ("small", "small_recurrent"):
            shown = json.loads(edged("depth", model, "--json").stdout)
            self.assertEqual(shown["name"], model)
            self.assertGreater(shown["inference_ms"], 0.0)
        text = edged("depth").stdout
        for word in ("bins", "one core", "edged depth fetch"):
            self.assertIn(word, text)

    def test_fetch_says_where_the_published_weights_go(self):
        result = edged("depth", "fetch")
        self.assertEqual(result.returncode, 0, result.stderr)
        for word in ("E2DEPTH_si_grad_loss_mixed.pth.tar", "convert_checkpoint.py", "config/depth/e2depth.onnx"):
            self.assertIn(word, result.stdout)

    def test_a_model_that_cannot_be_used_is_refused_with_the_file(self):
        self.assert_refused(edged("depth", "nonsense"), "no depth model 'nonsense'", "small")
        self.assert_refused(edged("depth", self.folder / "none.onnx"), "none.onnx", "edged depth fetch")
        file = self.folder / "broken.onnx"
        file.write_bytes(b"no network")
        self.assert_refused(edged("depth", file), "broken.json", "docs/depth_model.md")
        file.with_suffix(".json").write_text('{"name": "x", "bins": 5, "multiple": 8, "d_max_m": 10, "alpha": 3.7}')
        self.assert_refused(edged("depth", file), "broken.onnx", "cannot be used as a depth network")
        file.with_suffix(".json").write_text('{"name": "x"}')
        self.assert_refused(edged("depth", file), "broken.json", "'bins'")

    @unittest.skipIf(os.geteuid() == 0, "root may read everything")
    def test_a_model_that_may_not_be_read_is_refused(self):
        file = self.folder / "secret.onnx"
        file.with_suffix(".json").write_text('{"name": "x", "bins": 5, "multiple": 8, "d_max_m": 10, "alpha": 3.7}')
        file.write_bytes(b"")
        file.chmod(0)
        self.assert_refused(edged("depth", file), "secret.onnx")


class Config(WithFolder):
    def test_every_option_is_described(self):
        options = json.loads(edged("config", "--json").stdout)
        self.assertGreater(len(options), 10)
        for option in options:
            self.assertTrue(option["effect"], option["key"])
            self.assertIn(option["key"], edged("config", option["key"]).stdout)

    def test_options_for_experts_are_shown_when_asked_for(self):
        few = edged("config").stdout
        self.assertIn("estimator.keyframes = ", few)
        self.assertNotIn("expert.", few)
        self.assertIn("edged config expert", few)
        self.assertIn("expert.estimator.recent_states = ", edged("config", "expert").stdout)
        self.assert_refused(edged("config", "sonar"), "'sonar'")
        self.assert_refused(edged("config", "intervall"), "'intervall'", "did you mean 'interval'?")
        self.assert_refused(edged("config", "keyfames", "--json"), "did you mean 'keyframes'?")
        self.assert_refused(edged("run", "sim:room", "--set", "estimator.recent_states=3"), "expert.estimator.recent_states")

    def test_the_printed_yaml_is_a_valid_config(self):
        file = self.folder / "all.yaml"
        file.write_text(edged("config", "--yaml").stdout)
        # A recording that is not there: the config has been read before it is looked for.
        self.assert_refused(edged("run", self.folder / "nothing", "--config", file), "nothing")


if __name__ == "__main__":
    unittest.main(verbosity=2)
