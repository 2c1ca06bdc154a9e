"""``python -m segue.corpus``: corpora from the command line."""

from __future__ import annotations

import argparse
import sys
import time

from . import build


def main(words: list[str] | None = None) -> int:
    """Run the command. Return 0, or 1 where it cannot be done."""
    parser = argparse.ArgumentParser(prog="python -m segue.corpus", description=__doc__)
    command = parser.add_subparsers(required=True).add_parser(
        "build",
        help="builds a corpus of motion files",
        epilog="example: python -m segue.corpus build 'takes/**/*.bvh' set.zip s3://a/more corpus",
    )
    add = command.add_argument
    add("inputs", nargs="+", metavar="IN", help="files, folders, zips, patterns, addresses")
    add("out", metavar="OUT", help="the folder of the corpus")
    add("--workers", type=int, metavar="N", help="how many files are read at the same time")
    add(
        "--ray",
        nargs="?",
        const=True,
        metavar="ADDRESS",
        help="works on Ray: on this machine, or on the cluster at an address",
    )
    add("--clean", action="store_true", help="mends the faults of takes")
    add("--labels", metavar="FILE", help="a CSV file: a path, and the labels of its clips")
    add("--fresh", action="store_true", help="computes all files again")
    asked = parser.parse_args(words)
    try:
        report = build(
            asked.inputs,
            asked.out,
            workers=asked.workers,
            ray=asked.ray,
            clean=asked.clean,
            labels=asked.labels,
            resume=not asked.fresh,
            progress=_Progress(),
        )
    except (OSError, ImportError) as error:
        print(f"segue.corpus: {error}", file=sys.stderr)
        return 1
    print(
        f"{report.rows} rows: {report.clips} clips, {report.copies} of them copies; "
        f"{report.unplaced} not on the body, {report.unreadable} unreadable; "
        f"{report.made} files computed"
    )
    return 0


class _Progress:
    """Prints the progress once a second."""

    def __init__(self) -> None:
        self._last = time.monotonic()

    def __call__(self, done: int, total: int) -> None:
        now = time.monotonic()
        if now - self._last >= 1 or done == total:
            self._last = now
            print(f"{done} of {total} files", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
