"""What the gallery shows of an example: figures that a block of it has made, by pyplot or as values of its own, and viewers."""

import shutil
from pathlib import Path
from typing import Any

from matplotlib import pyplot
from matplotlib.figure import Figure
from sphinx_gallery import backreferences
from sphinx_gallery.scrapers import figure_rst

from kickdrift.viewer.embedded import Embedded

_seen: list[Figure] = []  # of the example that is running; kept, so that no new figure has the identity of an old one
_VIEWER = """
.. raw:: html

    <iframe class="viewer" src="{name}" loading="lazy" title="plays, and turns under the mouse"></iframe>

"""


def scrape(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figures of a block and the viewer that it ends with, and return the text that includes them."""
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
    # One below the other: side by side, they would be too small to read.
    rows = [figure_rst([path], gallery_conf["src_dir"]) for path in paths]
    return "".join(rows) + _viewer(block_vars)


def _viewer(block_vars: dict[str, Any]) -> str:
    """Write the page of ``recording.show()`` beside that of the example, which loads it where it comes into view."""
    last = block_vars["example_globals"].get("___")  # sphinx-gallery's name for the value of the last line
    if not isinstance(last, Embedded):
        return ""
    target = Path(block_vars["target_file"])
    path = target.with_name(f"{target.stem}_viewer.html")
    path.write_text(last.page, encoding="utf-8")
    return _VIEWER.format(name=path.name)


def _copy_viewers(app: Any, exception: Exception | None) -> None:
    if exception is None and app.builder.format == "html":
        for page in Path(app.srcdir, "examples").rglob("*_viewer.html"):
            shutil.copy(page, Path(app.outdir) / page.relative_to(app.srcdir))


def setup(app: Any) -> dict[str, bool]:
    """Bring the viewers to the site, and give thumbnails a text in place of the empty one of sphinx-gallery."""
    for name in ("THUMBNAIL_TEMPLATE", "BACKREF_THUMBNAIL_TEMPLATE"):
        setattr(backreferences, name, getattr(backreferences, name).replace(":alt:\n", ":alt: Picture of {title}\n"))
    app.connect("build-finished", _copy_viewers)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
