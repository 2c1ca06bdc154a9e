"""Measure the stages of a corpus, each on one core.

``cargo xtask make-corpus 3000 takes`` writes the files; then, after ``pip install
"crates/python[corpus]"``: ``python crates/python/benches/stages.py takes``.
"""

import os

# Before the module is imported, which starts its threads once.
os.environ["RAYON_NUM_THREADS"] = "1"

import argparse
import hashlib
import random
import sys
import time
from pathlib import Path

from segue import _core

MB = 1e6


class Stages:
    """The times of stages."""

    def __init__(self):
        self.secs = {}

    def time(self, name, work):
        """Return what some work returns, and add its time to a stage."""
        start = time.perf_counter()
        result = work()
        self.secs[name] = self.secs.get(name, 0.0) + time.perf_counter() - start
        return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("takes", type=Path, help="a folder of motion files")
    parser.add_argument("--files", type=int, default=300, help="the files that are drawn of it")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    files = sorted(path for path in asked.takes.rglob("*") if path.is_file())
    files = random.Random(asked.seed).sample(files, min(asked.files, len(files)))
    if not files:
        sys.exit(f"there are no files in {asked.takes}")

    of_files = Stages()
    size = clips = frames = records = 0
    for path in files:
        data = of_files.time("reading the bytes, from the system's cache", path.read_bytes)
        of_files.time("SHA-256", lambda: hashlib.sha256(data).digest())
        read = of_files.time("clips of the bytes", lambda: _core.read_bytes(data, path.name))
        of_files.time("their artefacts", lambda: _core.metrics_of(read))
        record = of_files.time(
            "the whole record", lambda: _core.corpus_record(path.name, data, [], False)
        )
        size, records = size + len(data), records + len(record)
        clips, frames = clips + len(read), frames + sum(clip.frames for clip in read)
    print(f"{len(files)} files, {size / MB:.1f} MB, {clips} clips, {frames} frames")
    for name, secs in of_files.secs.items():
        print(f"{name:<44}{secs / len(files) * 1e3:8.2f} ms a file {size / MB / secs:8.0f} MB/s")
    whole, parts = of_files.secs["the whole record"], ("clips of the bytes", "their artefacts")
    rest = whole - sum(of_files.secs[part] for part in parts)
    print(f"{'body, features, thumbnail, signature':<44}{rest / len(files) * 1e3:8.2f} ms a file")
    print(f"{'a record':<44}{records / len(files) / 1e3:8.1f} KB")


if __name__ == "__main__":
    main()
