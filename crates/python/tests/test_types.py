"""The stubs are those of the package."""

import subprocess
import sys
from pathlib import Path

import segue


def test_stubs_are_those_of_the_package():
    made = subprocess.run(
        # No stub says how classes lie in memory.
        [sys.executable, "-m", "mypy.stubtest", "segue", "--concise", "--ignore-disjoint-bases"],
        capture_output=True,
        text=True,
    )
    assert made.returncode == 0, made.stdout + made.stderr


def test_package_says_that_it_is_typed():
    assert (Path(segue.__file__).parent / "py.typed").is_file()
    for name in segue.__all__:
        own = getattr(segue, name)
        assert name.startswith("_") or name == "METRICS" or own.__doc__, name
