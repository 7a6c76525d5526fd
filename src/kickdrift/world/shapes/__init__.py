"""Shapes: what bodies are made of."""
