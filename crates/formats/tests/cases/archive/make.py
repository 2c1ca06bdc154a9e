"""Makes takes.zip with Python's own zip writer: `python3 make.py`. Two takes, one packed and one not, a folder, names of three scripts, what a Mac
and Windows leave behind, and one more archive inside."""

import gzip
import io
import pathlib
import zipfile

FIXED = (2024, 1, 1, 0, 0, 0)


def add(archive, path, content, method=zipfile.ZIP_DEFLATED):
    info = zipfile.ZipInfo(path, FIXED)
    info.compress_type = method
    archive.writestr(info, content)


def main():
    inner = io.BytesIO()
    with zipfile.ZipFile(inner, "w") as archive:
        add(archive, "inner/jump.amc", "#!OML:ASF\n")
        add(archive, "deeper.zip", b"PK\x05\x06" + bytes(18), zipfile.ZIP_STORED)
    with zipfile.ZipFile(pathlib.Path(__file__).with_name("takes.zip"), "w") as archive:
        add(archive, "takes/walk.bvh", "HIERARCHY walk " * 20)
        add(archive, "takes/run.BVH", "HIERARCHY run", zipfile.ZIP_STORED)
        add(archive, "takes/", b"", zipfile.ZIP_STORED)
        add(archive, "takes/höhe 目.bvh", "HIERARCHY")
        add(archive, "takes/packed.bvh.gz", gzip.compress(b"HIERARCHY packed", mtime=0), zipfile.ZIP_STORED)
        add(archive, "a.zip", inner.getvalue(), zipfile.ZIP_STORED)
        add(archive, "readme.txt", "no motion")
        add(archive, "takes/.hidden.bvh", "x")
        add(archive, "__MACOSX/takes/._walk.bvh", "x")
        add(archive, "../../etc/out.bvh", "HIERARCHY out")
        add(archive, "C:\\back\\slash.asf", ":version 1.10")


if __name__ == "__main__":
    main()
