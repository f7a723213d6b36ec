"""Masts, struts and stays in forms, and the forces that balance in them."""
