"""Shared by the plot scripts: matplotlib without a window, the command line, a file that is never partly written."""
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def save(figure, picture, dpi=110):
    temporary = picture + ".tmp.png"
    figure.savefig(temporary, dpi=dpi)
    os.replace(temporary, picture)


def run(main, usage):
    """Calls main(INPUT, PICTURE) with the two arguments of the command line."""
    if len(sys.argv) != 3:
        sys.exit(usage)
    main(*sys.argv[1:])
