"""Printed report of an analysis: HTML and PDF from one template."""
