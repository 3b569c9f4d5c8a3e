#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What the pages name in `code` exists: files and folders, options, flags, tests, and identifiers, which are words of the sources.
Names of other projects are those of FOREIGN. Environment: EDGED, the program, whose options and flags are then the exact ones."""
import functools
import os
import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def all_files():
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    if tracked.returncode == 0:
        return [file for file in tracked.stdout.splitlines() if (ROOT / file).is_file()]
    return [str(path.relative_to(ROOT)) for path in ROOT.rglob("*") if path.is_file()]  # sources without their history


FILES = sorted(all_files())
PAGES = [file for file in FILES if file.endswith(".md") and not file.startswith(("bench/", "CHANGELOG"))]
FOLDERS = {str(parent) for file in FILES for parent in pathlib.PurePath(file).parents} - {"."}
BINARY = (".md", ".png", ".jpg", ".webp", ".onnx", ".bin")

# Names of other projects, as patterns of a whole name.
FOREIGN = re.compile("|".join((
    r"CamBase|GeometricCamera|TrackKLT|NeedNewKeyFrame|ImuError|Propagator|InertialInitializer|StateHelper|KeyFrameDatabase",  # SLAM
    r"BarometricFactor|SaveTrajectory\w+|save_total_state|vi?i?ns?_\w+\.csv|vio\.csv",
    r"(EKF2|VISO|EK3|MAV|SERIAL2|SER|UXRCE)_\w+|VEL[XY]*Z?|POSZ|YAW|_[XYZ]|Onboard|SET_GPS_GLOBAL_ORIGIN",  # autopilots
    r"rclcpp|rviz2|rmw_\w+|ipfrag_\w+|NetworkWriter|evo|ccache|compinit|metavision_\w+|kalibr_\w+",  # programs, settings
    r"function_name|member_|kConstant|name_test\.cpp|(height|velocity)_late|mav0/\w+0/data\.csv",  # examples, put together in the code
    r"T_cam0_cam\d|T_10|T_W_B_of|cam_to_cam\.yaml|colmap|images/left/distorted|_ts|debian/",  # data sets
)))


@functools.lru_cache(None)
def sources():
    own = pathlib.Path(__file__).name
    return "\n".join((ROOT / file).read_text(errors="replace") for file in FILES
                     if not file.endswith((*BINARY, own)))


@functools.lru_cache(None)
def stands_there(text):
    return text in sources()


@functools.lru_cache(None)
def words():
    return set(re.findall(r"[A-Za-z_]\w*", sources()))


def listed(*args):
    """Keys of the yaml that the program prints."""
    keys, groups = set(), []
    for line in subprocess.run([os.environ["EDGED"], *args], capture_output=True, text=True, check=False).stdout.splitlines():
        if found := re.match(r"( *)([\w.]+):", line):
            groups = groups[:len(found.group(1)) // 2] + [found.group(2)]
            keys.add(".".join(groups))
    return keys


@functools.lru_cache(None)
def options():
    """All keys, those of experts without and with their prefix too; none without the program."""
    if "EDGED" not in os.environ:
        return set()
    keys = listed("config", "--yaml") | listed("simulate", "--list") | listed("ros2", "--print-config")
    return keys | {key.removeprefix("expert.") for key in keys}


@functools.lru_cache(None)
def is_path(name):
    name = name.rstrip("/")
    return any(file == name or file.endswith(f"/{name}") or f"/{file}".rpartition(".")[0].endswith(f"/{name}") for file in FILES) or any(
        folder == name or folder.endswith(f"/{name}") for folder in FOLDERS)


def is_option(key):
    key = key.removesuffix(".*")
    known = options()
    return key in known or any(other.startswith(f"{key}.") for other in known) or all(part in words() for part in key.split("."))


@functools.lru_cache(None)
def is_test(suite, name):
    return re.search(rf"\bTEST(_[FP])?\({suite},\s*{name}", sources()) is not None


def exists(name):
    """Whether what a page names is there; what is no path, option, flag, test or identifier counts as such."""
    if FOREIGN.fullmatch(name) or "..." in name or re.search(r"NAME|VERSION|SEQUENCE|[A-Z]{4,}/|/[A-Z]{4,}|^\.\./share|^share/", name):
        return True  # of others, a part is left out, or depends on the user
    if found := re.fullmatch(r"(--[a-z][a-z0-9-]*)(\[?=.*)?", name):
        return stands_there(found.group(1))
    if found := re.fullmatch(r"([\w./-]+)\{([\w,]+)\}([\w.]*)", name):
        return all(exists(found.group(1) + part + found.group(3)) for part in found.group(2).split(","))
    if found := re.fullmatch(r"(?:\w+/)?([A-Z]\w+)\.(\*|[A-Z]\w+)", name):
        return is_test(found.group(1), found.group(2).rstrip("*"))
    if re.fullmatch(r"[\w.-]+(/[\w.-]+)*/?", name) and "/" in name:
        return is_path(name) or stands_there(name) or name.startswith("build/") or is_option(name.replace("/", "."))
    if re.fullmatch(r"[a-z]\w*(\.[a-z]\w*)+(\.\*)?(=\S+)?", name) and is_option(name.split("=")[0]):
        return True
    if re.fullmatch(r"[\w-]+(\.[\w-]+)+", name):
        return is_path(name) or stands_there(name)
    if re.fullmatch(r"[A-Za-z_]\w+(::\w+)*(\(\))?", name):
        return is_path(name) or all(part in words() for part in re.findall(r"\w+", name))
    return True


def names(page):
    """(line, name) of the inline code of a page: whole if it has no blanks, else what stands in it as a path of ours or a flag."""
    fenced = False
    for number, line in enumerate((ROOT / page).read_text().splitlines(), 1):
        if line == "## Forbidden words":
            return
        fenced ^= line.startswith("```")
        for code in [] if fenced else re.findall(r"`([^`]+)`", line):
            parts = code.split()
            yield from ((number, part.rstrip(",;:")) for part in parts
                        if len(parts) == 1 or re.match(r"(bench|scripts|tests|tools|apps|src|toolbox|config|docs)/", part))


class Claims(unittest.TestCase):
    def test_wrong_names_are_found(self):
        for name in ("frontend/tracker", "apps/run", "estimator.keyframes", "--localize-only", "Packetizer.*", "Window::drop_oldest"):
            self.assertTrue(exists(name), name)
        for name in ("frontend/trakker", "apps/runner/", "estimator.keyfrmes", "--localise-only", "Packetiser.*", "Window::lineaization_point"):
            self.assertFalse(exists(name), name)

    def test_what_the_pages_name_exists(self):
        self.assertGreater(len(PAGES), 70)
        for page in PAGES:
            for number, name in names(page):
                with self.subTest(where=f"{page}:{number}", name=name):
                    self.assertTrue(exists(name))


if __name__ == "__main__":
    unittest.main()
