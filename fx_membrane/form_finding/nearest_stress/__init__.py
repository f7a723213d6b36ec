"""The shape in exact equilibrium whose stress is nearest to a wish."""
