"""Plain data of a user, checked when made: materials, parts, supports, loads, structures."""
