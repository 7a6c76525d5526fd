"""The engine: runs words over flows. It knows no physics and no method by name."""
