"""Formulas of the web site as MathML, which browsers draw themselves: no script, nothing from the internet."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml


def setup(app: Any) -> dict[str, bool]:
    """Make Sphinx write formulas by it."""
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
    return {"parallel_read_safe": True}


def mathml(tex: str, display: bool = False) -> str:
    r"""A formula as MathML. Lines of an `align` and lines that end in \\\\ stand below each other."""
    lines = display and (r"\\" in tex or "&" in tex) and r"\begin" not in tex
    tex = re.sub(r"\\[Bb]igg?(?=[^a-z])", "", tex.replace(r"\dots", r"\ldots"))  # docutils knows neither
    text = tex2mathml(rf"\begin{{aligned}}{tex}\end{{aligned}}" if lines else tex.strip(), as_block=display)
    return re.sub(r"\n\s*", "", text)


def _inline(translator: Any, node: Any) -> None:
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def _display(translator: Any, node: Any) -> None:
    translator.body.append(f'<div class="math">{mathml(node.astext(), display=True)}</div>')
    raise nodes.SkipNode
