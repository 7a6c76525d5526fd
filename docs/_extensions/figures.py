"""What the gallery shows of an example: the figures that a block of it has made, by pyplot or as values of its own."""

from typing import Any

from matplotlib import pyplot
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

_seen: list[Figure] = []  # of the example that is running; kept, so that no new figure has the identity of an old one


def scrape(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figures of a block, and return the text that includes them."""
    made = [pyplot.figure(number) for number in pyplot.get_fignums()]
    made += [value for value in block_vars["example_globals"].values() if isinstance(value, Figure)]
    paths = []
    for figure in made:
        if any(figure is known for known in _seen):
            continue
        _seen.append(figure)
        path = next(block_vars["image_path_iterator"])
        figure.savefig(path, dpi=110, bbox_inches="tight", pad_inches=0.12)
        paths.append(path)
    pyplot.close("all")
    del _seen[:-20]
    return figure_rst(paths, gallery_conf["src_dir"])
