"""The same replanning by Intermezzo, as its own experiment measures it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from failure import Failure

ROOT = Path(__file__).resolve().parents[2]


def built() -> Path:
    """The command, built from this checkout if it is not up to date."""
    if shutil.which("cargo") is None:
        raise Failure(
            "there is no cargo to build intermezzo with; name a built one with --intermezzo"
        )
    print("building intermezzo", file=sys.stderr)
    command = ["cargo", "build", "--release", "--quiet", "--locked", "--package", "intermezzo"]
    if subprocess.run(command, cwd=ROOT, check=False).returncode != 0:
        raise Failure("intermezzo cannot be built; cargo has said why")
    target = Path(os.environ.get("CARGO_TARGET_DIR", "target"))
    return ROOT / target / "release" / "intermezzo"


def measured(command: Path, repetitions: int) -> dict[str, Any]:
    """The tables of `intermezzo experiment replanning`."""
    asked = ["experiment", "replanning", "--json", "--repetitions", str(repetitions)]
    try:
        done = subprocess.run(
            [str(command), *asked], stdout=subprocess.PIPE, text=True, cwd=ROOT, check=False
        )
    except OSError as why:
        raise Failure(f"cannot run {command}: {why.strerror}") from why
    if done.returncode != 0:
        raise Failure(f"{command} {' '.join(asked)} has failed ({done.returncode})")
    try:
        return tables(json.loads(done.stdout))
    except ValueError as why:
        raise Failure(f"{command} {' '.join(asked)} has not printed JSON: {why}") from why


def tables(report: Any) -> dict[str, Any]:
    """The tables of a report, and where it was measured. Raises Failure if one is missing."""
    found = report.get("tables") if isinstance(report, dict) else None
    if not isinstance(found, dict) or not isinstance(found.get("replanning"), list):
        raise Failure("intermezzo's report has no table `replanning`; is it of another version?")
    return {
        "replanning": found["replanning"],
        "doors": found.get("doors", []),
        "routes": found.get("routes", []),
        "machine": report.get("machine", {}),
    }
