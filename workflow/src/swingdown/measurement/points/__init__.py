"""Turning points and passages alone, without the swing between them."""
