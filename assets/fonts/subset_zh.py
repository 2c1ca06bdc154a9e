#!/usr/bin/env python3
"""Makes assets/lang/zh-Hant.otf. How to run it, and why, is in README.md.

usage: subset_zh.py NotoSansCJK-Regular.ttc
"""

import json
import sys
from pathlib import Path

from fontTools import subset
from fontTools.ttLib import TTCollection

ASSETS = Path(__file__).resolve().parent.parent
OUTPUT = ASSETS / "lang" / "zh-Hant.otf"
LIMIT = 300 * 1024

# What Inter does not have and Chinese is set with.
SIGNS = "，。、；：？！「」『』（）《》〈〉【】—…·／～％＋－＝　"

# For words that are not written yet, such as a teacher's own lesson: the most frequent characters of written Chinese, as many as there is room for.
FREQUENT = (
    "的一是不了在人有我他這中大來上國個到說們為子和你地出道也時年得就那要下以生會自著去之過家學對可她里後小麼心多天而能好都然"
    "沒日於起還發成事只作當想看文無開手十用主行方又如前所本見經頭面公同三已老從動兩長知民樣現分將外但身些與高意進把法此實回"
    "二理美點月明其種聲全工己話兒者向情部正名定女問力機給等幾很業最間新什打便位因重被走電四第門相次東政海口使教西再平真聽世"
    "氣信北少關並內加化由卻代軍產入先山五太水萬市眼體別處總才場師書比住員九笑性通目華報立馬命張活難神數件安表原車白應路期叫"
    "死常提感金何更反合放做系計或司利受光王果親界及今京務制解各任至清物台象記邊共風戰干接它許八特覺望直服毛林題建南度統色字"
    "請交愛讓認算論百吃義科怎元社術結六功指思非流每青管夫連遠資隊跟帶花快條院變聯言權往展該領傳近留紅治決周保達辦運武半候七"
    "必城父強步完革深區即求品士轉量空甚眾技輕程告江語英基派滿式李息寫呢識極令黃德收臉錢黨倒未持取設始版雙歷越史商千片容研像"
    "找友孩站廣改議形委早房音火際則首單據導影失拿網香似斯專石若兵弟誰校讀志飛觀爭究包組造落視濟喜離雖壞兄切星語選引存育病根"
    "練習例題答案圖示範課堂學生老師作業繳交上傳下載影片檔案資料夾安裝更新版本錯誤原因結論想法觀察比較記錄測驗試解釋說明參考書"
    "目錄章節頁數公式符號變數函數矩陣向量座標軸角度弧度旋轉平移縮放鏡頭燈光陰影材質貼圖模型骨架蒙皮權重關鍵影格曲線插補取樣頻率"
    "週期相位振幅能量距離誤差門檻平均中位數最大最小總和差值乘積除法開根號近似收斂發散穩定連續離散隨機種子搜尋排序樹狀節點邊線路徑"
    "腳踝膝蓋髖腰背胸肩肘腕掌指頸額臉左右前後上下跑跳走蹲坐站躺踢打揮舞轉身彎腰抬腿落地起步停止加速減速慢動作重播倒帶暫停速度"
)


def written():
    """every character that the Chinese files are written with"""
    catalogue = json.loads((ASSETS / "lang" / "zh-Hant.json").read_text("utf-8"))
    texts = [text for section in catalogue.values() for text in section.values()]
    texts += [path.read_text("utf-8") for path in sorted((ASSETS / "lessons" / "zh-Hant").glob("**/*.md"))]
    return {ord(char) for text in texts for char in text if not char.isspace()}


def cut(source, characters):
    font = TTCollection(source, lazy=True).fonts[face_of(source)]
    options = subset.Options()
    options.layout_features = []
    options.hinting = False
    options.desubroutinize = False
    options.name_IDs = [0, 1, 2, 3, 4, 5, 6, 13, 14]
    options.notdef_outline = True
    options.drop_tables += ["STAT", "DSIG", "meta", "BASE", "VORG", "vhea", "vmtx"]
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=characters)
    subsetter.subset(font)
    # Letters of two fonts are centred on each other by their line heights: with Inter's, they stand on one baseline.
    em = font["head"].unitsPerEm
    font["hhea"].ascent, font["hhea"].descent, font["hhea"].lineGap = round(1984 / 2048 * em), -round(494 / 2048 * em), 0
    os2 = font["OS/2"]
    os2.sTypoAscender, os2.sTypoDescender, os2.sTypoLineGap = font["hhea"].ascent, font["hhea"].descent, 0
    os2.usWinAscent, os2.usWinDescent = font["hhea"].ascent, -font["hhea"].descent
    font.flavor = None
    font.save(OUTPUT)
    return font


def face_of(source):
    """the index of the face for Traditional Chinese in the collection"""
    names = [font["name"].getDebugName(4) or "" for font in TTCollection(source, lazy=True).fonts]
    return next(index for index, name in enumerate(names) if name.startswith("Noto Sans CJK TC"))


def main(source):
    needed = written() | {ord(char) for char in SIGNS}
    font = cut(source, needed)
    missing = sorted(needed - set(font.getBestCmap()) - set(inter()))
    print(f"needed: {len(font.getBestCmap())} characters, {OUTPUT.stat().st_size} bytes; in no font: {''.join(map(chr, missing))}")
    more = [ord(char) for char in dict.fromkeys(FREQUENT) if ord(char) not in needed]
    while more:
        font = cut(source, needed | set(more))
        if OUTPUT.stat().st_size <= LIMIT:
            break
        more = more[: len(more) * 4 // 5]
    size = OUTPUT.stat().st_size
    assert size <= LIMIT, f"{size} bytes are more than {LIMIT}"
    print(f"{OUTPUT.name}: {size} bytes, {len(font.getBestCmap())} characters, {len(more)} of them for words to come")


def inter():
    from fontTools.ttLib import TTFont

    return TTFont(Path(__file__).parent / "Inter-Regular.ttf").getBestCmap()


if __name__ == "__main__":
    main(sys.argv[1])
