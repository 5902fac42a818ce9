# SPDX-License-Identifier: GPL-3.0-or-later
"""What a shader is at a point: values for a program's outputs."""

SUMMED = ("emission", "ambient", "diffuse", "specular", "reflection", "transmission")


class Closure:
    """Shares of light by colour (SUMMED) and what they are shaped by; black and opaque at first.
    `normal` None: the smooth normal. `alpha` scales all of it."""

    def __init__(self, builder, **values):
        self.b = builder
        for name in SUMMED:
            setattr(self, name, builder.constant(0.0))
        self.alpha = builder.constant(1.0)
        self.roughness = builder.constant(0.5)
        self.ior = builder.constant(1.0)
        self.normal = None
        for name, value in values.items():
            setattr(self, name, value)

    def scaled(self, factor):
        """All of it but the alpha times a number."""
        made = Closure(self.b, **vars(self))
        for name in SUMMED:
            setattr(made, name, self.b.multiply(getattr(self, name), factor))
        return made

    def weight(self, *names):
        """How much light these shares are, one number."""
        total = self.b.constant(0.0)
        for name in names:
            total = self.b.add(total, getattr(self, name))
        return self.b.average(total)

    def plus(self, other):
        """Property by property; what shapes is averaged by the weight of what it shapes."""
        b = self.b
        made = Closure(b)
        for name in SUMMED:
            setattr(made, name, b.add(getattr(self, name), getattr(other, name)))
        made.roughness = self._mean(other, "roughness", "specular")
        made.ior = self._mean(other, "ior", "transmission")
        made.normal = self._mean(other, "normal", *SUMMED[2:])
        return made

    def _mean(self, other, name, *carriers):
        mine, others = getattr(self, name), getattr(other, name)
        if mine is others:
            return mine
        b = self.b
        weights = [closure.weight(*carriers) for closure in (self, other)]
        if weights[1].is_all(0.0):
            return mine
        if weights[0].is_all(0.0):
            return others
        share = b.divide(weights[1], b.add(*weights))
        mean = b.mix(share, *(b.op("input", modes=("NORMAL",)) if value is None else value
                              for value in (mine, others)))
        return b.vector_math("NORMALIZE", mean) if name == "normal" else mean

    def outputs(self):
        """{output of the program: value}."""
        made = {name: getattr(self, name)
                for name in (*SUMMED, "alpha", "roughness", "ior")}
        if self.normal is not None and self.normal is not self.b.op("input", modes=("NORMAL",)):
            made["normal"] = self.normal
        return made


def joined(first, second, share, other_share, alpha):
    """Two closures of which so much counts, where the alpha of the whole is already known."""
    b = first.b
    if not alpha.is_all(1.0):
        share, other_share = b.divide(share, alpha), b.divide(other_share, alpha)
    made = first.scaled(share).plus(second.scaled(other_share))
    made.alpha = alpha
    return made


def mixed(first, second, factor):
    """(1 - factor) first + factor second."""
    b = first.b
    factor = b.clamp(factor)
    if factor.is_all(0.0):
        return first
    if factor.is_all(1.0):
        return second
    shares = [b.multiply(b.invert(factor), first.alpha), b.multiply(factor, second.alpha)]
    return joined(first, second, *shares, b.add(*shares) if not (
        first.alpha.is_all(1.0) and second.alpha.is_all(1.0)) else b.constant(1.0))


def added(first, second):
    """first + second. What each lets through by its alpha adds up too."""
    b = first.b
    if first.alpha.is_all(1.0) and second.alpha.is_all(1.0):
        return first.plus(second)
    alpha = b.clamp(b.subtract(b.add(first.alpha, second.alpha), 1.0), 1e-3)
    return joined(first, second, first.alpha, second.alpha, alpha)
