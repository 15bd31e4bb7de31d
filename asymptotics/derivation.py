"""One derivation, from a rope to what stands in a paper: ``derive`` and what it returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from asymptotics.checks import check_order
from asymptotics.errors import InputError
from asymptotics.expansion.certificates import Proof
from asymptotics.expansion.order_loop import Progress
from asymptotics.formulas.closed_form import ClosedForms
from asymptotics.formulas.rope import RopeForms
from asymptotics.problems.moving_contact import MovingContact

# Of what a notebook shows: more is no formula that one looks at.
_SHOWN = 4


@dataclass(frozen=True)
class Derivation:
    """Closed forms and their proof; a notebook shows ξ₁ … ξ_N as LaTeX.

    Attributes
    ----------
    forms
        :class:`~asymptotics.formulas.closed_form.ClosedForms` of the paper's string, or
        :class:`~asymptotics.formulas.rope.RopeForms` of any other rope.
    proof
        What became of each order when it was substituted back.
    """

    forms: ClosedForms | RopeForms
    proof: Proof

    @property
    def order(self) -> int:
        """N."""
        return self.forms.order

    def text(self) -> str:
        """All formulas in text that SymPy parses."""
        from asymptotics.printing.written_out import as_text

        return as_text(self.forms, self.proof)

    def json(self) -> dict[str, Any]:
        """All formulas as one JSON object of strings that SymPy parses."""
        from asymptotics.printing.written_out import as_json

        return as_json(self.forms, self.proof)

    def latex(self, column: str = "two") -> str:
        """Contact point and shape as numbered equations, with the definitions they use."""
        if isinstance(self.forms, RopeForms):
            from asymptotics.printing.rope_latex import rope_latex

            return rope_latex(self.forms, column=column)
        from asymptotics.printing.latex import formula_sets

        sets = formula_sets(self.forms, column)
        return "".join(text for name, text in sets.items() if name != "supplement.tex")

    def numpy(self) -> str:
        """The source of a module that needs NumPy only."""
        if isinstance(self.forms, RopeForms):
            from asymptotics.printing.rope_modules import rope_numpy

            return rope_numpy(self.forms)
        from asymptotics.printing.numpy_code import numpy_module

        return numpy_module(self.forms)

    def javascript(self) -> str:
        """The source of an ECMAScript module that needs nothing."""
        if isinstance(self.forms, RopeForms):
            from asymptotics.printing.rope_modules import rope_javascript

            return rope_javascript(self.forms)
        from asymptotics.printing.javascript import javascript_module

        return javascript_module(self.forms)

    def _repr_latex_(self) -> str:
        """ξ₁ … ξ_N, without what only a page needs: labels, line breaks."""
        last = min(self.order, _SHOWN)
        rows = [rf"\xi_{{{n}}}&={self._contact(n)}" for n in range(1, last + 1)]
        if last < self.order:
            rows.append(rf"&\dots\quad(\xi_{{{self.order}}}\text{{: see latex()}})")
        return "$$\\begin{aligned}" + "\\\\".join(rows) + "\\end{aligned}$$"

    def _contact(self, n: int) -> str:
        import sympy

        if isinstance(self.forms, ClosedForms):
            return str(sympy.latex(self.forms.contact(n).expression))
        from asymptotics.printing.rope_latex import contact_latex

        return contact_latex(self.forms, n)


def derive(
    order: int = 4, rope: MovingContact | None = None, progress: Progress | None = None
) -> Derivation:
    """Derive and prove contact point and shape to an order, as formulas.

    Parameters
    ----------
    order
        N ≥ 1.
    rope
        As it was written down (:func:`~asymptotics.problems.moving_contact.moving_contact`); the
        paper's string by default.
    progress
        Called with n when order n is expanded, and again when it is proved.

    Raises
    ------
    InputError
        A bad order, or what is no rope.

    Examples
    --------
    >>> print(derive(order=2).proof[2])
    order 2: proved (PDE residual 0, driven end 0, contact 0; harmonics 0, 2 non-zero)
    >>> from asymptotics.problems.presets import beam
    >>> derive(order=1, rope=beam())._repr_latex_()[17:-15].replace(chr(92), "")
    'xi_{1}&=-frac{1}{a_{3}}S^{(1)}_{2}cos theta'
    """
    order = check_order(order)
    if rope is None:
        from asymptotics.expansion.moving_frame import moving_frame
        from asymptotics.expansion.order_loop import expand
        from asymptotics.expansion.proof import prove
        from asymptotics.problems.string import exact_string

        expansion = expand(exact_string(), order, progress=progress)
        frame = moving_frame(expansion, progress)
        return Derivation(ClosedForms(expansion, frame), prove(expansion, frame))
    if not isinstance(rope, MovingContact):
        raise InputError(
            f"rope = {rope!r} is no rope; make one with string(), beam() or moving_contact(...)"
        )
    from asymptotics.formulas.rope import rope_forms

    forms = rope_forms(rope, order, progress)
    return Derivation(forms, forms.prove(progress))
