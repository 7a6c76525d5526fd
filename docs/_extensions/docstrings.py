"""What plain docstrings need to become pages: names in backticks link to what has a page, and stars are stars."""

import inspect
import re
from enum import Enum
from typing import Any

from docutils import nodes
from sphinx.domains.python import PyXRefRole
from sphinx.util.nodes import make_refnode

import kickdrift


class Name(PyXRefRole):
    """A name in single backticks: a link where it is that of an object with a page, or else code."""

    def process_link(
        self, env: Any, refnode: Any, has_explicit_title: bool, title: str, target: str
    ) -> tuple[str, str]:
        """Mark the reference as one that may lead nowhere."""
        refnode["refdomain"], refnode["reftype"], refnode["may_dangle"] = "py", "obj", True
        linked: tuple[str, str] = super().process_link(env, refnode, has_explicit_title, title, target)
        return linked


def leave_dangling(app: Any, env: Any, node: Any, content: nodes.Node) -> nodes.Node | None:
    """Link a name such as ``Joint.angle`` that is unique among the documented ones, and show others as what they are."""
    if not node.get("may_dangle"):
        return None
    target = node["reftarget"]
    if "." in target or target[:1].isupper():
        matches = env.domains["py"].find_obj(env, None, None, target, None, 1)
        found = [each for each in matches if not each[1].aliased]
        if len(found) == 1:
            ((name, entry),) = found
            return make_refnode(app.builder, node["refdoc"], entry.docname, entry.node_id, content, name)
    return content


def escape(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Let ``(T, *shape)``, ``|z|`` and ``m.`` be text outside of code: no emphasis, substitution or item of a list."""
    for number, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):
            parts = re.split(r"(`+[^`]*`+)", line)
            parts[::2] = [re.sub(r"(?=\||(?<=, )\*shape)", r"\\", part) for part in parts[::2]]
            start = r"^( *(?:\.\. \[[\w-]+\] +)?)(?=[A-Za-z]\.(?: |$))"  # also that of a reference, J. K. Salmon
            lines[number] = re.sub(start, r"\1\\", "".join(parts))


_AXES = {repr(kickdrift.Axis()): "Axis()", repr(kickdrift.Axis(locked=True)): "Axis(locked=True)"}


def shorten_signature(
    app: Any, what: str, name: str, obj: Any, options: Any, arguments: str | None, returned: str | None
) -> tuple[str, str] | None:
    """Show axes among the default values without theirs, and no constructor of objects that users get but never create.

    These are handles, results and enumerations.
    """
    if what != "class":
        short = arguments = arguments or ""
        for axis, shown in _AXES.items():
            short = short.replace(axis, shown)
        return None if short == arguments else (short, returned or "")
    if issubclass(obj, Exception):
        return None
    if issubclass(obj, Enum | kickdrift.Solution | kickdrift.EnsembleSolution):
        return "", ""
    defaults = (each.default for each in inspect.signature(obj).parameters.values())
    constructed = name.removeprefix("kickdrift.") in kickdrift.__all__ or set(defaults) - {inspect.Parameter.empty}
    return None if constructed else ("", "")


def skip_field(app: Any, what: str, name: str, obj: Any, skip: bool, options: Any) -> bool | None:
    """Leave out the fields of named tuples, which are among the attributes already."""
    return True if type(obj).__name__ == "_tuplegetter" else None


def setup(app: Any) -> dict[str, bool]:
    """Add the role and the handlers."""
    app.add_role("name", Name())
    app.connect("missing-reference", leave_dangling)
    app.connect("autodoc-process-docstring", escape, priority=900)
    app.connect("autodoc-skip-member", skip_field)
    app.connect("autodoc-process-signature", shorten_signature, priority=400)  # before numpydoc's
    return {"parallel_read_safe": True}
