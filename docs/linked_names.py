"""Names of the package in the text lead to their pages: ``vv.Beam``, ``Beam(rigid=...)`` and ``Beam``.

An extension of Sphinx. The first name in a literal counts, if that is an entry of the reference. Arrays in signatures
are arrays, without what types say of their shapes.
"""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

ARRAY = re.compile(r"ndarray\[tuple\[[~\w.]*Any, \.\.\.\], [~\w.]*dtype\[[~\w.]+\]\]")
NAME = re.compile(r"(?:vv\.|visviva\.)?(\w+(?:\.\w+)?)(?:\(.*)?$", re.DOTALL)


class LinkedNames(SphinxPostTransform):
    """Literals become links before they are written."""

    default_priority = 300

    def run(self, **_: Any) -> None:
        """Look at all literals of a page."""
        for literal in list(self.document.findall(nodes.literal)):
            found = NAME.match(literal.astext())
            if found and not isinstance(literal.parent, nodes.reference):
                self.link(literal, f"visviva.{found[1]}")

    def link(self, literal: nodes.literal, name: str) -> None:
        """Put a reference around a literal whose name the reference has."""
        entry = self.env.domains.python_domain.objects.get(name)
        if entry is None or entry.docname == self.env.docname:
            return
        uri = self.app.builder.get_relative_uri(self.env.docname, entry.docname)
        link = nodes.reference("", "", internal=True, refuri=f"{uri}#{entry.node_id}")
        literal.replace_self(link)
        link.append(literal)


def plain(app: Sphinx, what: str, name: str, obj: object, options: object, told: str, value: str) -> Any:
    """A signature and its value in which arrays are arrays."""
    return tuple(text and ARRAY.sub("ndarray", text) for text in (told, value))


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.add_post_transform(LinkedNames)
    app.connect("autodoc-process-signature", plain)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
