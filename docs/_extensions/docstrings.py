"""What plain docstrings need to become pages: names in backticks are links, stars are stars, derivatives have primes."""

import re
from typing import Any

from docutils import nodes
from sphinx.domains.python import PyXRefRole

# The quotes of x' and x'', but not those of 'x' and the user's
_PRIMES = re.compile(r"(?<![\w'])(d?[A-Za-z])('{1,2})(?![\w'])")


class Name(PyXRefRole):
    """A name in single backticks: a link where it is that of an object with a page, or else code."""

    def process_link(
        self, env: Any, refnode: Any, has_explicit_title: bool, title: str, target: str
    ) -> tuple[str, str]:
        """Mark the reference as one that may lead nowhere."""
        refnode["reftype"], refnode["may_dangle"] = "obj", True
        linked: tuple[str, str] = super().process_link(env, refnode, has_explicit_title, title, target)
        return linked


def leave_dangling(app: Any, env: Any, node: Any, content: nodes.Node) -> nodes.Node | None:
    """Show a name that has no page as what it is."""
    return content if node.get("may_dangle") else None


def escape(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Let ``(T, *shape)`` and ``|z|`` be text outside of code, no emphasis or substitution, and ``x''`` no quotation mark."""
    for number, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):
            parts = re.split(r"(`+[^`]*`+)", line)
            parts[::2] = [re.sub(r"(?=\||\*shape)", r"\\", _PRIMES.sub(_primed, part)) for part in parts[::2]]
            lines[number] = "".join(parts)


def _primed(found: re.Match[str]) -> str:
    return found[1] + " \u2032\u2033"[len(found[2])]


def setup(app: Any) -> dict[str, bool]:
    """Add the role and the handlers."""
    app.add_role("name", Name())
    app.connect("missing-reference", leave_dangling)
    app.connect("autodoc-process-docstring", escape, priority=900)
    return {"parallel_read_safe": True}
