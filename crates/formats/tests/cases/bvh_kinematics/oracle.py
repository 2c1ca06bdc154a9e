"""World positions of every joint and end site of input.bvh, by rotation matrices: what src/formats/bvh must give.

Written apart from the reader: it knows this one file's layout only, multiplies matrices where the reader multiplies quaternions, and takes its
sines from NumPy. Run `python3 oracle.py > expected.txt` beside input.bvh. One line per frame and point: name, x, y, z in file units and axes.
"""

import numpy as np


def turn(axis, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    m = np.eye(3)
    m[i, i], m[i, j], m[j, i], m[j, j] = c, -s, s, c
    return m


def main():
    joints, stack, rows = [], [], []
    lines = iter(open("input.bvh").read().splitlines())
    for line in lines:
        words = line.split()
        if words[0] in ("ROOT", "JOINT", "End"):
            name = words[1] if words[0] != "End" else stack[-1]["name"] + "_end"
            stack.append({"name": name, "parent": stack[-1] if stack else None, "channels": []})
            joints.append(stack[-1])
        elif words[0] == "OFFSET":
            stack[-1]["offset"] = np.array([float(w) for w in words[1:]])
        elif words[0] == "CHANNELS":
            stack[-1]["channels"] = words[2:]
        elif words[0] == "}":
            stack.pop()
        elif words[0] == "Frame":
            rows = [[float(w) for w in line.split()] for line in lines]
    for frame, row in enumerate(rows):
        values = iter(row)
        for joint in joints:
            place, rotation = joint["offset"].copy(), np.eye(3)
            for channel in joint["channels"]:
                value = next(values)
                if channel.endswith("position"):
                    place["XYZ".index(channel[0])] = value
                elif channel.endswith("rotation"):
                    rotation = rotation @ turn(channel[0], value)
            if joint["parent"] is None:
                joint["at"], joint["to"] = place, rotation
            else:
                joint["at"] = joint["parent"]["at"] + joint["parent"]["to"] @ place
                joint["to"] = joint["parent"]["to"] @ rotation
            print(frame, joint["name"], *(f"{x:.9f}" for x in joint["at"]))


main()
