"""What plain docstrings need to become pages: names in backticks link to what has a page, and stars are stars."""

import re
from typing import Any

from docutils import nodes
from sphinx.domains.python import PyXRefRole


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
    """Let ``(T, *shape)`` and ``|z|`` be text outside of code, and no emphasis or substitution."""
    for number, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):
            parts = re.split(r"(`+[^`]*`+)", line)
            parts[::2] = [re.sub(r"(?=\||\*shape)", r"\\", part) for part in parts[::2]]
            lines[number] = "".join(parts)


def setup(app: Any) -> dict[str, bool]:
    """Add the role and the handlers."""
    app.add_role("name", Name())
    app.connect("missing-reference", leave_dangling)
    app.connect("autodoc-process-docstring", escape, priority=900)
    return {"parallel_read_safe": True}
