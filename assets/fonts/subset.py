#!/usr/bin/env python3
"""Makes the two Inter files beside this script. How to run it, and why, is in README.md.

usage: subset.py DIRECTORY_WITH_WOFF2 OUTPUT_DIRECTORY
"""

import sys
from pathlib import Path

from fontTools import subset
from fontTools.ttLib import TTFont

WEIGHTS = ("Regular", "SemiBold")

# Latin-1 and Latin Extended-A for names of files and joints; beyond those, what the interface writes.
RANGES = ((0x20, 0x7E), (0xA0, 0x17F))
SIGNS = (
    "ΓΔΘΛΞΠΣΦΨΩαβγδεζηθικλμνξοπρςστυφχψω"  # quantities
    "‐‑‒–—―‘’‚“”„†•…′″‹›⁄€™№"  # punctuation
    "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻₀₁₂₃₄₅₆₇₈₉½⅓⅔¼¾⅛"  # exponents, indices, fractions
    "−±×÷·√∞∑∏∂∫∆≈≠≤≥°ƒ"  # mathematics
    "←↑→↓↔↕↖↗↘↙⇒⇔↩↪↺↻↰↱⇧⌃⌘⌥⎋⌫⏎"  # arrows and keys
    "■□▪▲△▶▷►▼▽◀◁◆◇◊○●★☆✓✗☼"  # shapes
)

# These take their glyph from Inter's `tnum` feature: egui applies no OpenType features, and a number that
# changes every frame must not make its neighbours jump. Only digits and the signs that stand in a column with
# them; the comma and the full stop keep their own width, for they also stand in sentences.
TABULAR = "0123456789+−±×÷=<>≤≥≈"


def tabular_glyphs(font):
    """glyph name -> its tabular twin, from every single substitution of the tnum feature"""
    gsub = font["GSUB"].table
    twins = {}
    for record in gsub.FeatureList.FeatureRecord:
        if record.FeatureTag != "tnum":
            continue
        for index in record.Feature.LookupListIndex:
            for table in gsub.LookupList.Lookup[index].SubTable:
                table = getattr(table, "ExtSubTable", table)
                twins.update(getattr(table, "mapping", {}))
    return twins


def main(source, target):
    wanted = {c for low, high in RANGES for c in range(low, high + 1)} | {ord(c) for c in SIGNS + TABULAR}
    for weight in WEIGHTS:
        font = TTFont(source / f"Inter-{weight}.woff2")
        twins = tabular_glyphs(font)
        remapped = []
        for table in font["cmap"].tables:
            if not table.isUnicode():
                continue
            for char in TABULAR:
                name = table.cmap.get(ord(char))
                if name in twins:
                    table.cmap[ord(char)] = twins[name]
                    remapped.append(char)
        missing = sorted(wanted - set(font.getBestCmap()))

        options = subset.Options()
        options.layout_features = ["kern", "ccmp", "mark", "mkmk"]
        options.hinting = False
        options.name_IDs = [0, 1, 2, 3, 4, 5, 6, 13, 14]
        options.notdef_outline = True
        options.drop_tables += ["STAT", "DSIG", "meta"]
        subsetter = subset.Subsetter(options)
        subsetter.populate(unicodes=wanted)
        subsetter.subset(font)

        font.flavor = None
        path = target / f"Inter-{weight}.ttf"
        font.save(path)
        digits = {font["hmtx"][font.getBestCmap()[ord(c)]][0] for c in "0123456789"}
        assert len(digits) == 1, f"digits of different widths: {digits}"
        signs = {c: font["hmtx"][font.getBestCmap()[ord(c)]][0] for c in TABULAR[10:] if ord(c) in font.getBestCmap()}
        print(f"{path.name}: {path.stat().st_size} bytes, {len(font.getBestCmap())} characters, digit width {digits}, {signs}")
        print("  tabular:", "".join(sorted(set(remapped))))
        print("  not in Inter:", " ".join(chr(c) for c in missing))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
