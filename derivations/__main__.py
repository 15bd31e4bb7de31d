"""``python -m derivations [--check]``: regenerate, or check, every committed artefact."""

import sys

from derivations.app import main

main(["regenerate", *sys.argv[1:]])
