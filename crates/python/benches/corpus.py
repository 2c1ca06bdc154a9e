"""Measure builds of a corpus: with one worker and more, on threads and on Ray, and killed.

``cargo xtask make-corpus 3000 takes`` writes the files; then, after ``pip install
"crates/python[corpus]"``: ``python crates/python/benches/corpus.py takes``. Ends with an error if
two builds differ in a byte.
"""

import argparse
import hashlib
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

#: The times at which builds are killed, as parts of the time of a whole one.
KILLED_AT = [0.05, 0.95]
START_OF_RAY = "import ray; ray.init(include_dashboard=False, log_to_driver=False); ray.shutdown()"


def command(takes, out, *options):
    return [sys.executable, "-m", "segue.corpus", "build", str(takes), str(out), *options]


def run(words):
    """Return the seconds of a program, and the most memory of it or a program before it, bytes."""
    start = time.perf_counter()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    secs = time.perf_counter() - start
    return secs, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024


def digest(corpus):
    """Return a hash of all files of a corpus but the records of its work."""
    total = hashlib.sha256()
    for path in sorted(corpus.rglob("*")):
        name = path.relative_to(corpus)
        if path.is_file() and name.parts[0] != ".work":
            total.update(f"{name.as_posix()} {path.stat().st_size}\n".encode())
            total.update(path.read_bytes())
    return total.hexdigest()


def kill(words, secs):
    """Start a program and kill it after some seconds. Return whether it was still running."""
    program = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        program.wait(timeout=secs)
    except subprocess.TimeoutExpired:
        program.kill()
        program.wait()
        return True
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("takes", type=Path, help="a folder of motion files")
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--no-ray", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    files = [path for path in asked.takes.rglob("*") if path.is_file()]
    print(f"{len(files)} files, {sum(path.stat().st_size for path in files) / 1e6:.0f} MB")
    digests = set()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "corpus"

        def report(name, words):
            secs, memory = run(words)
            digests.add(digest(out))
            size = sum(path.stat().st_size for path in out.rglob("*") if path.is_file())
            print(f"{name:<28}{secs:8.1f} s   {memory / 1e6:6.0f} MB   {size / 1e6:6.0f} MB out")
            return secs

        alone = 0.0
        for workers in asked.workers:
            shutil.rmtree(out, ignore_errors=True)
            alone = report(f"{workers} workers", command(asked.takes, out, f"--workers={workers}"))
        report("nothing new", command(asked.takes, out, f"--workers={workers}"))
        for path in out.iterdir():
            if path.name != ".work":
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        report("gathering alone", command(asked.takes, out, f"--workers={workers}"))

        shutil.rmtree(out, ignore_errors=True)
        times = [alone * part for part in KILLED_AT]
        chance = random.Random(asked.seed)
        kills = sum(kill(command(asked.takes, out), chance.uniform(*times) / 2) for _ in range(3))
        report(f"the rest after {kills} kills", command(asked.takes, out))

        if not asked.no_ray:
            start, _ = run([sys.executable, "-c", START_OF_RAY])
            print(f"{'start of Ray':<28}{start:8.1f} s")
            for workers in asked.workers:
                shutil.rmtree(out, ignore_errors=True)
                words = command(asked.takes, out, "--ray", f"--workers={workers}")
                secs = report(f"Ray, {workers} workers", words)
            print(f"{'Ray less its start':<28}{(secs - start) / alone:8.2f} × the time of threads")
    if len(digests) != 1:
        sys.exit(f"the builds differ: {len(digests)} results")
    print("all builds are equal in every byte")


if __name__ == "__main__":
    main()
