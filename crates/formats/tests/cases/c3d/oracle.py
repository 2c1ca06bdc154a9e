"""Writes the C3D files beside this script, and expected.txt: the points that other programs read from them.

Two files are written by the packages ezc3d (metres, floats) and c3d (millimetres), and the same motion is written here byte by byte for all three
processors, as integers and floats, after the tables of "The C3D File Format User Guide". Each is read back by ezc3d, those of MIPS, which it does
not know, by c3d; what they read is expected.
Run `python3 oracle.py` in this folder, with ezc3d 1.7.2, c3d 0.6.0 and NumPy. One line per file, frame and point: x, y, z in file units, or `gap`.
"""

import math
import struct

import c3d
import ezc3d
import numpy as np

LABELS = ["LASI", "RASI", "Ball", "Box", "Far"]
FRAMES = 7


def place(frame, point):
    """Returns the place of a point, which is a multiple of 0.25 so that integers with that scale hold it."""
    if point == 2 and frame in (3, 4):
        return None
    turn = 0.3 * frame + point
    exact = np.array([400 * math.cos(turn), 300 * math.sin(turn), 900 + 20 * frame + 100 * point])
    return np.round(exact * 4) / 4


def float32(value, processor):
    if processor == 86:
        return struct.pack(">f", value)
    if processor == 84:
        return struct.pack("<f", value)
    low, high = struct.unpack("<HH", struct.pack("<f", value * 4))
    return struct.pack("<HH", high, low)


def int16(value, processor):
    return struct.pack(">h" if processor == 86 else "<h", value)


def parameter(group, name, kind, sizes, data, processor, last=False):
    head = struct.pack("<bb", len(name), group) + name.encode()
    body = struct.pack("<bB", kind, len(sizes)) + bytes(sizes) + data + b"\0"
    return head + int16(0 if last else len(body) + 2, processor) + body


def group(number, name, processor):
    return struct.pack("<bb", len(name), -number) + name.encode() + int16(3, processor) + b"\0"


def by_hand(processor, is_float):
    f, i = (lambda v: float32(v, processor)), (lambda v: int16(v, processor))
    points, analog = len(LABELS), 4
    scale = -0.25 if is_float else 0.25
    text = lambda words, width: "".join(word.ljust(width) for word in words).encode()
    section = group(1, "POINT", processor)
    section += parameter(1, "USED", 2, [], i(points), processor)
    section += parameter(1, "SCALE", 4, [], f(scale), processor)
    section += parameter(1, "RATE", 4, [], f(50.0), processor)
    section += parameter(1, "DATA_START", 2, [], i(4), processor)
    section += parameter(1, "FRAMES", 2, [], i(FRAMES), processor)
    section += parameter(1, "UNITS", -1, [2], b"mm", processor)
    section += parameter(1, "Y_SCREEN", -1, [2], b"+Z", processor)
    section += parameter(1, "LABELS", -1, [6, 3], text(LABELS[:3], 6), processor)
    section += parameter(1, "LABELS2", -1, [6, 2], text(LABELS[3:], 6), processor)
    section += group(2, "ANALOG", processor)
    section += parameter(2, "USED", 2, [], i(2), processor)
    section += parameter(2, "RATE", 4, [], f(100.0), processor)
    section += parameter(2, "GEN_SCALE", 4, [], f(1.0), processor)
    section += parameter(2, "SCALE", 4, [2], f(1.0) + f(1.0), processor)
    section += parameter(2, "OFFSET", 2, [2], i(0) + i(0), processor)
    section += parameter(2, "LABELS", -1, [2, 2], b"A1A2", processor, last=True)
    section = struct.pack("<BBBB", 1, 80, 2, processor) + section
    header = struct.pack("<BB", 2, 80) + i(points) + i(analog) + i(1) + i(FRAMES) + i(10)
    header += f(scale) + i(4) + i(2) + f(50.0)
    data = b""
    for frame in range(FRAMES):
        for point in range(points):
            at = place(frame, point)
            values = [0, 0, 0, -1] if at is None else [*(at if is_float else at * 4), 0]
            data += b"".join(f(v) if is_float else i(int(v)) for v in values)
        data += b"".join(f(float(v)) if is_float else i(v) for v in range(analog))
    padded = lambda part: part + b"\0" * (-len(part) % 512)
    return padded(header) + section.ljust(1024, b"\0") + padded(data)


def by_ezc3d(path):
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [120.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = LABELS
    file["parameters"]["POINT"]["UNITS"]["value"] = ["m"]
    points = np.full((4, len(LABELS), FRAMES), np.nan)
    for frame in range(FRAMES):
        for point in range(len(LABELS)):
            at = place(frame, point)
            if at is not None:
                points[:, point, frame] = [*(at / 1000), 1]
    file["data"]["points"] = points
    file["data"]["meta_points"]["residuals"] = np.where(np.isnan(points[:1]), -1, 0)
    file.write(path)


def by_c3d(path):
    writer = c3d.Writer(point_rate=60.0, point_scale=0.25, analog_rate=0)
    writer.set_point_labels(LABELS)
    for frame in range(FRAMES):
        rows = np.zeros((len(LABELS), 5), dtype=np.float32)
        for point in range(len(LABELS)):
            at = place(frame, point)
            rows[point] = [0, 0, 0, -1, 0] if at is None else [*at, 0, 0]
        writer.add_frames([(rows, np.array([[]]))])
    with open(path, "wb") as file:
        writer.write(file)


def main():
    names = []
    for processor, word in [(84, "intel"), (85, "dec"), (86, "mips")]:
        for is_float in (False, True):
            names.append(f"{word}_{'float' if is_float else 'int'}.c3d")
            open(names[-1], "wb").write(by_hand(processor, is_float))
    by_ezc3d("ezc3d.c3d")
    by_c3d("python_c3d.c3d")
    names += ["ezc3d.c3d", "python_c3d.c3d"]
    with open("expected.txt", "w") as out:
        for name in names:
            for frame, row in enumerate(read_back(name)):
                for point, (at, residual) in enumerate(row):
                    gap = np.isnan(at).any() or residual < 0
                    place = "gap" if gap else " ".join(repr(float(v)) for v in at)
                    print(name, frame, point, place, file=out)


def read_back(name):
    if name.startswith("mips"):
        with open(name, "rb") as file:
            return [[(row[:3], row[3]) for row in points] for _, points, _ in c3d.Reader(file).read_frames()]
    data = ezc3d.c3d(name)["data"]
    points, residuals = data["points"], data["meta_points"]["residuals"]
    frames, count = range(points.shape[2]), range(points.shape[1])
    return [[(points[:3, point, frame], residuals[0, point, frame]) for point in count] for frame in frames]


main()
