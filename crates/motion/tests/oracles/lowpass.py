"""Golden values for the zero-phase low-pass: `python3 tests/oracles/lowpass.py` writes lowpass.json beside it.

Nothing is shared with the program but the definition: SciPy's butter of second order, at the cut-off divided by 0.802 after the bilinear transform's warp, and filtfilt with odd padding.
"""

import json
import math
import pathlib

import numpy as np
from scipy.signal import butter, filtfilt

rng = np.random.default_rng(3)
cases = []
for rate, cutoff, length in [(30, 5, 40), (60, 6, 200), (120, 8, 300), (120, 25, 150), (30, 12, 25), (120, 3, 64)]:
    time = np.arange(length) / rate
    signal = 2 + 0.5 * time + np.sin(2 * np.pi * 1.3 * time) + 0.2 * rng.normal(size=length)
    share = math.atan(math.tan(math.pi * cutoff / rate) / 0.802) / math.pi
    padding = min(max(math.ceil(1.2 * rate / cutoff), 9), length - 1)
    b, a = butter(2, 2 * share)
    filtered = filtfilt(b, a, signal, padtype="odd", padlen=padding)
    cases.append({"rate": rate, "cutoff": cutoff, "signal": signal.tolist(), "filtered": filtered.tolist()})

path = pathlib.Path(__file__).with_suffix(".json")
path.write_text(json.dumps(cases) + "\n")
