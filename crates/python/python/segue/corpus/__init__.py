"""Corpora: thousands of motion files as a few static files that can be searched.

>>> import segue.corpus
>>> segue.corpus.build(["takes/", "set.zip"], "corpus/")        # on all cores
Report(rows=3000, clips=2988, unplaced=9, unreadable=3, copies=41, made=3000, is_written=True)
>>> corpus = segue.corpus.Corpus("corpus/")
>>> corpus.like(corpus.clip(7), seconds=1.5, count=5)           # the moments most like that one

Needs pyarrow: ``pip install "segue-motion[corpus]"``, which also brings Ray.
"""

from ._build import Report, build
from ._read import Corpus, Like

__all__ = ["Corpus", "Like", "Report", "build"]
