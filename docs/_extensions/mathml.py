"""Formulas as MathML, which browsers draw themselves: the site needs no script for them, and no network."""

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert

_FUNCTION = r"<mi>(?:sin|cos|arcsin|cosh|det)</mi>"
_APART = re.compile(rf"(?<=</m[in]>)(?={_FUNCTION})|(?<=(?:sin|cos|osh|det)</mi>)(?=<m[in]>)")  # 2 cos x: thin spaces
_PRIME = r"<mi>(&#x0203[23];)</mi>"
_REPAIRS = (
    (_APART, '<mspace width="0.167em"/>'),
    (re.compile("(?<=<mo>&#x0003D;</mo>)<mo>(?=&#x02212;)"), '<mo form="prefix">'),  # a minus behind = is a sign
    # Primes are raised by themselves; as superscripts they are too small to read.
    (re.compile(rf"<msup>(<mi>\w</mi>){_PRIME}</msup>"), r'\1<mo lspace="0" rspace="0">\2</mo>'),
    (
        re.compile(rf"<msubsup>(<mi>\w</mi><m[in]>\w</m[in]>){_PRIME}</msubsup>"),
        r'<msub>\1</msub><mo lspace="0" rspace="0">\2</mo>',
    ),
)


def mathml(formula: str, display: str = "inline") -> str:
    """Return a formula of LaTeX as MathML."""
    if formula.count("|") % 2 or r"\|" in formula:
        raise ValueError(f"the bars of {formula!r} do not come in pairs; write \\lvert and \\rvert.")
    formula = re.sub(r"\|([^|]+)\|", r"\\left|\1\\right|", formula)  # bars as brackets, without space inside
    result = convert(formula, display=display)
    for pattern, repaired in _REPAIRS:
        result = pattern.sub(repaired, result)
    return result


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.math_block) -> None:
    writer.body.append(f'<div class="formula">{mathml(node.astext(), "block")}</div>')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Add the renderer."""
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
