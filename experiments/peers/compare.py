#!/usr/bin/env python3
"""Replanning after an emergency, ours beside what a user would pick instead, in one run.

Plans the way back after each of the six emergencies of the paper's Table 1 on maps/museum, with
Intermezzo (`intermezzo experiment replanning`) and with GTPyhop (installed in a virtual
environment), and prints times, lengths of routes and work side by side. README.md says what is
compared with what.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import museum
import ours
import peer
import tables
from comparison import Comparison, compare
from failure import Failure

MAP = ours.ROOT / "maps" / "museum" / "map.geojson"


def main(arguments: list[str] | None = None) -> int:
    """Returns 0, or 1 if something could not be measured or written; argparse exits with 2."""
    options = _options(arguments)
    try:
        comparison = _compared(options)
        if options.out is not None:
            _write(comparison, options.out)
    except (Failure, museum.MapError) as why:
        print(f"error: {why}", file=sys.stderr)
        return 1
    print(json.dumps(comparison.json(), indent=2) if options.json else tables.printed(comparison))
    return 0


def _options(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--repetitions", type=_count, default=500, metavar="N", help="so often each (default: 500)"
    )
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="write peers.csv, peers_routes.csv, .json and .md there",
    )
    parser.add_argument(
        "--venv",
        type=Path,
        default=ours.ROOT / "target" / "peers",
        metavar="DIR",
        help="the virtual environment with GTPyhop; made if not there (default: target/peers)",
    )
    parser.add_argument(
        "--intermezzo",
        type=Path,
        metavar="PATH",
        help="a built command (default: build this checkout's)",
    )
    return parser.parse_args(arguments)


def _count(text: str) -> int:
    count = int(text) if text.isascii() and text.isdigit() else 0
    if not 1 <= count <= 1_000_000:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 1 to 1000000")
    return count


def _compared(options: argparse.Namespace) -> Comparison:
    site = museum.read(MAP)
    # What can fail without a network goes first, measuring last.
    python = peer.environment(options.venv)
    command = options.intermezzo or ours.built()
    mine = ours.measured(command.resolve(), options.repetitions)
    theirs = peer.measured(python, MAP, options.repetitions)
    return compare(site, mine, theirs)


def _write(comparison: Comparison, folder: Path) -> None:
    files = {
        "peers.csv": tables.as_csv(comparison.figures),
        "peers_routes.csv": tables.as_csv(comparison.routes),
        "peers.json": json.dumps(comparison.json(), indent=2) + "\n",
        "peers.md": tables.markdown(comparison),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as why:
        raise Failure(f"cannot write to {folder}: {why}") from why


if __name__ == "__main__":
    sys.exit(main())
