"""Writes the positions that Blender finds in the FBX files of tests/fbx:

    mkdir out && SEGUE_FBX_OUT=$PWD/out cargo test -p segue-formats --test fbx files_of
    pip install bpy==5.0.1 && python fbx_golden.py out/*.fbx > ../fbx/golden.json

Blender's importer in Python (io_scene_fbx) shares no code with ufbx. Positions are metres, Y up,
one for each frame of each take, by the name of the joint.
"""

import json
import pathlib
import sys

import bpy


def takes(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_scene_fbx")
    bpy.ops.import_scene.fbx(filepath=str(path), anim_offset=0.0)
    scene = bpy.context.scene
    actions = {}
    for action in bpy.data.actions:
        # `object|take|layer`
        actions.setdefault(action.name.split("|")[1], []).append(action)
    found = {}
    for take, parts in sorted(actions.items()):
        for thing in scene.objects:
            if thing.animation_data:
                thing.animation_data.action = None
        for action in parts:
            data = bpy.data.objects[action.name.split("|")[0]].animation_data
            data.action = action
            if data.action_slot is None:
                data.action_slot = action.slots[0]
        first = min(action.frame_range[0] for action in parts)
        last = max(action.frame_range[1] for action in parts)
        joints = {}
        for index in range(round(last - first) + 1):
            scene.frame_set(round(first) + index)
            for thing in scene.objects:
                if thing.type == "ARMATURE":
                    for bone in thing.pose.bones:
                        place = thing.matrix_world @ bone.head
                        joints.setdefault(bone.name, []).append(
                            [round(v, 6) for v in (place.x, place.z, -place.y)]
                        )
        found[take] = joints
    return found


def main():
    # Blender prints on the standard output, too.
    result = {pathlib.Path(path).stem: takes(path) for path in sys.argv[1:]}
    json.dump(result, sys.stdout, separators=(",", ":"), sort_keys=True)
    print()


if __name__ == "__main__":
    main()
