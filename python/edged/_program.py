# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The program `edged` that comes with the module, as a command of a wheel and for what it alone writes."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

from ._edged import InputError

_WITH_RESULT = (0, 4, 5)  # exit codes of edged run: good, never good, not to be trusted


def _program():
    mine = pathlib.Path(__file__).parent / "bin" / "edged"
    found = str(mine) if mine.exists() else shutil.which("edged")
    if found is None:
        raise InputError("the program `edged` is not installed: scripts/demo.sh builds it, the package `edged` has it")
    return found


def main():
    os.execv(_program(), ["edged", *sys.argv[1:]])


def _words(flag, value):
    name = "--" + flag.replace("_", "-")
    if value is None or value is False:
        return []
    if value is True:
        return [name]
    if isinstance(value, dict):
        value = [f"{key}={json.dumps(item) if isinstance(item, bool) else item}" for key, item in value.items()]
    return [word for item in (value if isinstance(value, (list, tuple)) else [value]) for word in (name, os.fspath(item) if isinstance(item, os.PathLike) else str(item))]


def write_run(recording, out=None, options=None, **flags):
    words = [_program(), "run", os.fspath(recording), "--json", "--quiet"]
    for flag, value in {"out": out, "set": options, **flags}.items():
        words += _words(flag, value)
    done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=False)
    result = json.loads(done.stdout) if done.stdout else {}
    if done.returncode not in _WITH_RESULT:
        raise InputError(result.get("error", {}).get("message", f"edged run: exit code {done.returncode}"))
    return result
