"""Commands of `fx-membrane`."""
