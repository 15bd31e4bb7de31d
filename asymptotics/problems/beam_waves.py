r"""What the beam's problem is made of: its static shape and the waves of each harmonic.

In s = ξ − L harmonic j is, with a = jΩ,

.. math:: w = A\cos ks + B\frac{\sin ks}{k} + C e^{ps} + D e^{−p(s+L)}, \qquad
          p^2 = \frac{1 + \sqrt{1 + 4βa^2}}{2β}, \quad k^2 = \frac{2a^2}{1 + \sqrt{1 + 4βa^2}}.

No exponential here grows inside the rope, so nothing overflows however small β is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from asymptotics.rings.numbers import Numbers


@dataclass(frozen=True)
class StaticBeam:
    """The static shape W₀ at ε = 0.

    Attributes
    ----------
    contact_point
        L = ξ₀ = x_c/x₀ at rest, 1 in the limit β → 0.
    a3
        W₀‴(ξ₀), the first derivative that does not vanish there; negative.
    """

    beta: Any
    driven_end: str
    contact_point: Any
    a3: Any

    def derivative(self, d: int) -> Any:
        """a_d = ∂^d W₀(ξ₀): 0 for d < 3, then a₃, −2/β, and ∂^{d+2} = ∂^d/β.

        >>> from asymptotics.problems.beam import static_beam
        >>> shape = static_beam(0.01)
        >>> [round(float(shape.derivative(d)), 6) + 0 for d in range(2, 6)]
        [0.0, -19.999364, -200.0, -1999.936442]
        """
        if d < 3:
            return 0 * self.a3
        value = self.a3 if d % 2 else -2 / self.beta
        for _ in range((d - 3) // 2):
            value = value / self.beta
        return value


@dataclass(frozen=True)
class Waves:
    """The four solutions of one harmonic, each at most of order 1 inside the rope.

    Attributes
    ----------
    k2, p2
        k² and p² of the module's docstring.
    p, decay
        p and e^{−pL}.
    cosine, sine
        cos kL and sin(kL)/k, the latter analytic also at k = 0.
    """

    k2: Any
    p2: Any
    p: Any
    decay: Any
    cosine: Any
    sine: Any
    clamped: bool

    def end(self, a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any]:
        """(w, w_ξξ) or, clamped, (w, w_ξ) at the driven end s = −L for coefficients A, B, C, D."""
        harmonic = a * self.cosine - b * self.sine
        boundary = c * self.decay + d
        if self.clamped:
            turned = a * self.k2 * self.sine + b * self.cosine
            return harmonic + boundary, turned + self.p * (c * self.decay - d)
        return harmonic + boundary, self.p2 * boundary - self.k2 * harmonic

    def solve(self, w: Any, slope: Any, drive: Any) -> tuple[tuple[Any, Any, Any, Any], Any]:
        """First four derivatives at s = 0 from w, w′ and the driven end; and the determinant.

        A = w − C − De^{−pL} and B = w′ − p(C − De^{−pL}) leave two equations for C and D. The
        determinant vanishes at the linear resonances.
        """
        e, p = self.decay, self.p
        (c1, c2), (d1, d2) = self.end(-1, -p, 1, 0), self.end(-e, p * e, 0, 1)
        r1, r2 = self.end(w, slope, 0, 0)
        determinant = c1 * d2 - d1 * c2
        c = ((drive - r1) * d2 + d1 * r2) / determinant
        d = (-c1 * r2 - c2 * (drive - r1)) / determinant
        even, odd = c + d * e, c - d * e
        second = self.p2 * even - self.k2 * (w - even)
        third = self.p2 * p * odd - self.k2 * (slope - p * odd)
        return (w, slope, second, third), determinant


def waves(static: StaticBeam, rate: Any, numbers: Numbers) -> Waves:
    """The solutions e^{irτ}w(ξ) of the beam equation at the angular frequency r = ``rate``."""
    beta, length = static.beta, static.contact_point
    root = numbers.sqrt(1 + 4 * beta * rate * rate)
    k2, p2 = 2 * rate * rate / (1 + root), (1 + root) / (2 * beta)
    p, k = numbers.sqrt(p2), numbers.sqrt(k2)
    return Waves(
        k2=k2,
        p2=p2,
        p=p,
        decay=numbers.exp(-p * length),
        cosine=numbers.cos(k * length),
        sine=length if isinstance(rate, int) and rate == 0 else numbers.sin(k * length) / k,
        clamped=static.driven_end == "clamped",
    )


def end_residuals(wave: Waves, w: Any) -> tuple[Any, Any]:
    """What one harmonic leaves of both driven-end conditions, from its derivatives at ξ₀.

    The solution growing towards the driven end, e^{pL} times larger there, would hide the others in
    both. It is eliminated from the first, of which a unit drive leaves 1; the second, of which it
    leaves 0, is times 2e^{−pL}/p² (clamped 2e^{−pL}/p), so that it enters there with factor one.
    """
    e, p, total = wave.decay, wave.p, wave.p2 + wave.k2
    a, b = (wave.p2 * w[0] - w[2]) / total, (wave.p2 * w[1] - w[3]) / total
    even, odd = (wave.k2 * w[0] + w[2]) / total, (wave.k2 * w[1] + w[3]) / (total * p)
    harmonic = a * wave.cosine - b * wave.sine
    if wave.clamped:
        turned = (a * wave.k2 * wave.sine + b * wave.cosine) / p
        second = 2 * e * turned + odd * (1 + e * e) - even * (1 - e * e)
        return harmonic + turned + e * (even + odd), second
    ratio = wave.k2 / wave.p2
    second = even * (1 + e * e) - odd * (1 - e * e) - 2 * e * ratio * harmonic
    return (1 + ratio) * harmonic, second


def static_end_residuals(
    shape: StaticBeam, a: Callable[[int], Any], numbers: Numbers
) -> tuple[Any, Any]:
    """What a static shape with these a₃ and a₄ = −2/β leaves of both driven-end conditions.

    As for a harmonic: of W₀ = 1 without the growing solution, and of the second condition times
    2e^{−L/√β}.
    """
    beta, length = shape.beta, shape.contact_point
    root = numbers.sqrt(beta)
    x, e = length / root, numbers.exp(-length / root)
    odd, even = a(3) * beta * root, a(4) * beta * beta
    less, more = 1 - e, 1 + e  # 2e cosh x − 2e = (1 − e)² without the cancellation
    if shape.driven_end == "clamped":
        height = odd * (x - 1 + e) - even * (x * x / 2 - x + 1 - e) - 1
        return height, (2 * e * x - less * more) * even + less * less * odd
    return odd * x - even * x * x / 2 - 1, less * less * even - less * more * odd
