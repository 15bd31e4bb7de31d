"""Numbers from an expansion: shape and contact point, certified or not, and its singularities."""
