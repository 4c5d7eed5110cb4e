"""GTPyhop in a virtual environment of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from failure import Failure

HERE = Path(__file__).resolve().parent
REQUIREMENTS = HERE / "requirements.txt"
# Written last, so that an environment whose making was interrupted is made again.
STAMP = "peers-installed.txt"


def environment(folder: Path) -> Path:
    """The Python of an environment with what `requirements.txt` names; made if it is not there."""
    python = folder / "bin" / "python"
    wanted = REQUIREMENTS.read_text(encoding="utf-8")
    stamp = folder / STAMP
    if python.exists() and stamp.exists() and stamp.read_text(encoding="utf-8") == wanted:
        return python
    print(f"installing {wanted.strip()} in {folder}", file=sys.stderr)
    _do(
        [sys.executable, "-m", "venv", str(folder)],
        "cannot make a virtual environment; on Debian it takes the package python3-venv",
    )
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    _do(
        [*pip, "--requirement", str(REQUIREMENTS)],
        f"cannot install {wanted.strip()}; is there a network? (pip's PIP_INDEX_URL is heeded)",
    )
    stamp.write_text(wanted, encoding="utf-8")
    return python


def measured(python: Path, site: Path, repetitions: int) -> dict[str, Any]:
    """What `measure.py` finds out."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "measured.json"
        command = [str(python), str(HERE / "measure.py"), "--map", str(site)]
        command += ["--repetitions", str(repetitions), "--out", str(out)]
        _do(command, "GTPyhop cannot be measured", {"GTPYHOP_QUIET": "true"})
        found: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
        return found


def _do(command: list[str], otherwise: str, more: dict[str, str] | None = None) -> None:
    """Runs a command. Raises Failure, with the last that it said, if it fails."""
    environ = {**os.environ, **(more or {})}
    try:
        done = subprocess.run(command, env=environ, capture_output=True, text=True, check=False)
    except OSError as why:
        raise Failure(f"{otherwise}\n  {command[0]}: {why}") from why
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()[-3:]
        raise Failure("\n  ".join([otherwise, *said]))
