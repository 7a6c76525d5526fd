"""Bodies: adding and removing them, their rows, their parts and shapes, and their handles."""
