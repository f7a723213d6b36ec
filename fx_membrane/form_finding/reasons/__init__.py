"""Reasons for which prescribed stresses have no form, in words with numbers and places."""
