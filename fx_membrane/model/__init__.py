"""Plain data that a user writes, checked when it is made: materials, parts, supports, loads, structures."""
