"""Recordings of worlds: their rows, runs that record, checkpoints and streams to disk."""
