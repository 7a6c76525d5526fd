"""Facts as a table of HTML, for notebooks; all text is escaped."""

from base64 import b64encode
from collections.abc import Iterable
from html import escape


def facts(title: str, rows: Iterable[tuple[str, object]], picture: bytes = b"") -> str:
    """Return a table of names and values under a title, with a PNG below it where there is one.

    Parameters
    ----------
    title : str
    rows : iterable of (str, object)
        Names, and what `str` makes of values.
    picture : bytes
        The content of a PNG file.
    """
    cells = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{escape(str(value))}</td></tr>'
        for name, value in rows
    )
    drawn = f'<img alt="" src="data:image/png;base64,{b64encode(picture).decode()}">' if picture else ""
    return f"<div><b>{escape(title)}</b><table>{cells}</table>{drawn}</div>"
