"""Writes the robot tables beside this script, and expected.txt: where MuJoCo puts the bodies of the robot.

Needs MuJoCo and NumPy, and the manufacturer's model `g1_29dof.xml` of the public repository `unitreerobotics/unitree_mujoco` (folder
`unitree_robots/g1`), which is not kept here. Run `python3 oracle.py path/to/g1_29dof.xml` in this folder. The motion is made here: a turn on the
spot while walking ahead, with every hinge swinging inside its limits, but one beyond. One line per frame and body: name, x, y, z, metres, Z up.
"""

import sys
import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np

FRAMES = 12


def model(path):
    """Returns the model without its meshes, which kinematics do not need."""
    tree = ElementTree.parse(path)
    root = tree.getroot()
    for part in root.findall("asset") + root.findall("actuator") + root.findall("sensor"):
        root.remove(part)
    for body in root.iter("body"):
        for geom in [g for g in body.findall("geom") if g.get("type") == "mesh"]:
            body.remove(geom)
    return mujoco.MjModel.from_xml_string(ElementTree.tostring(root, encoding="unicode"))


def main():
    g1 = model(sys.argv[1])
    data = mujoco.MjData(g1)
    hinges = [j for j in range(g1.njnt) if g1.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE]
    assert len(hinges) == 29
    names = [mujoco.mj_id2name(g1, mujoco.mjtObj.mjOBJ_JOINT, j) for j in hinges]
    low, high = g1.jnt_range[hinges].T
    rows, named, expected = [], [], []
    for frame in range(FRAMES):
        t = frame / FRAMES
        angles = (low + high) / 2 + (high - low) * 0.45 * np.sin(6.0 * t + np.arange(29))
        if frame >= 8:
            angles[names.index("left_knee_joint")] = high[names.index("left_knee_joint")] + 0.2
        place = np.array([0.8 * t, 0.3 * t, 0.79 - 0.05 * t])
        euler = np.array([0.2 * np.sin(5 * t), -0.15, 2.4 * t])
        quat = np.zeros(4)
        # MuJoCo's `XYZ` in capitals is about fixed axes.
        mujoco.mju_euler2Quat(quat, euler, "XYZ")
        data.qpos[:3], data.qpos[3:7], data.qpos[7:] = place, quat, angles
        mujoco.mj_kinematics(g1, data)
        rows.append((place, quat, angles))
        named.append([frame, *(place * 100), *np.degrees(euler), *np.degrees(angles)])
        bodies = [("pelvis", 1)] + [(name, g1.jnt_bodyid[j]) for name, j in zip(names, hinges)]
        for name, body in bodies:
            at = " ".join(f"{v:.7f}" for v in data.xpos[body])
            expected.append(f"{frame} {name.removesuffix('_joint')} {at}")
    line = lambda values: ",".join(f"{v:.7g}" for v in values)
    with open("scalar_last.csv", "w") as out:
        out.writelines(line([*p, *q[1:], q[0], *a]) + "\n" for p, q, a in rows)
    with open("scalar_first.csv", "w") as out:
        out.writelines(line([*p, *q, *a]) + "\n" for p, q, a in rows)
    with open("named.csv", "w") as out:
        root = [f"root_{part}{axis}" for part in ("translate", "rotate") for axis in "XYZ"]
        out.write(",".join(["Frame", *root, *(f"{name}_dof" for name in names)]) + "\r\n")
        out.writelines(line(values) + "\r\n" for values in named)
    with open("expected.txt", "w") as out:
        out.writelines(row + "\n" for row in expected)


main()
