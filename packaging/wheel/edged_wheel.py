# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Builds the wheel for pip (PEP 517) with CMake and Debian's libraries: the module, the program `edged`, rigs and networks.

    pip wheel --no-deps .                                                                 # a build of its own, in build/wheel
    pip wheel --no-deps --config-settings=build-dir=build/release .          # from a build that is there
    pip wheel --no-deps --config-settings=libraries=inside .                      # with the libraries that it needs

The wheel is for the Python that builds it. Without its libraries it is for systems that have the same (linux_x86_64), with
them for any with as new a glibc (manylinux).
"""
import base64
import hashlib
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
VERSION = re.search(r"project\(edged VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
METADATA = f"""Metadata-Version: 2.1
Name: edged
Version: {VERSION}
Summary: Visual-inertial SLAM from events, frames and an IMU
License: Apache-2.0
Requires-Python: >=3.9
Requires-Dist: numpy
"""

def _run(*command):
    subprocess.run(list(map(str, command)), check=True, cwd=ROOT)


def _build(build_dir):
    """The folder of a build: the one given, as it is, else one made for this Python."""
    if build_dir:
        return ROOT / build_dir
    build = ROOT / "build" / "wheel"
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    merged = [] if (build / "CMakeCache.txt").exists() else ["-DCMAKE_UNITY_BUILD=ON"]
    _run("cmake", "-S", ROOT, "-B", build, *generator, *merged, "-DCMAKE_BUILD_TYPE=Release", "-DEDGED_TESTS=OFF", "-DEDGED_BENCH=OFF",
         f"-DPython3_EXECUTABLE={sys.executable}")
    _run("cmake", "--build", build, "--target", "edged_python", "edged", "--parallel", os.cpu_count() or 1)
    return build


def _install(build, package):
    """Module, program and its data, all below the package, which may lie anywhere."""
    with tempfile.TemporaryDirectory() as folder:
        _run("cmake", "--install", build, "--component", "python", "--strip", "--prefix", folder)
        shutil.copytree(next(pathlib.Path(folder).glob("**/edged/__init__.py")).parent, package)
    _run("cmake", "--install", build, "--component", "program", "--strip", "--prefix", package)


def _add_libraries(package):
    """The platform of the wheel: the oldest glibc that has all that module, program and their libraries need."""
    files = [package / "bin" / "edged", *package.glob("_edged*.so")]
    needed = subprocess.run([ROOT / "packaging" / "add_libraries", package, *files], check=True, stdout=subprocess.PIPE, text=True).stdout
    return f"manylinux_{needed.split()[0].replace('.', '_')}_{platform.machine()}"


def _record_line(name, content):
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def _pack(wheel, tree):
    """Every file with its mode; RECORD, which lists them, last."""
    record = ""
    info = f"edged-{VERSION}.dist-info"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(path for path in tree.rglob("*") if path.is_file()):
            name = file.relative_to(tree).as_posix()
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.external_attr = (0o100755 if os.access(file, os.X_OK) else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, file.read_bytes())
            record += _record_line(name, file.read_bytes())
        archive.writestr(f"{info}/RECORD", record + f"{info}/RECORD,,\n")


def _tag(system=None):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{system or re.sub(r'[^a-z0-9]', '_', sysconfig.get_platform())}"


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None, tag=None):
    """The hook of PEP 517: what the wheel will say of itself, without building it."""
    del config_settings
    info = pathlib.Path(metadata_directory) / f"edged-{VERSION}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(METADATA)
    (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: edged_wheel\nRoot-Is-Purelib: false\nTag: {tag or _tag()}\n")
    (info / "entry_points.txt").write_text("[console_scripts]\nedged = edged._program:main\n")
    shutil.copy(ROOT / "LICENSE", info)
    return info.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The hook of PEP 517."""
    del metadata_directory
    settings = config_settings or {}
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder)
        _install(_build(settings.get("build-dir")), tree / "edged")
        tag = _tag(_add_libraries(tree / "edged") if settings.get("libraries") == "inside" else None)
        prepare_metadata_for_build_wheel(tree, tag=tag)
        name = f"edged-{VERSION}-{tag}.whl"
        _pack(pathlib.Path(wheel_directory) / name, tree)
    return name


def build_sdist(sdist_directory, config_settings=None):
    """The hook of PEP 517: what is committed."""
    del config_settings
    name = f"edged-{VERSION}"
    with tempfile.TemporaryDirectory() as folder:
        metadata = pathlib.Path(folder) / "PKG-INFO"
        metadata.write_text(METADATA)
        _run("git", "archive", f"--prefix={name}/", f"--add-file={metadata}", "-o", pathlib.Path(sdist_directory) / f"{name}.tar.gz", "HEAD")
    return f"{name}.tar.gz"
